#include "hil/model/states.h"

#include <algorithm>
#include <iterator>

#include "hil/model/fading_memory.h"

namespace forcegate {

namespace {

template <class Sample>
double row_mean(const RecordInput& record, std::size_t row, const Sample& sample) {
  double sum = 0.0;
  const std::uint32_t begin = record.row_begin[row], end = record.row_begin[row + 1];
  for (std::uint32_t k = begin; k < end; ++k) sum += sample(k);
  return sum / static_cast<double>(end - begin);
}

}  // namespace

std::vector<double> low_pass_rows(const RecordInput& record, double tau_s, int poles) {
  if (record.fast_F_N.empty()) return std::vector<double>(record.rows(), 0.0);
  const auto& F = record.fast_F_N;
  const auto& t = record.fast_t_s;
  LowPass first(tau_s, F[0]), second(tau_s, F[0]);
  double before_second = F[0];
  std::vector<double> out(record.rows(), 0.0);
  filter_wanted_rows(
      record, [&](std::uint32_t next, std::uint32_t begin) { return first_felt(record, kForgotten * tau_s, next, begin); },
      [&](std::uint32_t k) {
        first.settle(F[k]);
        second.settle(F[k]);
        return before_second = F[k];
      },
      [&](std::uint32_t k) {
        const double dt = t[k] - t[k - 1];
        const double y = first.step(F[k - 1], F[k], dt);
        if (poles == 1) return y;
        const double z = second.step(before_second, y, dt);
        before_second = y;
        return z;
      },
      [&](std::size_t row, double mean) { out[row] = mean; });
  return out;
}

std::vector<double> lagged_curve_rows(const RecordInput& record, double tau_s, LagAndCurve order, const std::function<double(double)>& h) {
  if (record.fast_F_N.empty()) return std::vector<double>(record.rows(), 0.0);
  const auto& F = record.fast_F_N;
  const auto& t = record.fast_t_s;
  const bool bends_first = order == LagAndCurve::lag_of_curve;
  double before = 0.0;
  LowPass pole(tau_s, before);
  std::vector<double> out(record.rows(), 0.0);
  filter_wanted_rows(
      record, [&](std::uint32_t next, std::uint32_t begin) { return first_felt(record, kForgotten * tau_s, next, begin); },
      [&](std::uint32_t k) {
        before = bends_first ? h(F[k]) : F[k];
        pole.settle(before);
        return bends_first ? before : h(before);
      },
      [&](std::uint32_t k) {
        const double now = bends_first ? h(F[k]) : F[k];
        const double y = pole.step(before, now, t[k] - t[k - 1]);
        before = now;
        return bends_first ? y : h(y);
      },
      [&](std::size_t row, double mean) { out[row] = mean; });
  return out;
}

namespace {

// F at `late_s` of the sample's time, from the record's first sample on, before it.
template <class LateBy>
std::vector<double> late_rows(const RecordInput& record, const LateBy& late_s) {
  if (record.fast_F_N.empty()) return std::vector<double>(record.rows(), 0.0);
  const auto& F = record.fast_F_N;
  const auto& t = record.fast_t_s;
  const std::size_t n = F.size();
  std::size_t j = 0;
  std::uint32_t last = 0;
  const auto sample = [&](std::uint32_t k) {
    // on a clock without gaps j comes along with k, over rows that nobody wants too
    j = std::min<std::size_t>(j + (k - last), n - 2);
    last = k;
    const double at = t[k] - late_s(t[k] - t[0]);
    if (at <= t[0]) return F[0];
    if (at >= t[n - 1]) return F[n - 1];
    while (j > 0 && t[j] > at) --j;
    while (j + 2 < n && t[j + 1] <= at) ++j;
    const double share = (at - t[j]) / (t[j + 1] - t[j]);
    return F[j] + share * (F[j + 1] - F[j]);
  };
  std::vector<double> out(record.rows(), 0.0);
  record.for_each_wanted([&](std::size_t i) { out[i] = row_mean(record, i, sample); });
  return out;
}

}  // namespace

std::vector<double> delayed_rows(const RecordInput& record, double delay_s, double skew) {
  return late_rows(record, [&](double since_s) { return delay_s + skew * since_s; });
}

std::vector<double> rows_behind_lost_blocks(const RecordInput& record, double block_s) {
  const std::vector<LostBlocks>& lost = record.lost_blocks;
  return late_rows(record, [&](double since_s) {
    const auto next = std::ranges::upper_bound(lost, since_s, {}, &LostBlocks::from_s);
    return next == lost.begin() ? 0.0 : block_s * std::prev(next)->blocks;
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
  std::vector<LowPass> filter;
  for (const double tau : tau_s) filter.emplace_back(tau, first_state);
  for (std::size_t i = 0; i < x.size(); ++i)
    for (std::size_t k = 0; k < filter.size(); ++k)
      out[i] += weight[k] * (i == 0 ? first_state : filter[k].step(x[i - 1], x[i], record.t_s[i] - record.t_s[i - 1]));
  return out;
}

}  // namespace forcegate
