#include <algorithm>
#include <array>
#include <cmath>

#include "hil/model/rows.h"
#include "hil/trace/extrema.h"

namespace forcegate {

namespace {

struct Cycles {
  std::vector<double> turn_s;
  double first_s = 0.0;
};

Cycles find_cycles(const RecordInput& record, double prominence_N) {
  Cycles out;
  TurningPoints turning(prominence_N);
  for (std::size_t i = 0; i < record.rows(); ++i)
    if (turning.push(record.t_s[i], record.F_N[i])) out.turn_s.push_back(turning.last().t_s);
  return out;
}

bool is_static_kind(const std::string& kind) {
  return kind == "ramp" || kind == "staircase" || kind == "hold" || kind == "rest" || kind == "steps" ||
         kind == "step";
}

double share_moving(const RecordInput& record, double range_N) {
  std::size_t moving = 0;
  for (double rate : record.rate_N_per_s)
    if (std::abs(rate) > 0.02 * range_N) ++moving;
  return static_cast<double>(moving) / static_cast<double>(std::max<std::size_t>(1, record.rows()));
}

// A jump: the mean half period over three turns changes by more than 1.4 while both sides are steady within 25 %.
void find_jumps(RecordInput& record, const std::vector<double>& turn_s) {
  constexpr std::size_t kSide = 4;
  std::vector<double> half;
  for (std::size_t i = 1; i < turn_s.size(); ++i) half.push_back(turn_s[i] - turn_s[i - 1]);
  double last_jump = -1e9;
  for (std::size_t i = kSide; i + kSide + 1 <= half.size(); ++i) {
    const auto stats = [&](std::size_t from) {
      double low = half[from], high = half[from], sum = 0.0;
      for (std::size_t k = from; k < from + kSide; ++k) {
        low = std::min(low, half[k]);
        high = std::max(high, half[k]);
        sum += half[k];
      }
      return std::array<double, 2>{sum / kSide, (high - low) / (sum / kSide)};
    };
    const auto before = stats(i - kSide), after = stats(i + 1);
    const double ratio = std::log(before[0] / after[0]);
    if (std::abs(ratio) < std::log(1.4) || before[1] > 0.25 || after[1] > 0.25) continue;
    if (turn_s[i] - last_jump < 3.0 * std::max(before[0], after[0])) continue;
    // the half period that holds the jump belongs to neither side
    record.frequency_jumps_s.push_back(turn_s[i] + 0.5 * half[i]);
    record.jump_log_ratio.push_back(ratio);
    last_jump = turn_s[i];
  }
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
  const Cycles cycles = find_cycles(record, 0.08 * range_N);
  const std::size_t turns = cycles.turn_s.size();
  record.dynamic_assumed = declared == nullptr || !declared->dynamic.has_value();
  record.dynamic = record.dynamic_assumed ? turns >= fewest_turns && !is_static_kind(record.kind) : *declared->dynamic;

  std::vector<double> half;
  for (std::size_t i = 1; i < turns; ++i) half.push_back(cycles.turn_s[i] - cycles.turn_s[i - 1]);
  const double typical_half_s = half.empty() ? record.duration_s : quantile(half, 0.5);

  const double seen_s = turns > 0 && record.dynamic ? std::max(0.0, cycles.turn_s.front() - typical_half_s) : 0.0;
  record.onset_s = declared != nullptr && declared->excitation_start_s ? since_start_s(record, *declared->excitation_start_s, seen_s) : seen_s;

  std::vector<double> settled;
  const double from_s = std::min(record.onset_s + typical_half_s, 0.5 * record.duration_s);
  for (std::size_t i = 0; i < record.rows(); ++i)
    if (record.t_s[i] >= from_s && record.ok[i] != 0) settled.push_back(record.F_N[i]);
  if (settled.empty()) settled = record.F_N;
  const auto [low, high] = quantiles(std::move(settled), 0.01, 0.99);
  record.F_min_N = low;
  record.A_N = declared != nullptr && declared->A_N ? *declared->A_N : 0.5 * (high - low);
  if (!(record.A_N > 0.0)) record.A_N = 0.5 * (high - low);
  record.f_Hz =
      declared != nullptr && declared->f_min_Hz ? *declared->f_min_Hz : 0.5 / std::max(typical_half_s, 1e-3);
  if (!record.dynamic)
    set_static(record);
  else
    find_jumps(record, cycles.turn_s);
}

bool stands_mostly_still(const RecordInput& record, double range_N) {
  return share_moving(record, range_N) <= 0.4;
}

void set_static(RecordInput& record) {
  record.dynamic = false;
  record.f_Hz = 0.0;
  record.F_min_N = 0.0;
  record.onset_s = 0.0;
  record.frequency_jumps_s.clear();
  record.jump_log_ratio.clear();
}

}  // namespace forcegate
