#include "hil/model/came_in.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace forcegate {

namespace {

constexpr std::size_t kSections = std::size_t{1} << kUpperBits;
constexpr auto kBits = static_cast<Eigen::Index>(kUpperBits);
// sums over rows of: 1, F, U
using Sums = Eigen::Vector3d;

// One record, its rows in the order of the force (turned over where the output falls with it), with running sums: what lies between two forces is a difference.
struct Sorted {
  std::vector<double> F;
  std::vector<Sums> below;
  double FF = 0.0, FU = 0.0, UU = 0.0;
};

Sorted sorted(const RecordInput& r, double sign) {
  constexpr std::size_t kRows = 500;
  std::vector<std::pair<double, double>> rows;
  for (std::size_t i = 0; i < r.rows(); i += 1 + r.rows() / kRows)
    if (r.ok[i] && std::isfinite(r.base_force_N(i)) && std::isfinite(r.U_V[i]))
      rows.emplace_back(sign * r.base_force_N(i), r.U_V[i]);
  std::sort(rows.begin(), rows.end());
  Sorted out;
  out.below.push_back(Sums::Zero());
  for (const auto& [F, U] : rows) {
    out.F.push_back(F);
    out.below.push_back(out.below.back() + Sums(1.0, F, U));
    out.FF += F * F;
    out.FU += F * U;
    out.UU += U * U;
  }
  return out;
}

CameInLine line_through(const std::vector<Sorted>& records) {
  CameInLine out;
  if (records.empty()) return out;
  Sums all = Sums::Zero();
  double FF = 0.0, FU = 0.0;
  for (const Sorted& r : records) {
    all += r.below.back();
    FF += r.FF;
    FU += r.FU;
  }
  const double spread = all[0] * FF - all[1] * all[1];
  if (!(spread > 1e-9 * all[0] * FF)) return out;
  out.slope_V_per_N = (all[0] * FU - all[1] * all[2]) / spread;
  out.level_V = (all[2] - out.slope_V_per_N * all[1]) / all[0];
  return out;
}

// Sum of squares of U that a line in each record and one size for each bit leave.
double left_by(const CameInLine& line, const std::vector<Sorted>& records, double low_V, double range_V) {
  static const auto kBitsOf = [] {
    std::array<Eigen::Matrix<double, kBits, 1>, kSections> out;
    for (std::size_t s = 0; s < kSections; ++s) {
      const auto bits = upper_bits((static_cast<double>(s) + 0.5) / static_cast<double>(kSections));
      out[s] = Eigen::Map<const Eigen::Matrix<double, kBits, 1>>(bits.data());
    }
    return out;
  }();
  Eigen::Matrix<double, kBits, kBits> G = Eigen::Matrix<double, kBits, kBits>::Zero();
  Eigen::Matrix<double, kBits, 1> g = Eigen::Matrix<double, kBits, 1>::Zero();
  double out = 0.0;
  for (const Sorted& r : records) {
    // bits against 1, F and U, and against each other
    Eigen::Matrix<double, kBits, 3> with = Eigen::Matrix<double, kBits, 3>::Zero();
    Eigen::Matrix<double, kBits, kBits> among = Eigen::Matrix<double, kBits, kBits>::Zero();
    std::size_t from = 0;
    for (std::size_t s = 0; s < kSections && from < r.F.size(); ++s) {
      const double top_N =
          (low_V + range_V * static_cast<double>(s + 1) / static_cast<double>(kSections) - line.level_V) /
          line.slope_V_per_N;
      const std::size_t to =
          s + 1 == kSections
              ? r.F.size()
              : static_cast<std::size_t>(
                    std::lower_bound(r.F.begin() + static_cast<std::ptrdiff_t>(from), r.F.end(), top_N) -
                    r.F.begin());
      const Sums sums = r.below[to] - r.below[from];
      with += kBitsOf[s] * sums.transpose();
      among += sums[0] * kBitsOf[s] * kBitsOf[s].transpose();
      from = to;
    }
    const Sums& all = r.below.back();
    Eigen::Matrix2d own;
    own << all[0], all[1], all[1], r.FF;
    own.diagonal() *= 1.0 + 1e-12;
    const Eigen::Vector2d of_U(all[2], r.FU);
    const Eigen::Matrix2d inverse = own.inverse();
    const Eigen::Matrix<double, kBits, 2> of_bits = with.leftCols<2>();
    out += r.UU - of_U.dot(inverse * of_U);
    G += among - of_bits * inverse * of_bits.transpose();
    g += with.col(2) - of_bits * inverse * of_U;
  }
  G.diagonal().array() += 1e-9 * (1.0 + G.trace());
  return out - g.dot(G.ldlt().solve(g));
}

}  // namespace

std::array<double, kUpperBits> upper_bits(double share) {
  std::array<double, kUpperBits> out{};
  for (double& bit : out) {
    share *= 2.0;
    bit = share >= 1.0 ? 1.0 : 0.0;
    share -= bit;
  }
  return out;
}

double lowest_code_V(const BenchFacts& bench) { return std::isfinite(bench.voltage_min_V) ? bench.voltage_min_V : 0.0; }

CameInLine find_came_in(const CampaignInput& campaign, double low_V, double range_V) {
  constexpr double kSlope = 0.3, kLevel = 0.06;
  constexpr int kHalf = 12, kTimes = 5;
  constexpr std::size_t kFewestRows = 50;
  const bool any_fit = std::ranges::any_of(campaign.records, [](const RecordInput& r) { return !r.heldout; });
  double sign = 1.0;
  std::vector<Sorted> records;
  const auto sort_all = [&] {
    records.clear();
    for (const RecordInput& r : campaign.records) {
      if (r.heldout && any_fit) continue;
      Sorted one = sorted(r, sign);
      if (one.F.size() >= kFewestRows && one.F.back() > one.F.front()) records.push_back(std::move(one));
    }
    return line_through(records);
  };
  CameInLine through = sort_all();
  if (through.slope_V_per_N < 0.0) {
    sign = -1.0;
    through = sort_all();
  }
  if (!(through.slope_V_per_N > 0.0)) return through;
  CameInLine out = through, middle = through;
  double least = left_by(out, records, low_V, range_V), slope_step = kSlope / kHalf * through.slope_V_per_N,
         level_step = kLevel / kHalf * range_V;
  int half = kHalf;
  // turned about the lowest reading, where fewest bits are set
  const double pivot_N = std::ranges::min(records, {}, [](const Sorted& r) { return r.F.front(); }).F.front();
  for (int time = 0; time <= kTimes; ++time) {
    for (int a = -half; a <= half; ++a)
      for (int b = -half; b <= half; ++b) {
        const CameInLine line{middle.slope_V_per_N + a * slope_step,
                              middle.level_V + b * level_step - a * slope_step * pivot_N};
        const double left = left_by(line, records, low_V, range_V);
        if (left >= least) continue;
        least = left;
        out = line;
      }
    middle = out;
    half = 2;
    slope_step *= 0.5;
    level_step *= 0.5;
  }
  out.slope_V_per_N *= sign;
  return out;
}

}  // namespace forcegate
