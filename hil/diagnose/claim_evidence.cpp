#include "hil/diagnose/claim_evidence.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "hil/diagnose/residual_map.h"

namespace forcegate::diagnose {

namespace {

using Eigen::Index;

constexpr std::size_t kPoints = 700, kTried = 3, kMostRecords = 60;

// The problem with those columns alone and, where asked, one record more kept from the fit.
MixedProblem reduced(const MixedProblem& p, const std::vector<int>& columns, std::optional<std::size_t> left_out) {
  MixedProblem out;
  out.nz = p.nz;
  out.n_fixed = p.n_fixed;
  out.ns = static_cast<int>(columns.size());
  out.component_of_z = p.component_of_z;
  out.components = p.components;
  out.fixed_prior_sd = p.fixed_prior_sd;
  out.column_prior_sd.resize(out.ns);
  std::vector<int> at;
  for (int j = 0; j < p.nz; ++j) at.push_back(j);
  for (std::size_t a = 0; a < columns.size(); ++a) {
    out.column_prior_sd[static_cast<Index>(a)] = p.column_prior_sd[columns[a]];
    at.push_back(p.nz + columns[a]);
  }
  at.push_back(p.y_index());
  for (std::size_t i = 0; i < p.records.size(); ++i) {
    const RecordGram& from = p.records[i];
    RecordGram g{from.name, from.gram(at, at), from.n_eff, from.noise_variance, from.allowed_variance, from.smoothed_variance, from.heldout};
    if (left_out) g.heldout = i == *left_out;
    out.records.push_back(std::move(g));
  }
  return out;
}

MixedFit fit_without(const ResidualChannel& channel, const std::vector<int>& columns, const MixedFit& warm, std::optional<std::size_t> left_out) {
  constexpr int kIterations = 8;
  std::vector<int> all(columns.size());
  for (std::size_t a = 0; a < all.size(); ++a) all[a] = static_cast<int>(a);
  MixedFit out = fit_mixed(reduced(channel.problem, columns, left_out), all, &warm, kIterations);
  out.columns = columns;
  return out;
}

struct Pair {
  MixedFit without, with;
  bool valid() const { return without.valid && with.valid; }
  double fall(std::size_t record) const { return without.adapted[record] - with.adapted[record]; }
};

Pair fit_both(const ResidualChannel& channel, const Selection& selection, const ChosenEffect& effect, std::optional<std::size_t> left_out) {
  const std::vector<int>& all = selection.claimed.columns;
  std::vector<int> others;
  for (const int c : all)
    if (std::ranges::find(effect.columns, c) == effect.columns.end()) others.push_back(c);
  return {fit_without(channel, others, selection.claimed, left_out), fit_without(channel, all, selection.claimed, left_out)};
}

const std::vector<double>& axis(const RecordInput& r, const std::string& name) {
  return name == "force" ? r.F_N : name == "rate" ? r.rate_N_per_s : r.t_s;
}

// A hold says nothing against force, a staircase nothing against its rate: nearly all rows are at a few values.
bool tells(const Workspace& w, std::size_t k, const std::string& x_name) {
  constexpr double kEnd = 0.1, kInside = 0.2;
  if (x_name == "time") return true;
  const std::vector<double>& x = axis(w.input.records[w.output.record_of[k]], x_name);
  double low = INFINITY, high = -INFINITY, inside = 0.0;
  for (const std::size_t i : w.output.rows[k].row) low = std::min(low, x[i]), high = std::max(high, x[i]);
  const double margin = kEnd * (high - low), middle = 0.5 * (low + high);
  for (const std::size_t i : w.output.rows[k].row)
    inside += x[i] > low + margin && x[i] < high - margin && std::abs(x[i] - middle) > 0.5 * margin ? 1.0 : 0.0;
  return inside > kInside * static_cast<double>(w.output.rows[k].row.size());
}

// The records that a picture can be of, the ones that gain most first, with fits that have not seen them.
class Unseen {
 public:
  Unseen(const Workspace& w, const Selection& selection, const ChosenEffect& effect)
      : w_(w), selection_(selection), effect_(effect), of_all_(fit_both(w.output, selection, effect, std::nullopt)) {
    if (!of_all_.valid()) return;
    const auto& records = w.output.problem.records;
    for (std::size_t k = 0; k < records.size(); ++k)
      if (w.judges != JudgedBy::heldout || records[k].heldout) order_.push_back(k);
    std::ranges::stable_sort(order_, [&](std::size_t a, std::size_t b) { return of_all_.fall(a) > of_all_.fall(b); });
  }

  const Pair& fits(std::size_t record) {
    if (w_.judges != JudgedBy::left_out || w_.output.problem.records.size() < 2) return of_all_;
    const auto at = left_out_.find(record);
    return at != left_out_.end() ? at->second : left_out_.emplace(record, fit_both(w_.output, selection_, effect_, record)).first->second;
  }

  std::optional<std::size_t> best(const std::string& x_name) {
    std::optional<std::size_t> out;
    std::size_t tried = 0;
    for (const std::size_t k : order_) {
      if (tried == kTried) break;
      if (!tells(w_, k, x_name)) continue;
      ++tried;
      if (fits(k).valid() && (!out || fits(k).fall(k) > fits(*out).fall(*out))) out = k;
    }
    return out;
  }

 private:
  const Workspace& w_;
  const Selection& selection_;
  const ChosenEffect& effect_;
  Pair of_all_;
  std::vector<std::size_t> order_;
  std::map<std::size_t, Pair> left_out_;
};

double mean_without_own(const ResidualChannel& channel, const MixedFit& fit, std::size_t k) {
  const MixedProblem& p = channel.problem;
  const Eigen::MatrixXd& A = channel.rows[k].matrix;
  Eigen::VectorXd e = A.col(p.y_index()) - A.leftCols(p.n_fixed) * fit.coefficient.head(p.n_fixed);
  for (std::size_t b = 0; b < fit.columns.size(); ++b)
    e -= A.col(p.nz + fit.columns[b]) * fit.coefficient[p.n_fixed + static_cast<Index>(b)];
  return e.size() > 0 ? channel.scale * e.mean() : NAN;
}

// Without the records' own gains and zeros, which would hide it.
std::optional<EvidenceSeries> between_series(const Workspace& w, const Selection& selection, const ChosenEffect& effect) {
  const std::size_t n = w.output.problem.records.size();
  const bool can_leave_out = w.judges != JudgedBy::whole && n > 2 && n <= kMostRecords;
  const Pair of_all = fit_both(w.output, selection, effect, std::nullopt);
  EvidenceSeries s;
  s.title = can_leave_out ? "mean residual of every record, each left out in turn" : "mean residual of every record";
  s.x_name = w.input.has_start_times || w.input.single ? "start in campaign time" : "record, in order";
  s.x_unit = s.x_name == "record, in order" ? "1" : "min";
  s.y_unit = w.output.unit;
  for (std::size_t k = 0; k < n; ++k) {
    const Pair own = can_leave_out ? fit_both(w.output, selection, effect, k) : of_all;
    const auto& rows = w.output.rows[k].row;
    if (!own.valid() || rows.empty()) continue;
    const RecordInput& r = w.input.records[w.output.record_of[k]];
    s.x.push_back(s.x_unit == "1" ? static_cast<double>(k) + 1.0 : (r.start_s + (w.input.single ? r.t_s[rows.front()] : 0.0)) / 60.0);
    s.before.push_back(mean_without_own(w.output, own.without, k));
    s.after.push_back(mean_without_own(w.output, own.with, k));
  }
  if (s.x.size() < 3) return std::nullopt;
  return s;
}

EvidenceSeries residual_series(const Workspace& w, std::size_t k, const std::string& x_name, const std::vector<double>& before,
                               const std::vector<double>& after) {
  const RecordInput& r = w.input.records[w.output.record_of[k]];
  const auto& rows = w.output.rows[k].row;
  EvidenceSeries s;
  s.record = r.name;
  s.x_name = x_name;
  s.y_unit = w.output.unit;
  s.x_unit = x_name == "force" ? "N" : x_name == "rate" ? "N/s" : "s";
  s.title = "residual against " + x_name + ", coloured by direction";
  const std::size_t stride = std::max<std::size_t>(1, rows.size() / kPoints);
  for (std::size_t j = 0; j < rows.size(); j += stride) {
    const std::size_t i = rows[j];
    s.x.push_back(axis(r, x_name)[i]);
    s.before.push_back(before[j]);
    s.after.push_back(after[j]);
    s.colour.push_back(r.rate_N_per_s[i] > 0.0 ? 1.0 : r.rate_N_per_s[i] < 0.0 ? -1.0 : 0.0);
  }
  return s;
}

}  // namespace

void add_claim_evidence(const Workspace& w, const Selection& selection, std::vector<Finding>& findings) {
  constexpr double kClaim = 0.5;
  if (!selection.claimed.valid) return;
  for (const ChosenEffect& effect : selection.chosen) {
    const auto claim = std::ranges::find_if(findings, [&](const Finding& f) {
      return f.effect == effect.kind->name && f.form != "raw" && f.probability >= kClaim && f.series.empty();
    });
    if (claim == findings.end()) continue;
    if (effect.between) {
      if (auto series = between_series(w, selection, effect)) claim->series.push_back(std::move(*series));
      continue;
    }
    Unseen unseen(w, selection, effect);
    for (const char* x : {"force", "time", "rate"}) {
      const std::optional<std::size_t> k = unseen.best(x);
      if (!k) continue;
      const Pair& fits = unseen.fits(*k);
      claim->series.push_back(residual_series(w, *k, x, residual_rows(w.output, fits.without)[*k], residual_rows(w.output, fits.with)[*k]));
    }
  }
}

}  // namespace forcegate::diagnose
