#include "hil/diagnose/choose/search.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <functional>
#include <iterator>

#include "hil/diagnose/base/whole_recording.h"
#include "hil/diagnose/between/unloaded_zero.h"
#include "hil/diagnose/candidates/model_effects.h"
#include "hil/diagnose/choose/at_the_edges.h"
#include "hil/diagnose/choose/borne_out.h"
#include "hil/diagnose/choose/probability.h"
#include "hil/diagnose/choose/reference_latency.h"
#include "hil/diagnose/choose/shares.h"
#include "hil/diagnose/choose/where_they_differ.h"

namespace forcegate::diagnose {

namespace {

SelectionRules output_rules(const Workspace& w, const EngineOptions& options) {
  SelectionRules out;
  if (is_as_shipped(options)) out.expected = lacking_partner(options);
  out.forms_are_rough = w.input.generic;
  out.one_zero = w.input.single && !w.zero_wanders;
  for (const RecordInput& r : w.input.records) out.row_step_s = std::max(out.row_step_s, r.row_step_s);
  out.clock_slack = !w.input.generic || w.input.records.front().row_step_s <= kStepsTellNoLag_s;
  return out;
}

// The rig's own law is only nearly linear and its guide only nearly free: a finding must explain most of the misfit.
SelectionRules rules_of_rig(SelectionRules rules) {
  rules.first_gain = 20.0;
  rules.first_fall = 0.3;
  rules.later_fall = 0.6;
  rules.sure_gain = 1e9;
  rules.first_total_fall = 0.3;
  rules.later_total_fall = 0.6;
  rules.typical_record = true;
  rules.smallest_rms = 4e-4;
  return rules;
}

SelectionRules rules_of_drive(SelectionRules rules) {
  rules.first_gain = 60.0;
  rules.form_gain = {{"one_pole", 400.0}};  // a servo loop leaves the like
  rules.first_fall = 0.2;
  rules.where_it_acts = true;
  rules.smallest_rms = 2.5e-4;
  return rules;
}

// Anew, from the output as it was before the first search set a late reference aside; the ranking stays that of all. False, and all as it was,
// where the new selection does not serve.
bool select_anew(Workspace& w, Selection& out, const std::function<Selection()>& select, const std::function<bool(const Selection&)>& serves) {
  if (out.set_aside.size() > 0) take_off_output(w.output, -out.set_aside);
  Selection anew = select();
  if (!serves(anew)) {
    if (out.set_aside.size() > 0) take_off_output(w.output, out.set_aside);
    return false;
  }
  anew.first = std::move(out.first);
  out = std::move(anew);
  return true;
}

// A candidate that left-out records do not bear out may have made others needless: the search begins anew without it.
Selection select_borne_out(Workspace& w, const Given& given, std::vector<std::string> skip, const SelectionRules& rules,
                           unsigned threads, std::vector<Finding>& suspicions) {
  const auto select = [&](bool again) {
    Selection one = select_effects(w.input, w.output, given, skip, rules, threads);
    measure_left_out(w, w.output, one, again);
    return one;
  };
  Selection out = select(false);
  constexpr int kMostTimes = 2;
  std::vector<ChosenEffect> gave_way;
  for (int time = 0; time < kMostTimes && out.base.valid; ++time) {
    std::vector<Finding> idle = not_borne_out(w.output, out);
    if (idle.empty()) break;
    for (const Finding& f : idle) skip.push_back(f.effect);
    const std::vector<ChosenEffect> before = out.chosen;
    if (!select_anew(w, out, [&] { return select(true); }, [](const Selection& s) { return s.base.valid; })) break;
    std::ranges::copy_if(before, std::back_inserter(gave_way), [](const ChosenEffect& c) { return !c.borne_out; });
    std::move(idle.begin(), idle.end(), std::back_inserter(suspicions));
  }
  share_with_idle(gave_way, out);
  return out;
}

// A curve that a calibration of the third degree does not follow comes again a few times over the range, as the pitch of a coarse screw would.
void leave_coarse_pitch_to_spring(const ResidualChannel& command, const Selection& rig, Selection& drive) {
  constexpr double kCoarse = 6.0;  // turns over the range of the force
  if (std::ranges::none_of(rig.chosen, [](const ChosenEffect& c) { return c.kind->name == "spring_nonlinearity"; })) return;
  leave_out(command, [&](const ChosenEffect& c) {
    const Candidate& best = candidate_of(command, c.variant);
    return best.form->name == "pitch" && best.shape[0] < kCoarse;
  }, drive);
}

// Of a drift that the rig has shown.
std::vector<int> drift_columns(const ResidualChannel& channel) {
  const EffectKind& kind = *EffectRegistry::instance().find("reference_drift");
  std::vector<int> out = bank_columns(channel, kind);
  for (const Candidate& c : channel.candidates)
    if (c.kind == &kind && c.form->after_rig != RigShows::nothing) out.push_back(c.first);
  return out;
}

// The search once more without some families. False, and all as it was, where the new one does not serve.
bool search_without(Workspace& w, const Given& given, const std::vector<std::string>& families, unsigned threads, Search& out,
                    const std::function<bool(const Selection&)>& serves) {
  std::vector<std::string> skip = out.skip;
  skip.insert(skip.end(), families.begin(), families.end());
  std::vector<Finding> suspicions;
  const auto select = [&] { return select_borne_out(w, given, skip, out.rules, threads, suspicions); };
  if (!select_anew(w, out.output, select, serves)) return false;
  std::ranges::move(suspicions, std::back_inserter(out.suspicions));
  return true;
}

std::string verb_for(const std::vector<std::string>& names) { return names.size() == 1 ? "s" : ""; }

// `elsewhere`: where the families that fit as well lose to one that competes with them.
void leave_out_beaten(Workspace& w, const Given& given, const std::vector<std::string>& beaten, const char* elsewhere, unsigned threads, Search& out) {
  if (beaten.empty() || !search_without(w, given, beaten, threads, out, [](const Selection& s) { return s.base.valid && !s.chosen.empty(); })) return;
  out.begun_anew.push_back(fmt::format("{} fit{} {}", fmt::join(beaten, ", "), verb_for(beaten), elsewhere));
}

void leave_to_zero_of_reference(Workspace& w, const Given& given, unsigned threads, Search& out) {
  constexpr int kMostTimes = 3;
  for (int time = 0; time < kMostTimes; ++time) {
    const std::vector<std::string> names = contradicted_without_load(w, out.output);
    if (names.empty()) return;
    if (!search_without(w, given, names, threads, out, [](const Selection& s) { return s.base.valid; })) return;
    out.skip.insert(out.skip.end(), names.begin(), names.end());
    out.begun_anew.push_back(fmt::format("{} fit{} the zeros of the records, and not that the output is the same wherever there is no load, whatever the reference shows there",
                                         fmt::join(names, ", "), verb_for(names)));
  }
}

}  // namespace

Search search_channels(Workspace& w, const EngineOptions& options) {
  Search out;
  out.rules = output_rules(w, options);
  out.rig_rules = rules_of_rig(out.rules);
  out.drive_rules = rules_of_drive(out.rig_rules);
  if (w.has_rig) {
    out.rig = select_effects(w.input, w.rig, {}, options.in_model, out.rig_rules, options.threads);
    measure_left_out(w, w.rig, out.rig);
  }
  if (w.has_command) {
    out.drive = select_effects(w.input, w.command, {}, options.in_model, out.drive_rules, options.threads);
    leave_coarse_pitch_to_spring(w.command, out.rig, out.drive);
    measure_left_out(w, w.command, out.drive);
  }
  out.skip = options.in_model;
  Given given{model_columns(w.output, options), model_families(w.output, options)};
  // of a zero that jumps at will, or of a course that few records bear, the output is asked whether it shows the same
  const auto is_plain_drift = [&](const ChosenEffect& c) {
    return c.kind->name == "reference_drift" && c.borne_out && probability_that_real(w.input, w.rig, c) >= kClaim;
  };
  if (std::ranges::any_of(out.rig.chosen, is_plain_drift)) {
    add_columns(given.base, drift_columns(w.output));
    out.skip.emplace_back("reference_drift");
  }
  if (std::ranges::any_of(w.raw_claims, [](const HealthClaim& c) { return c.effect == "clipping"; })) out.skip.emplace_back("clipping");
  out.output = select_borne_out(w, given, out.skip, out.rules, options.threads, out.suspicions);
  leave_out_beaten(w, given, beaten_at_the_edges(w, out.output, out.rules, options.threads), "the rows as well, and not the samples where the force turns most sharply",
                   options.threads, out);
  leave_out_beaten(w, given, beaten_where_they_differ(w, out.output, out.rules, options.threads), "most rows as well, and not those where what they foretell differs",
                   options.threads, out);
  leave_to_zero_of_reference(w, given, options.threads, out);
  // against the law without the model's own effects: they describe the whole too
  const bool has_effects = !given.base.empty();
  const MixedFit law = has_effects ? fit_mixed(w.output.problem, {}, &out.output.base) : out.output.base;
  if ((has_effects || !out.output.chosen.empty()) && whole_must_judge(w, law, out.output.claimed)) {
    w.judges = JudgedBy::whole;
    measure_left_out(w, w.output, out.output);
  }
  return out;
}

}  // namespace forcegate::diagnose
