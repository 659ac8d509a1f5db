#include "hil/model/shift_of_start.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "hil/trace/static_line.h"

namespace forcegate {
namespace {

constexpr std::size_t kPoints = 2000, kMostPoints = 4 * kPoints, kFewest = 64;
constexpr double kLongest_s = 60.0, kOfRecord = 0.25;

struct EvenRows {
  std::vector<double> F, U;  // kMissing where no row is
};

EvenRows even_rows(const RecordInput& r, double step_s) {
  EvenRows out;
  const std::size_t n = std::min(static_cast<std::size_t>(r.duration_s / step_s), kMostPoints);
  std::vector<double> count(n, 0.0);
  out.F.assign(n, 0.0);
  out.U.assign(n, 0.0);
  for (std::size_t i = 0; i < r.rows(); ++i) {
    const auto at = static_cast<std::size_t>(std::max(0.0, r.t_s[i] / step_s));
    if (at >= n || r.ok[i] == 0) continue;
    out.F[at] += r.F_N[i];
    out.U[at] += r.U_V[i];
    count[at] += 1.0;
  }
  for (std::size_t k = 0; k < n; ++k)
    if (count[k] > 0.0) out.F[k] /= count[k], out.U[k] /= count[k];
    else out.F[k] = out.U[k] = kMissing;
  return out;
}

/// Variance of the output, and what is left of it beside a straight line in the force `shift` steps before that rises, and beside one that falls.
struct Beside {
  double variance_V2 = 0.0, rising_V2 = 0.0, falling_V2 = 0.0;
};

Beside beside_line(const EvenRows& r, std::ptrdiff_t shift) {
  StaticLine line;
  const auto size = static_cast<std::ptrdiff_t>(r.F.size());
  for (std::ptrdiff_t i = std::max<std::ptrdiff_t>(0, shift); i < std::min(size, size + shift); ++i) {
    const double F_N = r.F[static_cast<std::size_t>(i - shift)], U_V = r.U[static_cast<std::size_t>(i)];
    if (std::isfinite(F_N + U_V)) line.push(U_V, F_N);
  }
  if (line.n() < static_cast<double>(kFewest)) return {};
  const double variance = line.variance_V2(), covariance = line.covariance_VN();
  const double left = line.variance_N2() > 0.0 ? std::max(0.0, variance - covariance * covariance / line.variance_N2()) : variance;
  return {variance, covariance > 0.0 ? left : variance, covariance < 0.0 ? left : variance};
}

}  // namespace

double shift_of_start(const CampaignInput& campaign) {
  constexpr double kLeast_s = 0.5, kHalves = 0.5, kAsGood = 1.1, kOfVariance = 1e-3;
  double shortest_s = HUGE_VAL, longest_s = 0.0, row_step_s = 0.0;
  for (const RecordInput& r : campaign.records)
    if (r.rows() >= kFewest) {
      shortest_s = std::min(shortest_s, r.duration_s);
      longest_s = std::max(longest_s, r.duration_s);
      row_step_s = std::max(row_step_s, r.row_step_s);
    }
  if (!(longest_s > 0.0)) return 0.0;
  const double step_s = std::max(row_step_s, shortest_s / kPoints), most_s = std::min(kLongest_s, kOfRecord * shortest_s);
  std::vector<EvenRows> records;
  for (const RecordInput& r : campaign.records)
    if (r.rows() >= kFewest) records.push_back(even_rows(r, step_s));
  const auto most = static_cast<std::ptrdiff_t>(most_s / step_s);
  std::vector<double> of_shift, falling;  // what is left at every shift
  for (std::ptrdiff_t k = -most; k <= most; ++k) {
    Beside all;
    for (const EvenRows& r : records) {
      const Beside one = beside_line(r, k);
      all.variance_V2 += one.variance_V2;
      all.rising_V2 += one.rising_V2;
      all.falling_V2 += one.falling_V2;
    }
    of_shift.push_back(all.variance_V2 > 0.0 ? all.rising_V2 / all.variance_V2 : 1.0);
    falling.push_back(all.variance_V2 > 0.0 ? all.falling_V2 / all.variance_V2 : 1.0);
  }
  // half a cycle of another sign fits cycles as well: an output that falls with the force must fit far better
  if (*std::ranges::min_element(falling) < kHalves * *std::ranges::min_element(of_shift)) of_shift = std::move(falling);
  const double best = *std::ranges::min_element(of_shift);
  if (!(best < kHalves * of_shift[static_cast<std::size_t>(most)])) return 0.0;
  std::ptrdiff_t smallest = most + 1;
  for (std::ptrdiff_t k = -most; k <= most; ++k) {
    const auto at = static_cast<std::size_t>(k + most);
    const bool bottom = (at == 0 || of_shift[at - 1] >= of_shift[at]) && (at + 1 == of_shift.size() || of_shift[at + 1] >= of_shift[at]);
    if (bottom && of_shift[at] <= kAsGood * best + kOfVariance && std::abs(k) < std::abs(smallest)) smallest = k;
  }
  const double out_s = step_s * static_cast<double>(smallest);
  return std::abs(smallest) <= most && std::abs(out_s) >= kLeast_s ? out_s : 0.0;
}

}  // namespace forcegate
