#include "hil/app/diagnose/next.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "hil/app/diagnose/what_next.h"
#include "hil/base/plain_number.h"
#include "hil/base/text.h"
#include "hil/diagnose/next/segments.h"

namespace forcegate {

namespace {

std::string what_parts(const std::string& effect) {
  const EffectKind* kind = EffectRegistry::instance().find(effect);
  return kind == nullptr ? "" : kind->separates;
}

// The effect with the most evidence that was turned down all the same.
const RefusedEffect* strongest_refused(const Diagnosis& d) {
  constexpr double kMuch = 20.0;  // nats
  for (const RankedEffect& r : d.ranking) {
    if (r.score < kMuch) break;
    for (const RefusedEffect& refused : d.refused)
      if (refused.effect == r.effect) return &refused;
  }
  return nullptr;
}

std::string which_plan(const Diagnosis& d) {
  const std::string plan = plan_that_settles(d);
  return plan.empty()
             ? "no plan that comes with the program plays that: record it by hand, or with a plan of your own (docs/plan.md), and put the recordings into the campaign\n"
             : "the plan " + plan + " plays some of it\n";
}

// Segments of an earlier `next --run` that left open what is open.
std::string told_played(const Diagnosis& d) {
  std::vector<std::string> played;
  for (const diagnose::Segment& s : diagnose::segments())
    for (const RecordError& r : d.records)
      if (diagnose::is_record_of(r.record, s)) played.push_back(s.name + " (" + r.record + ")");
  return played.empty() ? "" : "played already, and what is open is open all the same, so not asked for again: " + join(played, ", ") + "\n";
}

std::string without_segments(const Diagnosis& d) {
  if (!d.not_separable.empty()) {
    const std::vector<std::string>& rivals = d.not_separable.front();
    const bool own = std::ranges::any_of(rivals, [](const std::string& effect) { return EffectRegistry::instance().find(effect) == nullptr; });
    std::string out = "not separable here: " + join(rivals, " or ") + "; none of the short segments that a rig can play would part them\n" +
                      told_played(d) + (own ? "what shows the library's effects as a rule:\n" : "what would:\n");
    for (const std::string& effect : rivals)
      if (const std::string how = what_parts(effect); !how.empty()) out += "  " + effect + ": " + how + "\n";
    if (own) out += "an equation of your own that answers alike wherever the force can be played predicts the same: take the one that you can explain\n";
    return out + which_plan(d);
  }
  if (const std::vector<const Finding*> suspicions = suspicions_beside_none(d); !suspicions.empty()) {
    std::string out = "nothing is claimed; " + beside_none(d) + "\nwhat would settle it:\n";
    for (const Finding* f : suspicions)
      out += "  " + f->effect + ": " + what_parts(f->effect) +
             (f->reservations.empty() ? "" : " (not claimed: " + f->reservations.back().why + ")") + "\n";
    return out + which_plan(d);
  }
  // open all the same, and no segment is of use
  if (!d.next_experiment.sentence.empty()) return d.next_experiment.sentence + "\n" + told_played(d) + which_plan(d);
  if (const Finding* open = open_name(d); open != nullptr)
    return "something is missing; " + open->effect + " would explain it and is not claimed" +
           (open->reservations.empty() ? "" : ": " + open->reservations.back().why) + "\nwhat would settle it:\n  " + open->effect + ": " + what_parts(open->effect) + "\n" + which_plan(d);
  if (d.verdict == DiagnosisVerdict::unknown)
    return "structure remains that no effect of the library explains, so none competes" +
           (d.depends_on.empty() ? "" : "; it depends on " + join(d.depends_on, ", ")) +
           "\nLook at its map (--html), or write an equation of your own: [[effect]] in the model file (docs/diagnosis.md)\n";
  if (const Finding* first = worth_adding(d); first != nullptr)
    return "nothing competes with " + first->effect + ": no further measurement is needed to tell it from others\n";
  if (const RefusedEffect* refused = strongest_refused(d))
    return "no two effects compete, but " + refused->effect + " has evidence and was not taken: " +
           std::string(diagnose::traits_of(refused->reason).sentence) + "\nto settle it, record more of what shows it: " + what_parts(refused->effect) + "\n";
  return "nothing competes: no further measurement is needed to tell effects apart\n"
         "What these records do not excite they cannot show: slow ramps, a staircase with long holds, long sines of two\n"
         "frequencies and swings, a rest, and one ramp again at the end (docs/campaign.md)\n";
}

}  // namespace

std::string next_text(const Diagnosis& d, const std::filesystem::path& folder) {
  const NextExperiment& n = d.next_experiment;
  if (n.segments.empty()) return without_segments(d);
  bool files = false;
  std::string out = fmt::format("measure next, {:.2g} minutes of rig time:\n", n.minutes);
  for (const ExperimentSegment& s : n.segments) {
    out += fmt::format("  {:<38} {:>4.2g} min  parts {}: odds {} -> {} to 1{}, likeness {:.2f} -> {:.2f}\n",
                       s.name, s.minutes, s.separates, odds_text(s.odds_before), odds_text(s.odds_after),
                       s.odds_stated ? "" : " by the evidence", s.cosine_before, s.cosine_after);
    std::string parameters = parameters_text(s, static_cast<std::size_t>(&s - n.segments.data()) + 1);
    // the file lies nowhere before it is written
    if (const std::string path = "path=profiles/"; parameters.starts_with(path)) parameters.replace(0, path.size(), "path=" + (folder.empty() ? std::string("FOLDER") : file_quoted(folder.string())) + "/profiles/");
    out += "      forcegate stimulus " + s.stimulus + " " + parameters;
    if (s.stimulus == "replay") out += fmt::format("  ({:.3g} to {:.3g} N)", s.low_N(), s.high_N()), files = true;
    if (s.heats) out += fmt::format("  while it warms up by {:g} degC", s.rise_degC);
    out += "\n";
  }
  out += told_played(d);
  if (files) out += "no profile of the list is the force of a replay: -o FOLDER writes its file, FOLDER/profiles/...\n";
  out += "odds behind the arrow: what to expect if the first one of the two is there\n";
  if (n.segments.size() > 1) out += "the first odds are those of the diagnosis; a later segment starts from what those above it leave\n";
  return out;
}

std::string next_json(const Diagnosis& d) {
  nlohmann::ordered_json out = nlohmann::ordered_json::parse(to_json(d))["next_experiment"];
  if (d.next_experiment.segments.empty()) {
    std::string sentence = without_segments(d);
    while (sentence.ends_with('\n')) sentence.pop_back();
    out["sentence"] = sentence;
  }
  out["format"] = 1;
  return out.dump(2) + "\n";
}

}  // namespace forcegate
