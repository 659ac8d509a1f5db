#include "hil/model/states.h"

namespace forcegate {

namespace {

template <class Sample>
std::vector<double> row_means(const RecordInput& record, const Sample& sample) {
  std::vector<double> out(record.rows());
  for (std::size_t r = 0; r < record.rows(); ++r) {
    double sum = 0.0;
    const std::uint32_t begin = record.row_begin[r], end = record.row_begin[r + 1];
    for (std::uint32_t k = begin; k < end; ++k) sum += sample(k);
    out[r] = sum / static_cast<double>(end - begin);
  }
  return out;
}

}  // namespace

std::vector<double> low_pass_rows(const RecordInput& record, double tau_s, int poles) {
  if (record.fast_F_N.empty()) return std::vector<double>(record.rows(), 0.0);
  const auto& F = record.fast_F_N;
  const auto& t = record.fast_t_s;
  LowPass first(tau_s, F[0]), second(tau_s, F[0]);
  double before_second = F[0];
  return row_means(record, [&](std::uint32_t k) {
    if (k == 0) return F[0];
    const double dt = t[k] - t[k - 1];
    const double y = first.step(F[k - 1], F[k], dt);
    if (poles == 1) return y;
    const double z = second.step(before_second, y, dt);
    before_second = y;
    return z;
  });
}

std::vector<double> delayed_rows(const RecordInput& record, double delay_s, double skew) {
  if (record.fast_F_N.empty()) return std::vector<double>(record.rows(), 0.0);
  const auto& F = record.fast_F_N;
  const auto& t = record.fast_t_s;
  const std::size_t n = F.size();
  std::size_t j = 0;
  return row_means(record, [&](std::uint32_t k) {
    const double at = t[k] - delay_s - skew * (t[k] - t[0]);
    if (at <= t[0]) return F[0];
    if (at >= t[n - 1]) return F[n - 1];
    while (j > 0 && t[j] > at) --j;
    while (j + 2 < n && t[j + 1] <= at) ++j;
    const double share = (at - t[j]) / (t[j + 1] - t[j]);
    return F[j] + share * (F[j + 1] - F[j]);
  });
}

std::vector<double> low_pass_channel(const RecordInput& record, std::span<const double> x, double tau_s,
                                     double first_state) {
  std::vector<double> out(x.size());
  LowPass filter(tau_s, first_state);
  for (std::size_t i = 0; i < x.size(); ++i)
    out[i] = i == 0 ? first_state : filter.step(x[i - 1], x[i], record.t_s[i] - record.t_s[i - 1]);
  return out;
}

std::vector<double> spectrum_response(const RecordInput& record, std::span<const double> x,
                                      std::span<const double> tau_s, std::span<const double> weight,
                                      double first_state) {
  std::vector<double> out(x.size(), 0.0);
  for (std::size_t k = 0; k < tau_s.size(); ++k) {
    LowPass filter(tau_s[k], first_state);
    out[0] += weight[k] * first_state;
    for (std::size_t i = 1; i < x.size(); ++i)
      out[i] += weight[k] * filter.step(x[i - 1], x[i], record.t_s[i] - record.t_s[i - 1]);
  }
  return out;
}

}  // namespace forcegate
