#include "hil/diagnose/answer/claim_evidence.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>

#include "hil/diagnose/answer/load_direction.h"
#include "hil/diagnose/answer/residual_map.h"
#include "hil/diagnose/base/some_columns.h"
#include "hil/diagnose/candidates/cause_course.h"
#include "hil/diagnose/choose/refit_chosen.h"

namespace forcegate::diagnose {

namespace {

using Eigen::Index;

constexpr std::size_t kPoints = 700, kTried = 3, kMostRecords = 60;

MixedFit fit_without(const ResidualChannel& channel, const std::vector<int>& columns, const MixedFit& warm, std::optional<std::size_t> left_out) {
  constexpr int kIterations = 8;
  std::vector<int> all(columns.size());
  for (std::size_t a = 0; a < all.size(); ++a) all[a] = static_cast<int>(a);
  MixedProblem problem = with_columns(channel.problem, columns);
  if (left_out)
    for (std::size_t i = 0; i < problem.records.size(); ++i) problem.records[i].heldout = i == *left_out;
  const MixedFit start = with_columns(warm, columns);
  MixedFit out = fit_mixed(problem, all, &start, kIterations);
  out.columns = columns;
  return out;
}

struct Pair {
  MixedFit without, with;
  bool valid() const { return without.valid && with.valid; }
  double fall(std::size_t record) const { return without.adapted[record] - with.adapted[record]; }
};

Pair fit_both(const ResidualChannel& channel, const Selection& selection, const ChosenEffect& effect, std::optional<std::size_t> left_out) {
  // both may follow a record by the same spread: a late reference or an angle's zero that differs at will would take a loop for itself
  const auto fitted = [&](const std::vector<int>& columns) {
    MixedFit fit = fit_without(channel, columns, selection.claimed, left_out);
    return fit.valid ? at_freedom_of(channel.problem, std::move(fit), selection.base) : fit;
  };
  return {fitted(columns_beside(channel, selection, effect)), fitted(selection.claimed.columns)};
}

// A channel with one selection in it.
struct Chosen {
  const Workspace& w;
  const ResidualChannel& channel;
  const Selection& selection;
  const EvidenceAxes& axes;

  const RecordInput& record(std::size_t k) const { return w.input.records[channel.record_of[k]]; }
};

// Empty where the record has no such channel.
std::vector<double> axis(const RecordInput& r, const std::vector<std::size_t>& rows, const std::string& name) {
  std::vector<double> out;
  if (name == "angle") {
    if (r.cos_theta.empty()) return out;
    for (const std::size_t i : rows) out.push_back(std::atan2(r.sin_theta[i], r.cos_theta[i]) * 180.0 / std::numbers::pi);
    return out;
  }
  const std::vector<double>& x = name == "force" ? r.F_N : name == "rate" ? r.rate_N_per_s : name == "command" ? r.F_cmd_N : r.t_s;
  if (x.empty()) return out;
  for (const std::size_t i : rows) out.push_back(x[i]);
  return out;
}

std::string unit_of(const std::string& axis) {
  return axis == "force" || axis == "command" ? "N" : axis == "rate" ? "N/s" : axis == "angle" ? "deg" : "s";
}

// A hold says nothing against force, a staircase nothing against its rate: nearly all rows are at a few values.
bool tells(const Chosen& c, std::size_t k, const std::string& x_name) {
  constexpr double kEnd = 0.1, kInside = 0.2;
  if (x_name == "time") return true;
  const std::vector<double> x = axis(c.record(k), c.channel.rows[k].row, x_name);
  if (x.empty()) return false;
  const auto [low, high] = std::ranges::minmax(x);
  const double margin = kEnd * (high - low), middle = 0.5 * (low + high);
  const auto inside = std::ranges::count_if(
      x, [&, low = low, high = high](double v) { return v > low + margin && v < high - margin && std::abs(v - middle) > 0.5 * margin; });
  return static_cast<double>(inside) > kInside * static_cast<double>(x.size());
}

// The records that a picture can be of, the ones that gain most first, with fits that have not seen them.
class Unseen {
 public:
  Unseen(const Chosen& chosen, const ChosenEffect& effect)
      : chosen_(chosen), effect_(effect), of_all_(fit_both(chosen.channel, chosen.selection, effect, std::nullopt)) {
    if (!of_all_.valid()) return;
    const auto& records = chosen.channel.problem.records;
    for (std::size_t k = 0; k < records.size(); ++k) (records[k].heldout ? heldout_ : others_).push_back(k);
    for (std::vector<std::size_t>* order : {&heldout_, &others_})
      std::ranges::stable_sort(*order, [&](std::size_t a, std::size_t b) { return of_all_.fall(a) > of_all_.fall(b); });
  }

  const Pair& fits(std::size_t record) {
    const MixedProblem& p = chosen_.channel.problem;
    if (chosen_.w.judges == JudgedBy::whole || p.records.size() < 2 || p.records[record].heldout) return of_all_;
    const auto at = left_out_.find(record);
    return at != left_out_.end() ? at->second
                                 : left_out_.emplace(record, fit_both(chosen_.channel, chosen_.selection, effect_, record)).first->second;
  }

  // A held-out record that the effect hardly touches shows nothing: then one of the others.
  std::optional<std::size_t> best(const std::string& x_name) {
    constexpr double kShows = 0.1;  // of the mean square
    const auto heldout = best_of(heldout_, x_name);
    if (heldout && fits(*heldout).fall(*heldout) > kShows * fits(*heldout).without.adapted[*heldout]) return heldout;
    const auto other = best_of(others_, x_name);
    return other && (!heldout || fits(*other).fall(*other) > fits(*heldout).fall(*heldout)) ? other : heldout;
  }

 private:
  std::optional<std::size_t> best_of(const std::vector<std::size_t>& order, const std::string& x_name) {
    std::optional<std::size_t> out;
    std::size_t tried = 0;
    for (const std::size_t k : order) {
      if (tried == kTried) break;
      if (!tells(chosen_, k, x_name)) continue;
      ++tried;
      if (fits(k).valid() && (!out || fits(k).fall(k) > fits(*out).fall(*out))) out = k;
    }
    return out;
  }

  const Chosen& chosen_;
  const ChosenEffect& effect_;
  Pair of_all_;
  std::vector<std::size_t> heldout_, others_;
  std::map<std::size_t, Pair> left_out_;
};

// Without what the record has of its own, a gain and a zero.
Eigen::VectorXd rows_without_own(const ResidualChannel& channel, const MixedFit& fit, std::size_t k) {
  const MixedProblem& p = channel.problem;
  const Eigen::MatrixXd& A = channel.rows[k].matrix;
  Eigen::VectorXd e = A.col(p.y_index()) - A.leftCols(p.n_fixed) * fit.coefficient.head(p.n_fixed);
  for (const int column : fit.columns) e -= A.col(p.nz + column) * fit.strength_of(column);
  return channel.scale * e;
}

// The cause at the rows of every record; empty where a record has but one, nearly.
std::vector<Eigen::VectorXd> cause_within_records(const Chosen& c, const ChosenEffect& effect) {
  const Candidate& of = candidate_of(c.channel, effect.variant);
  std::vector<Eigen::VectorXd> out;
  if (!runs_within_records(c.w.input, of)) return out;
  for (std::size_t k = 0; k < c.channel.rows.size(); ++k) {
    const std::vector<double> x = of.form->cause.of_rows(c.w.input, c.record(k), of.shape);
    const std::vector<std::size_t>& rows = c.channel.rows[k].row;
    out.emplace_back(x.empty() ? Index{0} : static_cast<Index>(rows.size()));
    for (Index j = 0; j < out.back().size(); ++j) out.back()[j] = x[rows[static_cast<std::size_t>(j)]];
  }
  return out;
}

// Without the records' own gains and zeros, which would hide it.
std::optional<EvidenceSeries> between_series(const Chosen& c, const ChosenEffect& effect) {
  constexpr Index kStretches = 8;
  const CampaignInput& input = c.w.input;
  const std::size_t n = c.channel.problem.records.size();
  const bool can_leave_out = c.w.judges != JudgedBy::whole && n > 2 && n <= kMostRecords;
  const Pair of_all = fit_both(c.channel, c.selection, effect, std::nullopt);
  const RecordedCause& cause = candidate_of(c.channel, effect.variant).form->cause;
  const bool timed = input.has_start_times || input.single;
  const std::vector<Eigen::VectorXd> within = cause_within_records(c, effect);
  const auto of_record = [&](std::size_t k) {
    const RecordInput& r = c.record(k);
    if (cause.of_record) return cause.of_record(r);
    return timed ? (r.start_s + (input.single ? r.t_s[c.channel.rows[k].row.front()] : 0.0)) / 60.0 : static_cast<double>(k) + 1.0;
  };
  EvidenceSeries s;
  s.title = "mean " + c.axes.residual + (within.empty() ? " of every record" : " of every eighth of a record") +
            (can_leave_out ? within.empty() ? ", each left out in turn" : ", each record left out in turn" : "");
  s.x_name = cause.of_record ? cause.name + (within.empty() ? "" : " of the film") : timed ? "start in campaign time" : "record, in order";
  s.x_unit = cause.of_record ? cause.unit : timed ? "min" : "1";
  s.y_unit = c.channel.unit;
  for (std::size_t k = 0; k < n; ++k) {
    const Pair own = can_leave_out ? fit_both(c.channel, c.selection, effect, k) : of_all;
    const auto rows = static_cast<Index>(c.channel.rows[k].row.size());
    if (!own.valid() || rows == 0 || (!within.empty() && within[k].size() == 0)) continue;
    const Eigen::VectorXd before = rows_without_own(c.channel, own.without, k), after = rows_without_own(c.channel, own.with, k);
    const Index stretches = within.empty() ? 1 : std::min(kStretches, rows);
    for (Index i = 0; i < stretches; ++i) {
      const Index from = i * rows / stretches, count = (i + 1) * rows / stretches - from;
      s.x.push_back(within.empty() ? of_record(k) : within[k].segment(from, count).mean());
      s.before.push_back(before.segment(from, count).mean());
      s.after.push_back(after.segment(from, count).mean());
    }
  }
  if (s.x.size() < 3) return std::nullopt;
  return s;
}

EvidenceSeries residual_series(const Chosen& c, std::size_t k, const std::string& x_name, const Pair& fits) {
  const RecordInput& r = c.record(k);
  const std::vector<std::size_t>& rows = c.channel.rows[k].row;
  const std::vector<double> x = axis(r, rows, x_name), before = residual_rows(c.channel, fits.without)[k], after = residual_rows(c.channel, fits.with)[k];
  const std::vector<double> direction = load_direction(r, c.w.input.range_N);
  EvidenceSeries s;
  s.record = r.name;
  s.x_name = x_name;
  s.x_unit = unit_of(x_name);
  s.y_unit = c.channel.unit;
  s.title = c.axes.residual + " against " + x_name + ", coloured by direction";
  const std::size_t stride = std::max<std::size_t>(1, rows.size() / kPoints);
  for (std::size_t j = 0; j < rows.size(); j += stride) {
    s.x.push_back(x[j]);
    s.before.push_back(before[j]);
    s.after.push_back(after[j]);
    s.colour.push_back(direction[rows[j]]);
  }
  return s;
}

}  // namespace

void add_claim_evidence(const Workspace& w, const ResidualChannel& channel, const Selection& selection, const EvidenceAxes& axes,
                        std::vector<Finding>& findings) {
  constexpr std::size_t kMostAxes = 3;
  if (!selection.claimed.valid) return;
  const Chosen chosen{w, channel, selection, axes};
  for (const ChosenEffect& effect : selection.chosen) {
    const auto claim = std::ranges::find_if(findings, [&](const Finding& f) {
      return f.effect == effect.kind->name && f.shown_in == channel.shown_in && f.claimed() && f.series.empty();
    });
    if (claim == findings.end()) continue;
    if (effect.between) {
      if (auto series = between_series(chosen, effect)) claim->series.push_back(std::move(*series));
      continue;
    }
    Unseen unseen(chosen, effect);
    for (const std::string& x : axes.names) {
      if (claim->series.size() == kMostAxes) break;
      const std::optional<std::size_t> k = unseen.best(x);
      if (k) claim->series.push_back(residual_series(chosen, *k, x, unseen.fits(*k)));
    }
  }
}

}  // namespace forcegate::diagnose
