#include "hil/diagnose/raw/held_codes.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "hil/base/quantile.h"

namespace forcegate::diagnose {

HeldCodes find_held_codes(const std::vector<RecordHealth>& health, const HealthScales& scales) {
  constexpr std::size_t kMostValues = 6, kMostCarries = 7, kFewestRuns = 4;  // carries: of the three upper bits
  constexpr std::ptrdiff_t kSeveral = 3;
  constexpr double kNearlyAll = 0.9, kNearby = 0.15, kBeyond = 0.02;  // of the samples; of the span
  struct Value {
    std::size_t runs = 0, records = 0;
    double samples = 0.0;
    std::vector<double> step_V;
  };
  std::map<double, Value> values;
  double held = 0.0, top_V = 0.0;
  for (const RecordHealth& h : health) {
    top_V = std::max(top_V, h.top_V);
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
  // lost samples stay at any of a thousand values, two records seldom at the same one; a link falls to one value from anywhere, not to several
  const auto comes_again = [](const Value& v) { return v.records >= 2 || v.runs >= kFewestRuns; };
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
