#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <utility>

#include "hil/base/quantile.h"
#include "hil/model/rows.h"
#include "hil/trace/extrema.h"

namespace forcegate {

namespace {

constexpr double kProminence = 0.08;  // of the range

std::vector<Extremum> turns_of(const RecordInput& record, double range_N) {
  return turning_points(record.t_s, record.F_N, kProminence * range_N);
}

std::vector<double> half_periods(const std::vector<Extremum>& turns) {
  std::vector<double> out;
  for (std::size_t i = 1; i < turns.size(); ++i) out.push_back(turns[i].t_s - turns[i - 1].t_s);
  return out;
}

// A sum of sines is at its lowest for less than the hundredth of the time that a spike may take too.
void may_be_lowest(RecordInput& record, double F_N) {
  constexpr double kAgrees = 0.02;  // of the swing
  if (std::abs(F_N - record.F_min_N) > kAgrees * 2.0 * record.A_N) record.other_F_min_N.push_back(F_N);
}

// F_min and A from where the cycles are settled.
void set_swing(RecordInput& record, double from_s) {
  std::vector<double> settled;
  for (std::size_t i = 0; i < record.rows(); ++i)
    if (record.t_s[i] >= from_s && record.ok[i] != 0) settled.push_back(record.F_N[i]);
  if (settled.empty()) settled = record.F_N;
  const double touched = quantile(settled, 0.0005);
  const auto [low, high] = quantiles(std::move(settled), 0.01, 0.99);
  record.F_min_N = low;
  record.A_N = 0.5 * (high - low);
  record.other_F_min_N.clear();
  may_be_lowest(record, touched);
}

bool is_static_kind(const std::string& kind) {
  return kind == "ramp" || kind == "staircase" || kind == "hold" || kind == "rest" || kind == "steps" ||
         kind == "step";
}

// By its own word: two cycles, of which the record may begin or end at a turn, are enough.
bool is_cyclic_kind(const std::string& kind) {
  return kind == "sine" || kind == "multisine" || kind == "sweep" || kind == "prbs" || kind == "switch";
}

double share_moving(const RecordInput& record, double range_N) {
  std::size_t moving = 0;
  for (double rate : record.rate_N_per_s)
    if (std::abs(rate) > 0.02 * range_N) ++moving;
  return static_cast<double>(moving) / static_cast<double>(std::max<std::size_t>(1, record.rows()));
}

// Turning points a half turn apart: one of the number `at` comes at at_s, both means over the side.
struct SteadySide {
  double half_period_s, spread;  // mean; share of it
  double at, at_s;
};

// Half periods `from` to `from + n`, between the turning points from `from` to `from + n`.
SteadySide steady_side(const std::vector<Extremum>& turns, std::span<const double> half, std::size_t from, std::size_t n) {
  const auto [low, high] = std::ranges::minmax(half.subspan(from, n));
  const double mean_s = (turns[from + n].t_s - turns[from].t_s) / static_cast<double>(n);
  double sum_s = 0.0;
  for (std::size_t k = from; k <= from + n; ++k) sum_s += turns[k].t_s;
  return {mean_s, (high - low) / mean_s, static_cast<double>(from) + 0.5 * static_cast<double>(n), sum_s / static_cast<double>(n + 1)};
}

// Where the phases of both sides meet, if it runs on: t with at + (t - at_s)/half_period_s the same on either side.
double instant_of_jump_s(const SteadySide& before, const SteadySide& after, double earliest_s, double latest_s) {
  const double meet_s = (after.at - before.at + before.at_s / before.half_period_s - after.at_s / after.half_period_s) / (1.0 / before.half_period_s - 1.0 / after.half_period_s);
  return std::clamp(meet_s, earliest_s, latest_s);
}

struct Jumps {
  std::vector<std::size_t> at;  ///< half period that belongs to neither side
  std::vector<double> t_s, log_ratio;
};

// The mean half period changes by more than 1.4 while both sides are steady within 25 %, over four half periods on one side and `fewest` on the
// other at least.
Jumps jumps_of(const std::vector<Extremum>& turns, std::span<const double> half, std::size_t fewest) {
  constexpr std::size_t kSide = 4;
  constexpr double kSteady = 0.25, kJump = 1.4;
  Jumps out;
  double last_jump = -1e9;
  for (std::size_t i = fewest; i + fewest + 1 <= half.size(); ++i) {
    for (const auto& [before_n, after_n] : {std::pair{kSide, kSide}, std::pair{kSide, fewest}, std::pair{fewest, kSide}}) {
      if (i < before_n || i + after_n + 1 > half.size()) continue;
      const SteadySide before = steady_side(turns, half, i - before_n, before_n), after = steady_side(turns, half, i + 1, after_n);
      const double ratio = std::log(before.half_period_s / after.half_period_s);
      if (std::abs(ratio) < std::log(kJump) || before.spread > kSteady || after.spread > kSteady) continue;
      if (turns[i].t_s - last_jump < 3.0 * std::max(before.half_period_s, after.half_period_s)) continue;
      out.at.push_back(i);
      out.t_s.push_back(instant_of_jump_s(before, after, turns[i].t_s, turns[i + 1].t_s));
      out.log_ratio.push_back(ratio);
      last_jump = turns[i].t_s;
      break;
    }
  }
  return out;
}

// Share of the half periods that are the usual one of their stretch between two jumps.
double steady_share(std::span<const double> half, const Jumps& jumps) {
  constexpr double kUsual = 0.2;
  std::size_t usual = 0, from = 0;
  for (std::size_t j = 0; j <= jumps.at.size(); ++j) {
    const std::size_t to = j < jumps.at.size() ? jumps.at[j] : half.size();
    const std::span<const double> stretch = half.subspan(from, to - from);
    if (!stretch.empty()) {
      const double middle_s = quantile(std::vector<double>(stretch.begin(), stretch.end()), 0.5);
      usual += static_cast<std::size_t>(std::ranges::count_if(stretch, [&](double h) { return std::abs(h - middle_s) < kUsual * middle_s; }));
    }
    from = std::min(to + 1, half.size());
  }
  return static_cast<double>(usual) / static_cast<double>(std::max<std::size_t>(1, half.size() - jumps.at.size()));
}

// One and a half cycles are a dwell where the load is steady between its jumps; in a sum of sines three half periods are alike by chance.
void find_jumps(RecordInput& record, const std::vector<Extremum>& turns) {
  constexpr std::size_t kShortDwell = 3, kDwell = 4;
  constexpr double kSteadyLoad = 0.8;
  const std::vector<double> half = half_periods(turns);
  Jumps jumps = jumps_of(turns, half, kShortDwell);
  if (steady_share(half, jumps) < kSteadyLoad) jumps = jumps_of(turns, half, kDwell);
  record.frequency_jumps_s = std::move(jumps.t_s);
  record.jump_log_ratio = std::move(jumps.log_ratio);
}

// The usual one before the frequency first changes.
std::optional<double> half_period_at_start_s(const RecordInput& record, const std::vector<Extremum>& turns) {
  std::vector<Extremum> first = turns;
  if (!record.frequency_jumps_s.empty()) std::erase_if(first, [&](const Extremum& turn) { return turn.t_s > record.frequency_jumps_s.front(); });
  std::vector<double> half = half_periods(first);
  if (half.empty()) return {};
  return quantile(std::move(half), 0.5);
}

// A lab reads the instant off the record's own clock, which need not begin at 0, or counts from the first sample: what lies nearer to
// where the force is seen to begin.
double since_start_s(const RecordInput& record, double declared_s, double seen_s) {
  const double by_clock = declared_s - record.clock_start_s;
  if (by_clock < 0.0 || by_clock > record.duration_s) return declared_s;
  if (declared_s > record.duration_s) return by_clock;
  return std::abs(by_clock - seen_s) <= std::abs(declared_s - seen_s) ? by_clock : declared_s;
}

}  // namespace

void estimate_excitation(RecordInput& record, const Record* declared, double range_N, std::size_t fewest_turns) {
  const std::vector<Extremum> turning = turns_of(record, range_N);
  const std::size_t turns = turning.size();
  record.dynamic_assumed = declared == nullptr || !declared->dynamic.has_value();
  constexpr std::size_t kFewestOfDeclaredCycles = 3;
  const std::size_t fewest = is_cyclic_kind(record.kind) ? std::min(fewest_turns, kFewestOfDeclaredCycles) : fewest_turns;
  record.dynamic = record.dynamic_assumed ? turns >= fewest && !is_static_kind(record.kind) : *declared->dynamic;

  if (record.dynamic) find_jumps(record, turning);
  const double typical_half_s = half_period_at_start_s(record, turning).value_or(record.duration_s);

  const double seen_s = turns > 0 && record.dynamic ? std::max(0.0, turning.front().t_s - typical_half_s) : 0.0;
  record.onset_s = declared != nullptr && declared->excitation_start_s ? since_start_s(record, *declared->excitation_start_s, seen_s) : seen_s;

  set_swing(record, std::min(record.onset_s + typical_half_s, 0.5 * record.duration_s));
  if (declared != nullptr && declared->A_N && *declared->A_N > 0.0) {
    record.A_N = *declared->A_N;
    if (declared->m_N) may_be_lowest(record, *declared->m_N - record.A_N);
  }
  record.f_Hz =
      declared != nullptr && declared->f_min_Hz ? *declared->f_min_Hz : 0.5 / std::max(typical_half_s, 1e-3);
  if (record.dynamic) return;
  const double lowest_N = record.F_min_N;
  set_static(record);
  // cycles that do not decay by their word: a change of their frequency may show all the same
  if (turns < fewest || is_static_kind(record.kind)) return;
  find_jumps(record, turning);
  record.jumps_F_min_N = lowest_N;
}

namespace {

// Where the peaks, and the valleys, begin to keep their height.
std::optional<double> steady_cycles_begin_s(const std::vector<Extremum>& turns) {
  constexpr std::size_t kFewest = 10, kLast = 8;  // turning points
  constexpr double kSameHeight = 0.15;            // of the swing
  if (turns.size() < kFewest + 2) return {};
  std::vector<double> high, low;
  for (std::size_t i = turns.size() - kLast; i < turns.size(); ++i) (turns[i].turn == Turn::maximum ? high : low).push_back(turns[i].value);
  const double top = quantile(high, 0.5), bottom = quantile(low, 0.5);
  std::size_t first = turns.size();
  while (first > 0 && std::abs(turns[first - 1].value - (turns[first - 1].turn == Turn::maximum ? top : bottom)) < kSameHeight * (top - bottom)) --first;
  // steps before it may have had the height of a peak, not its time; what goes on for long is cycling at another frequency. A cycle may
  // rise faster than it falls.
  constexpr double kLonger = 1.5;
  const auto period_s = [&](std::size_t i) { return turns[i + 2].t_s - turns[i].t_s; };
  for (std::size_t i = first; i < first + kFewest && i + 3 < turns.size(); ++i)
    if (period_s(i) > kLonger * period_s(i + 1)) first = i + 1;
  if (first < 2 || turns.size() - first < kFewest) return {};
  return std::max(0.0, turns[first].t_s - (turns[first + 2].t_s - turns[first + 1].t_s));
}

// Behind the longest stretches without a turn: cycles of any height after ramps, holds and rests.
std::vector<double> busy_stretches_begin_s(const std::vector<Extremum>& turns) {
  constexpr std::size_t kFewest = 20, kMost = 6;
  constexpr double kLonger = 3.0;  // than what follows
  const std::vector<double> half = half_periods(turns);
  std::vector<std::size_t> still;  // of `half`
  for (std::size_t i = 0; i + kFewest < half.size(); ++i)
    if (half[i] > kLonger * quantile({half.begin() + static_cast<std::ptrdiff_t>(i) + 1, half.end()}, 0.5)) still.push_back(i);
  std::ranges::stable_sort(still, std::greater<>(), [&](std::size_t i) { return half[i]; });
  still.resize(std::min(still.size(), kMost));
  std::vector<double> out;
  for (const std::size_t i : still) out.push_back(std::max(turns[i].t_s, turns[i + 1].t_s - half[i + 1]));
  return out;
}

}  // namespace

std::vector<double> cycles_may_begin_s(const RecordInput& record, double range_N) {
  const std::vector<Extremum> turns = turns_of(record, range_N);
  std::vector<double> out = busy_stretches_begin_s(turns);
  if (const std::optional<double> steady = steady_cycles_begin_s(turns)) out.insert(out.begin(), *steady);
  return out;
}

std::vector<double> turns_begin_s(const RecordInput& record, double range_N, double from_s) {
  constexpr std::size_t kMost = 6;
  const std::vector<Extremum> turns = turns_of(record, range_N);
  std::vector<double> out;
  for (std::size_t i = 0; i + 1 < turns.size() && out.size() < kMost; ++i)
    if (turns[i].t_s > from_s) out.push_back(turns[i].t_s);
  return out;
}

void begin_cycles_at(RecordInput& record, double onset_s, double range_N) {
  std::vector<Extremum> turns = turns_of(record, range_N);
  std::erase_if(turns, [&](const Extremum& turn) { return turn.t_s < onset_s; });
  if (turns.size() < 2) return;
  record.frequency_jumps_s.clear();
  record.jump_log_ratio.clear();
  find_jumps(record, turns);
  const double half_s = half_period_at_start_s(record, turns).value_or(record.duration_s);
  record.onset_s = onset_s;
  record.f_Hz = 0.5 / std::max(half_s, 1e-3);
  set_swing(record, onset_s + half_s);
}

bool stands_mostly_still(const RecordInput& record, double range_N) {
  return share_moving(record, range_N) <= 0.4;
}

void set_static(RecordInput& record) {
  record.dynamic = false;
  record.f_Hz = 0.0;
  record.F_min_N = 0.0;
  record.other_F_min_N.clear();
  record.onset_s = 0.0;
  record.frequency_jumps_s.clear();
  record.jump_log_ratio.clear();
}

}  // namespace forcegate
