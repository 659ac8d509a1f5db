#include "hil/diagnose/answer/record_course.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "hil/diagnose/base/repeatability.h"
#include "hil/trace/extrema.h"

namespace forcegate::diagnose {

namespace {

using Eigen::Index;

constexpr std::size_t kStretches = 700;

// Rows between which others are missing are no line: at more than five usual steps the clock or the samples have a gap.
bool is_gap(const RecordInput& r, std::size_t row, std::size_t next) {
  constexpr double kSteps = 5.0;
  return r.t_s[next] - r.t_s[row] > kSteps * r.row_step_s;
}

// First, smallest, largest and last of every stretch, of each channel.
std::vector<std::size_t> shown(const std::array<const std::vector<double>*, 3>& channels) {
  const std::size_t n = channels[0]->size();
  std::vector<std::size_t> out;
  const bool all = n <= 4 * kStretches;
  for (std::size_t s = 0; s < kStretches && !all; ++s) {
    const std::size_t begin = s * n / kStretches, end = (s + 1) * n / kStretches;
    out.push_back(begin);
    out.push_back(end - 1);
    for (const std::vector<double>* y : channels) {
      const auto [low, high] = std::minmax_element(y->begin() + static_cast<std::ptrdiff_t>(begin), y->begin() + static_cast<std::ptrdiff_t>(end));
      out.push_back(static_cast<std::size_t>(low - y->begin()));
      out.push_back(static_cast<std::size_t>(high - y->begin()));
    }
  }
  for (std::size_t i = 0; i < n && all; ++i) out.push_back(i);
  std::ranges::sort(out);
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

struct Course {
  const RecordInput& r;
  std::vector<std::size_t> row;
  std::vector<double> measured, modelled, difference;

  EvidenceSeries series(const std::vector<std::size_t>& kept, const std::string& unit) const {
    EvidenceSeries s;
    s.record = r.name;
    s.title = "measured (before) and modelled (after)";
    s.x_name = "time";
    s.x_unit = "s";
    s.y_unit = unit;
    const auto push = [&](double x, double before, double after) { s.x.push_back(x), s.before.push_back(before), s.after.push_back(after); };
    std::size_t last = 0;
    for (const std::size_t i : kept) {
      for (std::size_t j = last; j < i; ++j)
        if (is_gap(r, row[j], row[j + 1])) {
          push(0.5 * (r.t_s[row[j]] + r.t_s[row[j + 1]]), NAN, NAN);
          break;
        }
      push(r.t_s[row[i]], measured[i], modelled[i]);
      last = i;
    }
    return s;
  }

  // Five cycles of the middle, as indices of `row`; empty where there are few.
  std::vector<std::size_t> few_cycles() const {
    constexpr double kProminence = 0.05;  // of the span
    constexpr std::size_t kFewestTurns = 60, kHalf = 5;
    const auto [low, high] = std::ranges::minmax(measured);
    std::vector<double> t_s;
    for (const std::size_t i : row) t_s.push_back(r.t_s[i]);
    const std::vector<Extremum> turns = turning_points(t_s, measured, kProminence * (high - low));
    std::vector<std::size_t> out;
    if (turns.size() < kFewestTurns) return out;
    const double from = turns[turns.size() / 2 - kHalf].t_s, to = turns[turns.size() / 2 + kHalf].t_s;
    for (std::size_t i = 0; i < t_s.size(); ++i)
      if (t_s[i] >= from && t_s[i] <= to) out.push_back(i);
    return out;
  }
};

}  // namespace

std::vector<double> residual_on_rows(const Workspace& w, const MixedFit& fit, std::size_t k, const std::vector<std::size_t>& rows) {
  const ResidualChannel& channel = w.output;
  const MixedProblem& p = channel.problem;
  const Eigen::MatrixXd Z = repeatability_columns(w, channel.record_of[k], rows);
  const RecordInput& chosen = w.input.records[channel.record_of[k]];
  const Eigen::VectorXd coefficient = fit.coefficients(k);
  Eigen::VectorXd e = Z.col(2) * w.shifts[k].log_b + Z.col(3) * w.shifts[k].log_q - Z.leftCols(p.nz) * fit.zeta[k] -
                      Z.leftCols(p.n_fixed) * coefficient.head(p.n_fixed);
  for (Index i = 0; i < e.size(); ++i) e[i] += chosen.U_V[rows[static_cast<std::size_t>(i)]] / channel.scale;
  const auto taken_off = [&](int column) { return column < channel.taken_off.size() ? channel.taken_off[column] : 0.0; };
  if (!fit.columns.empty() || channel.taken_off.size() > 0) {
    // blocks of one recording read the columns of its first block, which alone has the force at full rate
    const auto& records = w.input.records;
    RecordInput all = *std::ranges::find_if(records, [&](const RecordInput& r) { return r.recording == chosen.recording; });
    all.wanted.clear();
    for (const Candidate& c : channel.candidates) {
      Eigen::VectorXd strength = Eigen::VectorXd::Zero(c.count);
      for (int j = 0; j < c.count; ++j) {
        const auto at = fit.place_of(c.first + j);
        strength[j] = taken_off(c.first + j) + (at ? coefficient[*at] : 0.0);
      }
      if (strength.isZero(0.0)) continue;
      Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(static_cast<Index>(all.rows()), c.count);
      c.form->columns(w.input, all, c.shape, columns);
      for (Index i = 0; i < e.size(); ++i)
        for (int j = 0; j < c.count; ++j)
          if (const double v = columns(static_cast<Index>(rows[static_cast<std::size_t>(i)]), j); std::isfinite(v)) e[i] -= channel.column_factor * v * strength[j];
    }
  }
  e *= channel.scale;
  return {e.data(), e.data() + e.size()};
}

std::vector<EvidenceSeries> record_course(const Workspace& w, const MixedFit& fit, std::size_t k) {
  const RecordInput& r = w.input.records[w.output.record_of[k]];
  Course course{r, {}, {}, {}, {}};
  for (std::size_t i = 0; i < r.rows(); ++i)
    if (r.ok[i] != 0 && std::isfinite(r.U_V[i])) course.row.push_back(i);
  if (course.row.empty()) return {};
  course.difference = residual_on_rows(w, fit, k, course.row);
  for (std::size_t i = 0; i < course.row.size(); ++i) {
    course.measured.push_back(r.U_V[course.row[i]]);
    course.modelled.push_back(course.measured.back() - course.difference[i]);
  }
  std::vector<EvidenceSeries> out = {course.series(shown({&course.measured, &course.modelled, &course.difference}), w.output.unit)};
  if (const std::vector<std::size_t> few = course.few_cycles(); !few.empty()) out.push_back(course.series(few, w.output.unit));
  return out;
}

}  // namespace forcegate::diagnose
