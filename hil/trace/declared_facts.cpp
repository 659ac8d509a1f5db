#include "hil/trace/declared_facts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <vector>

#include "hil/base/evenly_chosen.h"
#include "hil/base/plain_number.h"
#include "hil/base/text.h"
#include "hil/trace/extrema.h"

namespace forcegate {
namespace {

constexpr std::size_t kFewestTurns = 8;  // of a record that is cycled
constexpr double kHalf = 1.5;            // a peak-to-peak for its half, rpm for Hz: nothing nearer is a slip

constexpr const char* kCyclesInASecond = "f_min_Hz counts cycles in a second; of turns in a minute there are 60 times as many";

double quantile_of(std::vector<double> values, double q) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(q * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// What the samples of the force show. NaN: nothing.
struct Cycles {
  double low_N = kMissing, high_N = kMissing;          ///< all samples
  std::size_t turns = 0;                               ///< of more than a quarter of what 99 % of them span
  double swing_N = kMissing, middle_N = kMissing;      ///< of the typical half cycle: half its height, and its middle
  double fast_Hz = kMissing, slow_Hz = kMissing;       ///< of the fastest and the slowest tenth
  double typical_Hz = kMissing;
  std::vector<double> turn_s;  ///< by the clock of the file

  double half_span_N() const { return 0.5 * (high_N - low_N); }
  bool cycled() const { return turns >= kFewestTurns; }
  bool even() const { return cycled() && fast_Hz < kHalf * slow_Hz; }
  /// Turns on end up to `start_s`, where they go on behind it: a rest before it parts them.
  std::size_t turns_up_to(double start_s) const {
    const double longest_s = 1.5 / typical_Hz;
    const auto behind = std::ranges::upper_bound(turn_s, start_s);
    if (behind == turn_s.begin() || behind == turn_s.end() || *behind - *(behind - 1) > longest_s) return 0;
    std::size_t n = 1;
    for (auto at = behind - 1; at != turn_s.begin() && *at - *(at - 1) <= longest_s; --at) ++n;
    return n;
  }
};

Cycles cycles_of(const Trace& trace) {
  constexpr std::size_t kMost = 8192;
  constexpr double kTail = 0.005, kProminence = 0.25;
  Cycles out;
  const Channel* force = trace.find("F_ref");
  if (force == nullptr || force->time_base >= trace.time_bases.size()) return out;
  const std::vector<double>&F_N = force->value, &t_s = trace.time_bases[force->time_base].t_s;
  std::vector<double> some;
  EvenlyChosen choice(F_N.size(), kMost);
  for (const double F : F_N) {
    if (!std::isfinite(F)) continue;
    out.low_N = std::fmin(out.low_N, F);
    out.high_N = std::fmax(out.high_N, F);
    if (choice.next()) some.push_back(F);
  }
  if (some.empty() || t_s.size() != F_N.size()) return out;
  const std::vector<Extremum> turns = turning_points(t_s, F_N, kProminence * (quantile_of(some, 1.0 - kTail) - quantile_of(some, kTail)));
  out.turns = turns.size();
  for (const Extremum& turn : turns) out.turn_s.push_back(turn.t_s);
  std::vector<double> half_s, swing_N, middle_N;
  for (std::size_t k = 1; k < turns.size(); ++k) {
    half_s.push_back(turns[k].t_s - turns[k - 1].t_s);
    swing_N.push_back(0.5 * std::fabs(turns[k].value - turns[k - 1].value));
    middle_N.push_back(0.5 * (turns[k].value + turns[k - 1].value));
  }
  if (half_s.empty()) return out;
  const auto Hz = [&](double q) { return 0.5 / quantile_of(half_s, q); };
  out.fast_Hz = Hz(0.1), out.typical_Hz = Hz(0.5), out.slow_Hz = Hz(0.9);
  out.swing_N = quantile_of(swing_N, 0.5), out.middle_N = quantile_of(middle_N, 0.5);
  return out;
}

bool is_one_of(std::string_view kind, std::initializer_list<std::string_view> kinds) { return std::ranges::find(kinds, kind) != kinds.end(); }

/// One record against its samples.
class Check {
 public:
  Check(Record& record, std::vector<std::string>& notes) : record_(record), notes_(notes), seen_(cycles_of(record.trace)) {}

  const Cycles& seen() const { return seen_; }

  void clock() {
    if (record_.trace.time_bases.empty()) return;
    const TimeBase& base = record_.trace.time_bases.front();
    constexpr double kAgrees = 1.2;
    const double rate_Hz = base.nominal_rate_Hz;
    if (record_.rate_Hz && !base.invented && rate_Hz > 0.0 && (*record_.rate_Hz > kAgrees * rate_Hz || *record_.rate_Hz < rate_Hz / kAgrees))
      note("fs_Hz", *record_.rate_Hz, "Hz", "the clock of the file has " + plain_number(rate_Hz) + " Hz, which counts: mend one of them");
    if (record_.excitation_start_s && !base.t_s.empty() && *record_.excitation_start_s >= base.t_s.back() &&
        *record_.excitation_start_s >= base.t_s.back() - base.t_s.front())
      drop(record_.excitation_start_s, "excitation_start_s", "s", "the record ends at " + plain_number(base.t_s.back()) + " s",
           "it is in seconds, since the first sample or by the clock of the file");
  }

  // By either way of counting it: from the first sample, or by the clock.
  void start() {
    if (!record_.excitation_start_s || !seen_.cycled()) return;
    const std::vector<double>& t_s = record_.trace.time_bases.front().t_s;
    const double start_s = *record_.excitation_start_s;
    std::size_t turns = seen_.turns_up_to(start_s);
    if (t_s.front() != 0.0) turns = std::min(turns, seen_.turns_up_to(t_s.front() + start_s));
    if (turns >= kFewestTurns)
      drop(record_.excitation_start_s, "excitation_start_s", "s",
           "the force turned " + std::to_string(turns) + " times without a rest up to then", "it is where the cycles begin");
  }

  void swing() {
    constexpr double kBeyond = 1.25, kMargin = 0.1;
    if (record_.A_N && seen_.turns > 1 && *record_.A_N > kBeyond * seen_.half_span_N())
      drop(record_.A_N, "A_N", "N", "the force moves by " + plain_number(seen_.half_span_N()) + " N to either side of its middle", "A_N is half of peak to peak");
    else if (record_.A_N && *record_.A_N > 0.0 && seen_.cycled() && *record_.A_N < seen_.swing_N / kHalf)
      keep("A_N", *record_.A_N, "N", "the force moves by " + plain_number(seen_.swing_N) + " N to either side of its middle", "A_N is half of peak to peak");
    if (!record_.m_N || seen_.turns < 2) return;
    const double beyond_N = 2.0 * kMargin * seen_.half_span_N();
    const std::string lies = "the force runs from " + plain_number(seen_.low_N) + " to " + plain_number(seen_.high_N) + " N", is = "m_N is the middle force";
    if (*record_.m_N < seen_.low_N - beyond_N || *record_.m_N > seen_.high_N + beyond_N)
      drop(record_.m_N, "m_N", "N", lies, is);
    else if (seen_.cycled() && std::min(std::fabs(*record_.m_N - seen_.middle_N), std::fabs(*record_.m_N - 0.5 * (seen_.low_N + seen_.high_N))) > 0.5 * seen_.half_span_N())
      keep("m_N", *record_.m_N, "N", lies + ", its cycles about " + plain_number(seen_.middle_N) + " N", is);
  }

  void frequency() {
    if (!record_.f_min_Hz || !seen_.cycled()) return;
    if (*record_.f_min_Hz > kHalf * seen_.fast_Hz)
      drop(record_.f_min_Hz, "f_min_Hz", "Hz", "the force has no cycles above " + plain_number(seen_.fast_Hz) + " Hz", kCyclesInASecond);
    else if (record_.kind == "sine" && *record_.f_min_Hz < seen_.slow_Hz / kHalf)
      keep("f_min_Hz", *record_.f_min_Hz, "Hz", "the force of this sine has " + plain_number(seen_.typical_Hz) + " Hz", kCyclesInASecond);
  }

  /// `cycled_Hz`: typical frequency of the slowest record that is said to be dynamic; NaN: none is. `cycled`: those that are and are not said to be.
  void kind_of_load(double cycled_Hz, std::vector<std::string>& cycled) {
    if (!record_.dynamic) return;
    const bool called_cyclic = is_one_of(record_.kind, {"sine", "multisine", "sweep", "prbs", "switch"}) || record_.f_min_Hz;
    const bool called_static = is_one_of(record_.kind, {"ramp", "staircase", "hold", "rest", "steps", "step"});
    if (!*record_.dynamic && seen_.cycled() && (called_cyclic || (!called_static && seen_.even() && seen_.typical_Hz >= cycled_Hz)))
      cycled.push_back(record_.name + " (" + std::to_string(seen_.turns) + " turns, about " + plain_number(seen_.typical_Hz) + " Hz)");
    if (*record_.dynamic && seen_.turns < 2 && std::isfinite(seen_.low_N))
      notes_.push_back(record_.name + ": campaign.json says \"dynamic\": true, and the force " + (seen_.turns == 0 ? "never turns" : "turns once") +
                       "; it is taken for cyclic loading, which decays: if it is a ramp or a hold, say false");
  }

  void air() {
    constexpr double kColdest_C = -60.0, kHottest_C = 200.0, kKelvin = 273.15;
    if (const auto T = record_.temp_C; T && (*T < kColdest_C || *T > kHottest_C))
      drop(record_.temp_C, "the temperature", "degC", "no such sensor works outside " + plain_number(kColdest_C) + " .. " + plain_number(kHottest_C) + " degC",
           *T > kHottest_C && *T < kHottest_C + kKelvin ? "in kelvin it is temp_K" : "temp_C is in degree Celsius");
    if (const auto h = record_.humidity_pct; h && (*h < 0.0 || *h > 100.0))
      drop(record_.humidity_pct, "the humidity", "%", "relative humidity is between 0 and 100 %", "humidity_pct is in percent");
  }

 private:
  void note(const std::string& key, double declared, const std::string& unit, const std::string& rest) {
    notes_.push_back(record_.name + ": campaign.json says " + key + " " + shortest(declared) + (unit.empty() ? "" : " ") + unit + ", and " + rest);
  }
  void drop(std::optional<double>& value, const std::string& key, const std::string& unit, const std::string& measured, const std::string& hint) {
    note(key, *value, unit, measured + ": it is not used; mend it or leave it out (" + hint + ")");
    value.reset();
  }
  void keep(const std::string& key, double declared, const std::string& unit, const std::string& measured, const std::string& hint) {
    note(key, declared, unit, measured + ": what is declared counts; mend it, or leave it out and it is measured (" + hint + ")");
  }

  Record& record_;
  std::vector<std::string>& notes_;
  Cycles seen_;
};

bool says_something(const Record& r) {
  return r.rate_Hz || r.excitation_start_s || r.f_min_Hz || r.A_N || r.m_N || r.dynamic || r.temp_C || r.humidity_pct;
}

}  // namespace

void check_declared_facts(Campaign& campaign) {
  std::vector<Check> checks;
  double cycled_Hz = kMissing;
  for (Record& record : campaign.records) {
    if (!says_something(record)) continue;
    checks.emplace_back(record, campaign.notes);
    const Cycles& seen = checks.back().seen();
    if (record.dynamic.value_or(false) && seen.even()) cycled_Hz = std::fmin(cycled_Hz, seen.typical_Hz);
  }
  std::vector<std::string> cycled;
  for (Check& check : checks) {
    check.clock();
    check.start();
    check.swing();
    check.frequency();
    check.kind_of_load(cycled_Hz, cycled);
    check.air();
  }
  if (cycled.empty()) return;
  constexpr std::size_t kMostNames = 4;
  const std::size_t more = cycled.size() > kMostNames ? cycled.size() - kMostNames : 0;
  const bool one = cycled.size() == 1;
  cycled.resize(cycled.size() - more);
  campaign.notes.push_back(join(cycled, ", ") + (more > 0 ? " and " + std::to_string(more) + " more" : "") + ": campaign.json says \"dynamic\": false; " +
                           (one ? "the record is" : "the records are") + " taken for quasi-static, without the decay of cyclic loading: if that is not meant, say true");
}

}  // namespace forcegate
