#include "hil/diagnose/answer/uneven_wheel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "hil/base/plain_number.h"
#include "hil/diagnose/answer/residual_map.h"
#include "hil/diagnose/base/judge.h"

namespace forcegate::diagnose {

namespace {

constexpr std::size_t kAngles = 36;
constexpr double kFewestRows = 3.0;  // at an angle

struct ByAngle {
  std::array<double, kAngles> n{}, sum{};
  std::vector<std::size_t> angle;  // of every row
};

ByAngle by_angle(const RecordInput& r, const std::vector<std::size_t>& rows, const std::vector<double>& left_N) {
  ByAngle out;
  for (std::size_t j = 0; j < rows.size(); ++j) {
    const double turn = std::atan2(r.sin_theta[rows[j]], r.cos_theta[rows[j]]) / (2.0 * std::numbers::pi) + 0.5;
    const std::size_t at = std::min(kAngles - 1, static_cast<std::size_t>(turn * kAngles));
    out.angle.push_back(at);
    out.n[at] += 1.0;
    out.sum[at] += left_N[j];
  }
  return out;
}

bool comes_by_half(const ByAngle& record) { return 2 * std::ranges::count_if(record.n, [](double n) { return n >= kFewestRows; }) >= static_cast<std::ptrdiff_t>(kAngles); }

struct Foretold {
  double before = 0.0, after = 0.0, common = 0.0;  // mean squares, N^2
};

// Rows at angles that the others do not come by are foretold to be 0.
Foretold foretell(const ByAngle& record, const ByAngle& all, const std::vector<double>& left_N) {
  std::array<double, kAngles> mean{};
  for (std::size_t a = 0; a < kAngles; ++a)
    if (const double n = all.n[a] - record.n[a]; n >= kFewestRows) mean[a] = (all.sum[a] - record.sum[a]) / n;
  Foretold out;
  for (std::size_t j = 0; j < left_N.size(); ++j) {
    const double of_others = mean[record.angle[j]];
    out.before += left_N[j] * left_N[j];
    out.after += (left_N[j] - of_others) * (left_N[j] - of_others);
    out.common += of_others * of_others;
  }
  const auto n = static_cast<double>(left_N.size());
  return {out.before / n, out.after / n, out.common / n};
}

}  // namespace

std::optional<UnevenWheel> uneven_wheel(const Workspace& w, const Selection& rig) {
  constexpr std::size_t kFewestRecords = 3;
  constexpr double kTakes = 1.0 / 3.0, kLeast = 0.003;  // of the mean square; of the force range, RMS
  if (!rig.final.valid) return std::nullopt;
  const std::vector<std::vector<double>> left_N = residual_rows(w.rig, rig.final);
  std::vector<ByAngle> records;
  std::vector<const std::vector<double>*> left_of;
  ByAngle all;
  for (std::size_t k = 0; k < left_N.size(); ++k) {
    const RecordInput& r = w.input.records[w.rig.record_of[k]];
    if (r.cos_theta.empty() || left_N[k].empty()) continue;
    ByAngle record = by_angle(r, w.rig.rows[k].row, left_N[k]);
    if (!comes_by_half(record)) continue;
    for (std::size_t a = 0; a < kAngles; ++a) all.n[a] += record.n[a], all.sum[a] += record.sum[a];
    records.push_back(std::move(record));
    left_of.push_back(&left_N[k]);
  }
  std::size_t helped = 0;
  Foretold of_all;
  for (std::size_t k = 0; k < records.size(); ++k) {
    const Foretold one = foretell(records[k], all, *left_of[k]);
    helped += one.after < (1.0 - kTakes) * one.before ? 1 : 0;
    of_all.before += one.before;
    of_all.after += one.after;
    of_all.common += one.common;
  }
  if (helped < kFewestRecords || 3 * helped < 2 * records.size() || of_all.after > (1.0 - kTakes) * of_all.before) return std::nullopt;
  const double rms_N = std::sqrt(of_all.common / static_cast<double>(records.size()));
  if (rms_N < kLeast * w.input.range_N) return std::nullopt;
  return UnevenWheel{"the angle of the wheel, at which the force departs from the rig's law by " + plain_number(1e3 * rms_N) + " mN", rig_map_of_angle(w, left_N)};
}

}  // namespace forcegate::diagnose
