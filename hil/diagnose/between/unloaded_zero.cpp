#include "hil/diagnose/between/unloaded_zero.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>
#include <vector>

#include "hil/diagnose/base/own_lines.h"
#include "hil/model/rows.h"

namespace forcegate::diagnose {

namespace {

// Of a record, or of a stretch of one recording.
struct Rest {
  std::size_t at = 0;    // which of them
  double where = 0.0;    // UnloadedZero::at
  double force_N = 0.0;  // what the reference shows at its lowest load
  double output_N = 0.0; // what stands there, by the gain of all
  double zero_N = 0.0;   // of the output
  double load_N() const { return force_N + zero_N; }
};

struct Lowest {
  double force_N = 0.0, output_V = 0.0;
};

std::optional<Lowest> lowest_of(const RecordInput& r, std::size_t begin, std::size_t end) {
  constexpr double kLowest = 0.02;
  constexpr std::size_t kFewest = 5;
  std::vector<std::pair<double, double>> rows;
  for (std::size_t i = begin; i < end; ++i)
    if (r.ok[i] != 0) rows.emplace_back(r.F_N[i], r.U_V[i]);
  if (rows.size() < kFewest) return std::nullopt;
  std::ranges::sort(rows);
  rows.resize(std::max(kFewest, static_cast<std::size_t>(kLowest * static_cast<double>(rows.size()))));
  Lowest out{rows[rows.size() / 2].first, 0.0};
  for (const auto& [force_N, output_V] : rows) out.output_V += output_V / static_cast<double>(rows.size());
  return out;
}

std::vector<Rest> rests_of_records(const Workspace& w, const MixedFit& fit) {
  std::vector<Rest> out;
  for (std::size_t k = 0; k < fit.zeta.size(); ++k) {
    const RecordInput& r = w.input.records[w.output.record_of[k]];
    const std::optional<Lowest> lowest = lowest_of(r, 0, r.rows());
    if (!lowest) continue;
    const double gain = fit.zeta[k][0] * w.gain_V_per_N * lowest->force_N / w.output.scale;
    out.push_back({k, static_cast<double>(w.output.record_of[k] + 1), lowest->force_N, lowest->output_V / w.gain_V_per_N, (fit.zeta[k][1] + gain) * w.output.scale / w.gain_V_per_N});
  }
  return out;
}

// Stretches of one recording, of which each has a zero of its own.
std::vector<Rest> rests_of_stretches(const Workspace& w, const MixedFit& fit) {
  constexpr std::size_t kStretches = 12;
  constexpr Eigen::Index kFewestRows = 20;
  std::vector<Rest> out;
  std::vector<LineSums> sums;
  const std::size_t parts = w.output.rows.size(), of_part = (kStretches + parts - 1) / std::max<std::size_t>(1, parts);
  for (std::size_t k = 0; k < parts; ++k) {
    const RecordInput& r = w.input.records[w.output.record_of[k]];
    const std::vector<std::size_t>& row = w.output.rows[k].row;
    for (std::size_t s = 0; s < of_part; ++s) {
      const std::size_t begin = s * r.rows() / of_part, end = (s + 1) * r.rows() / of_part;
      const auto first = std::ranges::lower_bound(row, begin) - row.begin(), last = std::ranges::lower_bound(row, end) - row.begin();
      const std::optional<Lowest> lowest = lowest_of(r, begin, end);
      if (!lowest || last - first < kFewestRows) continue;
      out.push_back({k * of_part + s, r.clock_start_s + r.t_s[row[static_cast<std::size_t>(first + last) / 2]], lowest->force_N, lowest->output_V / w.gain_V_per_N, 0.0});
      sums.push_back(line_sums(w.output, fit, k, first, last));
    }
  }
  if (sums.empty()) return out;
  const Eigen::VectorXd zeros = line_through(sums, OwnOfLine::zero).own;
  for (std::size_t i = 0; i < out.size(); ++i) out[i].zero_N = zeros[static_cast<Eigen::Index>(i)] * w.output.scale / w.gain_V_per_N;
  return out;
}

std::vector<Rest> rests_of(const Workspace& w, const MixedFit& fit) { return w.input.single ? rests_of_stretches(w, fit) : rests_of_records(w, fit); }

template <class Of>
double mean_of(const std::vector<Rest>& rests, const Of& of) {
  double mean = 0.0;
  for (const Rest& r : rests) mean += std::invoke(of, r) / static_cast<double>(rests.size());
  return mean;
}

template <class Of>
double spread_of(const std::vector<Rest>& rests, const Of& of) {
  const double mean = mean_of(rests, of);
  double square = 0.0;
  for (const Rest& r : rests) square += std::pow(std::invoke(of, r) - mean, 2);
  return std::sqrt(square / std::max(1.0, static_cast<double>(rests.size()) - 1.0));
}

// Less the one that stands furthest off: the zero of a single record may have taken its decay, or its load.
double spread_without_furthest(std::vector<Rest> rests) {
  const double mean = mean_of(rests, &Rest::zero_N);
  rests.erase(std::ranges::max_element(rests, {}, [mean](const Rest& r) { return std::abs(r.zero_N - mean); }));
  return spread_of(rests, &Rest::zero_N);
}

// Those that come down to the lowest load, where the zeros tell.
std::optional<std::vector<Rest>> told_rests(const Workspace& w, const MixedFit& fit) {
  constexpr std::size_t kFewest = 4;
  constexpr double kOfSpread = 0.3, kOfSpreadUnderLoad = 0.1, kOfAll = 0.5, kOfRange = 0.005, kSteps = 3.0, kTared = 2.0, kStandsStill = 0.5;
  if (w.rig_shows == RigShows::zero_of_records || w.has_command || w.input.has_capacitance || !fit.valid || w.gain_V_per_N == 0.0) return std::nullopt;
  std::vector<Rest> rests = rests_of(w, fit);
  const std::size_t least = std::max(kFewest, (rests.size() + 1) / 2);
  double step_N = 0.0;
  for (const RecordHealth& h : w.health) step_N = std::max(step_N, h.lsb_F_N);
  const double seen_N = std::max(kOfRange * w.input.range_N, kSteps * step_N), least_N = std::max(seen_N, kOfAll * spread_of(rests, &Rest::zero_N));
  // where every force stands far from zero beside what they differ by, they are loads of a bench that never lets go, and agree by chance sooner
  // which of them come down to the lowest load nobody says: what is left unloaded has no lower one
  std::ranges::sort(rests, {}, &Rest::load_N);
  for (; rests.size() >= least; rests.pop_back()) {
    const double moves_N = spread_of(rests, &Rest::zero_N);
    const bool tared = std::ranges::any_of(rests, [&](const Rest& r) { return std::abs(r.force_N) <= kTared * moves_N; });
    // the zeros of records that never come down may have taken the place of their loads: the output itself tells
    const bool stands_still = spread_of(rests, &Rest::output_N) <= kStandsStill * moves_N;
    const bool of_several = w.input.single || spread_without_furthest(rests) >= seen_N;
    if (moves_N >= least_N && of_several && stands_still && spread_of(rests, &Rest::load_N) <= (tared ? kOfSpread : kOfSpreadUnderLoad) * moves_N) return rests;
  }
  return std::nullopt;
}

}  // namespace

std::optional<UnloadedZero> unloaded_zero_of_reference(const Workspace& w, const MixedFit& fit) {
  const auto rests = told_rests(w, fit);
  if (!rests) return std::nullopt;
  UnloadedZero out{rests->size(), rests_of(w, fit).size(), spread_of(*rests, &Rest::zero_N), {}, {}, {}};
  std::vector<Rest> in_order = *rests;
  std::ranges::sort(in_order, {}, &Rest::where);
  const double shown_N = mean_of(in_order, &Rest::force_N), left_N = mean_of(in_order, &Rest::load_N);
  for (const Rest& r : in_order) {
    out.at.push_back(r.where);
    out.shown_N.push_back(r.force_N - shown_N);
    out.left_N.push_back(r.load_N() - left_N);
  }
  return out;
}

std::vector<std::string> contradicted_without_load(const Workspace& w, const Selection& selection) {
  constexpr double kExplained = 0.9;  // an effect that changes the gain alone leaves the zeros as they are
  const auto may_be = [&](const ChosenEffect& c) { return c.kind->side == "sensor" && (c.between || w.input.single); };
  if (std::ranges::none_of(selection.chosen, may_be)) return {};
  const auto rests = told_rests(w, selection.base);
  if (!rests) return {};
  const auto moves_N = [&](const MixedFit& fit) {
    std::vector<Rest> same = rests_of(w, fit);
    std::erase_if(same, [&](const Rest& r) { return std::ranges::find(*rests, r.at, &Rest::at) == rests->end(); });
    return spread_of(same, &Rest::zero_N);
  };
  std::vector<std::string> out;
  double before_N = moves_N(selection.base);
  for (const ChosenEffect& c : selection.chosen) {
    if (!c.fit.valid) continue;
    const double after_N = moves_N(c.fit);
    if (may_be(c) && after_N < kExplained * before_N) out.push_back(c.kind->name);
    before_N = after_N;
  }
  return out;
}

}  // namespace forcegate::diagnose
