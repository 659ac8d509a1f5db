#include "hil/app/next.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "hil/base/plain_number.h"
#include "hil/base/text.h"

namespace forcegate {

std::string next_text(const Diagnosis& d) {
  const NextExperiment& n = d.next_experiment;
  if (n.segments.empty() && !d.not_separable.empty())
    return "not separable here: " + join(d.not_separable.front(), " or ") +
           "; no record of a few minutes on this rig would part them (the diagnosis says what would)\n";
  if (n.segments.empty() && d.verdict == DiagnosisVerdict::unknown)
    return "structure remains that no effect of the library explains, so none competes; it depends on " +
           join(d.depends_on, ", ") +
           "\nLook at its map (--html), or write an equation of your own: [[effect]] in the model file (docs/diagnosis.md)\n";
  if (n.segments.empty())
    return "nothing competes: no further measurement is needed to tell effects apart\n"
           "What these records do not excite they cannot show: slow ramps, a staircase with long holds, long sines of two\n"
           "frequencies and swings, a rest, and one ramp again at the end (docs/campaign.md)\n";
  std::string out = fmt::format("measure next, {:.2g} minutes of rig time:\n", n.minutes);
  for (const ExperimentSegment& s : n.segments) {
    out += fmt::format("  {:<38} {:>4.2g} min  parts {}: odds {} -> {} to 1, likeness {:.2f} -> {:.2f}\n",
                       s.name, s.minutes, s.separates, odds_text(s.odds_before), odds_text(s.odds_after),
                       s.cosine_before, s.cosine_after);
    for (const auto& [name, value] : s.numbers) out += fmt::format("      {} = {:g}\n", name, value);
  }
  return out;
}

std::string next_json(const NextExperiment& n) {
  Diagnosis d;
  d.next_experiment = n;
  nlohmann::ordered_json out = nlohmann::ordered_json::parse(to_json(d))["next_experiment"];
  out["format"] = 1;
  return out.dump(2) + "\n";
}

}  // namespace forcegate
