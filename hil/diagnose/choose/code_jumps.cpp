#include "hil/diagnose/choose/code_jumps.h"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

namespace forcegate::diagnose {

namespace {

constexpr double kHalfWidth = 0.05;  // of the range
constexpr std::size_t kFewestRows = 3, kFewestPassages = 4;

struct Place {
  double at_V, half_width_V;
  bool below(double U_V) const { return U_V < at_V - half_width_V; }
  bool above(double U_V) const { return U_V > at_V + half_width_V; }
};

// By which the force jumps where U passes the place from row `begin` to `end`: W = a + b (U - at) + c [U >= at].
std::optional<double> jump_of(const RecordInput& r, const Place& place, std::size_t begin, std::size_t end) {
  Eigen::Matrix3d XX = Eigen::Matrix3d::Zero();
  Eigen::Vector3d XW = Eigen::Vector3d::Zero();
  std::size_t upper = 0;
  for (std::size_t i = begin; i < end; ++i) {
    const double u = (r.U_V[i] - place.at_V) / place.half_width_V;
    const Eigen::Vector3d x(1.0, u, u >= 0.0 ? 1.0 : 0.0);
    XX += x * x.transpose();
    XW += x * r.base_force_N(i);
    upper += u >= 0.0 ? 1 : 0;
  }
  if (upper < kFewestRows || end - begin - upper < kFewestRows) return std::nullopt;
  const Eigen::LDLT<Eigen::Matrix3d> solver(XX);
  if (solver.info() != Eigen::Success || !(solver.rcond() > 1e-9)) return std::nullopt;
  return solver.solve(XW)[2];
}

// Mean over its standard error; nothing where the output does not pass often enough.
std::optional<double> jump_in_errors(const CampaignInput& c, const Place& place) {
  std::vector<double> jumps_N;
  for (const RecordInput& r : c.records) {
    if (r.U_V.size() != r.rows()) continue;
    const auto inside = [&](std::size_t i) { return r.ok[i] != 0 && !place.below(r.U_V[i]) && !place.above(r.U_V[i]); };
    for (std::size_t i = 1, end; i < r.rows(); i = end + 1) {
      for (end = i; end < r.rows() && inside(end);) ++end;
      if (end == i || end == r.rows() || r.ok[i - 1] == 0 || r.ok[end] == 0) continue;
      const bool rises = place.below(r.U_V[i - 1]) && place.above(r.U_V[end]), falls = place.above(r.U_V[i - 1]) && place.below(r.U_V[end]);
      if (!rises && !falls) continue;
      if (const auto jump_N = jump_of(r, place, i, end)) jumps_N.push_back(*jump_N);
    }
  }
  if (jumps_N.size() < kFewestPassages) return std::nullopt;
  const double n = static_cast<double>(jumps_N.size());
  double sum = 0.0, squares = 0.0;
  for (const double jump_N : jumps_N) sum += jump_N;
  for (const double jump_N : jumps_N) squares += (jump_N - sum / n) * (jump_N - sum / n);
  const double u_N = std::sqrt(squares / (n - 1.0) / n);
  return u_N > 0.0 ? std::optional(sum / n / u_N) : std::nullopt;
}

}  // namespace

bool jumps_at_codes(const CampaignInput& c, double low_V, double range_V) {
  constexpr double kErrors = 4.0, kAboveMidway = 1.5;
  constexpr int kSixteenths = 16;
  std::vector<double> at_codes;
  double midway = 0.0;
  bool has_midway = false;
  for (int k = 1; k < kSixteenths; ++k) {
    const auto errors = jump_in_errors(c, {low_V + range_V * k / kSixteenths, kHalfWidth * range_V});
    if (!errors) continue;
    if (k % 2 == 0) {
      at_codes.push_back(std::abs(*errors));
      continue;
    }
    midway = std::max(midway, std::abs(*errors));
    has_midway = true;
  }
  return has_midway && std::ranges::count_if(at_codes, [&](double errors) { return errors > std::max(kErrors, kAboveMidway * midway); }) >= 2;
}

}  // namespace forcegate::diagnose
