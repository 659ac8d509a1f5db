#include "hil/diagnose/raw/held_codes.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "hil/base/quantile.h"

namespace forcegate::diagnose {

namespace {

constexpr std::size_t kFewestRuns = 4;
constexpr double kNearlyAll = 0.9;  // of the samples

struct Value {
  std::size_t runs = 0, records = 0;
  double samples = 0.0;
  std::vector<double> step_V;
};
using Values = std::map<double, Value>;  // by what the output stands at

// Lost samples stay at any of a thousand values, two records seldom at the same one.
bool comes_again(const Value& v) { return v.records >= 2 || v.runs >= kFewestRuns; }

// A converter whose lower bits stand still gives the rungs of a ladder, each of them again and again, the top one too. What a link holds are rungs only where the
// converter has few codes, and then neighbours.
HeldCodes rungs_of_ladder(const Values& values, double held, double lsb_V) {
  constexpr std::size_t kFewest = 5, kRunsOfEach = 2;
  constexpr double kApart = 20.0, kOff = 0.05;  // steps of the converter; of a rung
  HeldCodes out;
  std::vector<double> gap_V;
  std::size_t runs = 0;
  for (const auto& [value_V, v] : values) {
    if (!out.value_V.empty()) gap_V.push_back(value_V - out.value_V.back());
    out.value_V.push_back(value_V);
    runs += v.runs;
  }
  if (values.size() < kFewest || runs < kRunsOfEach * values.size()) return out;
  const double rung_V = quantile(gap_V, 0.5);
  const auto even = std::ranges::count_if(gap_V, [&](double gap) { return std::abs(gap / rung_V - std::round(gap / rung_V)) < kOff && gap > (1.0 - kOff) * rung_V; });
  out.found = static_cast<double>(even) >= kNearlyAll * static_cast<double>(gap_V.size()) && rung_V > kApart * lsb_V;
  out.samples = held;
  return out;
}

}  // namespace

HeldCodes find_held_codes(const std::vector<RecordHealth>& health, const HealthScales& scales) {
  constexpr std::size_t kMostValues = 6, kMostCarries = 7;  // carries: of the three upper bits
  constexpr std::ptrdiff_t kSeveral = 3;
  constexpr double kNearby = 0.15, kBeyond = 0.02;  // of the span
  Values values;
  double held = 0.0, top_V = 0.0, lsb_V = 0.0;
  for (const RecordHealth& h : health) {
    top_V = std::max(top_V, h.top_V);
    lsb_V = std::max(lsb_V, h.lsb_U_V);
    std::set<double> here;
    for (const HeldRun& run : h.runs) {
      Value& v = values[run.value_V];
      v.records += here.insert(run.value_V).second ? 1 : 0;
      ++v.runs;
      v.samples += static_cast<double>(run.samples);
      v.step_V.push_back(std::abs(run.value_V - run.before_V));
      held += static_cast<double>(run.samples);
    }
  }
  if (HeldCodes ladder = rungs_of_ladder(values, held, lsb_V); ladder.found) return ladder;
  // a link falls to one value from anywhere, not to several
  const bool several = std::ranges::count_if(values, [](const auto& of) { return of.second.runs >= kFewestRuns; }) >= kSeveral;
  const double nearby = several ? 1.0 : kNearby;
  HeldCodes out;
  for (auto& [value_V, v] : values) {
    const double step_V = quantile(std::move(v.step_V), kNearlyAll);
    if (!comes_again(v) || !(step_V < nearby * scales.U_range_V) || value_V > top_V - kBeyond * scales.U_range_V) continue;
    out.value_V.push_back(value_V);
    out.samples += v.samples;
  }
  out.found = !out.value_V.empty() && out.value_V.size() <= (several ? kMostCarries : kMostValues) && out.samples >= kNearlyAll * held;
  return out;
}

}  // namespace forcegate::diagnose
