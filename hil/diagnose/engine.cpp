#include "hil/diagnose/engine.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "hil/diagnose/base_errors.h"
#include "hil/diagnose/capacitance_witness.h"
#include "hil/diagnose/coloured_noise.h"
#include "hil/diagnose/findings.h"
#include "hil/diagnose/null_calibration.h"
#include "hil/diagnose/pictures.h"
#include "hil/diagnose/ranking.h"
#include "hil/diagnose/record_errors.h"
#include "hil/diagnose/unresolved_edges.h"
#include "hil/diagnose/verdict.h"

namespace forcegate::diagnose {

namespace {

// Structure counts when it is visible beside the noise, large enough to matter, and not one record's whim.
bool is_structure(const Structure& s, double noise_rms) {
  return s.rms > 0.0015 && s.rms > 0.7 * noise_rms && s.share > 0.35 && s.records * 3 >= s.of_records &&
         s.records >= 2;
}

// Records that the model leaves far more of than their instruments may. A change of frequency is not counted: how the decay goes on
// after it differs from law to law.
int far_above_noise(const ResidualChannel& channel, const Workspace& w, const std::vector<std::vector<double>>& residual) {
  constexpr double kFar = 2.5;
  int out = 0;
  double left = 0.0, noise = 0.0;
  for (std::size_t i = 0; i < residual.size(); ++i) {
    if (residual[i].empty() || !w.input.records[channel.record_of[i]].frequency_jumps_s.empty()) continue;
    const RecordGram& record = channel.problem.records[i];
    double square = 0.0;
    for (const double e : residual[i]) square += e * e;
    const double own = square / (static_cast<double>(residual[i].size()) * channel.scale * channel.scale),
                 allowed = record.allowed_variance + record.smoothed_variance;
    left += own;
    noise += allowed;
    out += own > kFar * kFar * allowed ? 1 : 0;
  }
  return left > kFar * kFar * noise ? out : 0;
}

void set_scales(const Workspace& w, const EngineOptions& options, Diagnosis& out) {
  out.campaign = w.input.name;
  out.model = options.model_name;
  out.unit = w.output.unit;
  out.notes = w.input.notes;
  out.force_range_N = w.input.range_N;
  out.voltage_range_V = w.input.U_range_V;
}

// A candidate that left-out records do not bear out may have made others needless: the search begins anew without it.
Selection select_borne_out(Workspace& w, const std::vector<int>& always, std::vector<std::string> skip, const SelectionRules& rules,
                           unsigned threads, std::vector<Finding>& suspicions) {
  const auto select = [&] {
    Selection one = select_effects(w.input, w.output, always, skip, rules, threads);
    measure_left_out(w, w.output, one);
    return one;
  };
  Selection out = select();
  constexpr int kMostTimes = 2;
  for (int time = 0; time < kMostTimes && out.base.valid; ++time) {
    std::vector<Finding> idle = not_borne_out(w.output, out);
    if (idle.empty()) break;
    for (const Finding& f : idle) skip.push_back(f.effect);
    Selection without = select();
    if (!without.base.valid) break;
    without.first = std::move(out.first);  // the ranking is of all
    out = std::move(without);
    std::move(idle.begin(), idle.end(), std::back_inserter(suspicions));
  }
  return out;
}

// A curve that a calibration of the third degree does not follow comes again a few times over the range, as the pitch of a coarse screw would.
void leave_coarse_pitch_to_spring(const ResidualChannel& command, const Selection& rig, Selection& drive) {
  constexpr double kCoarse = 6.0;  // turns over the range of the force
  if (std::ranges::none_of(rig.chosen, [](const ChosenEffect& c) { return c.kind->name == "spring_nonlinearity"; })) return;
  std::erase_if(drive.chosen, [&](const ChosenEffect& c) {
    const Candidate& best = command.candidates[static_cast<std::size_t>(command.variants[static_cast<std::size_t>(c.variant)].candidate)];
    return best.form->name == "pitch" && best.shape[0] < kCoarse;
  });
}

}  // namespace

Diagnosis compare_workspace(Workspace& w, const EngineOptions& options) {
  Diagnosis out;
  set_scales(w, options, out);
  Selection nothing;
  nothing.base = nothing.final = base_model(w, options, out.notes);
  if (!nothing.base.valid) return out;
  const auto residual = residual_rows(w.output, nothing.base);
  out.maps = residual_maps(w, w.output, residual, options.threads);
  add_records(w, nothing.base, nothing.base, out);
  const auto sd = [&](int k) { return std::sqrt(nothing.base.variance[k]); };
  out.repeatability = {sd(0), sd(1) * w.output.scale, sd(2), sd(3)};
  add_pictures(w, nothing, residual, residual, out);
  return out;
}

Diagnosis diagnose_workspace(Workspace& w, const EngineOptions& options) {
  Diagnosis out;
  set_scales(w, options, out);
  SelectionRules rules;
  rules.forms_are_rough = w.input.generic;
  // milliseconds between two instruments are no matter in a recording of seconds
  rules.clock_slack = !w.input.generic || w.input.records.front().row_step_s <= 0.05;

  const std::vector<HealthClaim> raw = health_claims(w.health, w.scales, w.input.bench);
  const auto raw_says = [&](const std::string& name) {
    return std::any_of(raw.begin(), raw.end(), [&](const HealthClaim& c) { return c.effect == name; });
  };

  Selection rig, drive;
  bool reference_moves = false;
  // the rig's own law is only nearly linear and its guide only nearly free: a finding must explain most of the misfit
  SelectionRules rig_rules = rules;
  rig_rules.first_gain = 20.0;
  rig_rules.first_fall = 0.3;
  rig_rules.later_fall = 0.6;
  rig_rules.sure_gain = 1e9;
  rig_rules.first_total_fall = 0.3;
  rig_rules.later_total_fall = 0.6;
  rig_rules.smallest_rms = 4e-4;
  SelectionRules drive_rules = rig_rules;
  drive_rules.first_gain = 60.0;
  drive_rules.form_gain = {{"one_pole", 400.0}};  // a servo loop leaves the like
  drive_rules.first_fall = 0.2;
  drive_rules.where_it_acts = true;
  drive_rules.smallest_rms = 2.5e-4;
  if (w.has_rig) {
    rig = select_effects(w.input, w.rig, model_columns(w.rig, options.in_model), options.in_model, rig_rules,
                         options.threads);
    measure_left_out(w, w.rig, rig);
    for (const ChosenEffect& c : rig.chosen) reference_moves |= c.kind->name == "reference_drift";
  }
  if (w.has_command) {
    drive = select_effects(w.input, w.command, {}, options.in_model, drive_rules, options.threads);
    leave_coarse_pitch_to_spring(w.command, rig, drive);
    measure_left_out(w, w.command, drive);
  }
  std::vector<std::string> skip = options.in_model;
  std::vector<int> always = model_columns(w.output, options.in_model);
  if (w.has_rig && w.rig_sees_zero) skip.push_back("reference_drift");
  if (reference_moves)
    for (int j : bank_columns(w.output, *EffectRegistry::instance().find("reference_drift")))
      always.push_back(j);
  if (raw_says("clipping")) skip.push_back("clipping");
  std::vector<Finding> suspicions;
  const Selection selection = select_borne_out(w, always, skip, rules, options.threads, suspicions);
  if (!selection.base.valid) {
    out.notes.push_back("the records do not determine the starting model: no verdict");
    return out;
  }

  const double explained =
      selection.excess_before > 0.0 ? 1.0 - selection.excess_after / selection.excess_before : 1.0;
  const auto residual_after = residual_rows(w.output, selection.final);
  const auto resolved = without_unresolved_edges(w.input, w.output, residual_after);
  const Structure left = structure_of(w.output, resolved);
  const double noise = allowed_rms(w.output);
  out.maps_after = residual_maps(w, w.output, residual_after, options.threads);
  const bool coloured = is_coloured_noise(w.input, w.output, residual_after, out.maps_after);
  const bool structured = is_structure(left, noise) && !coloured;
  const auto residual_claimed = residual_rows(w.output, selection.claimed);
  const bool remains = (structured && explained < 0.8) ||
                       (!coloured && far_above_noise(w.output, w, without_unresolved_edges(w.input, w.output, residual_claimed)) > 0);
  const bool named_enough = explained > 0.5 || !structured;
  add_findings(w, w.output, selection, named_enough ? std::max(explained, 0.6) : explained, out);
  std::move(suspicions.begin(), suspicions.end(), std::back_inserter(out.findings));
  for (Finding& f : out.findings)
    if (f.effect == "reference_drift" && f.unit == w.output.unit) decide_by_capacitance(w.input, f);
  for (const HealthClaim& claim : raw) {
    const EffectKind* kind = EffectRegistry::instance().find(claim.effect);
    Finding f;
    f.effect = claim.effect;
    f.side = kind != nullptr ? kind->side : "instrument";
    f.probability = claim.probability;
    f.evidence = claim.evidence;
    f.parameters.push_back({claim.parameter, claim.value, claim.u, claim.unit});
    f.form = "raw";
    out.findings.push_back(std::move(f));
  }
  if (w.has_rig && rig.base.valid) {
    const double rig_explained = rig.excess_before > 0.0 ? 1.0 - rig.excess_after / rig.excess_before : 1.0;
    add_findings(w, w.rig, rig, std::max(rig_explained, 0.51), out);
    if (!rig.chosen.empty()) {
      const bool levels = std::any_of(rig.chosen.begin(), rig.chosen.end(), [](const ChosenEffect& c) { return c.between; });
      const auto error = [&](const MixedFit& fit) {
        const auto square = levels ? judge_levels(w.rig, fit, rig.base, w.all_fit) : judge(w.rig, fit, rig.base, w.all_fit).adapted;
        return w.rig.scale * std::sqrt(judged(w.rig, square, w.all_fit));
      };
      out.errors["F"] = {error(rig.base), error(rig.final), "N", levels};
    }
  }

  if (w.has_command && drive.base.valid) add_findings(w, w.command, drive, 0.6, out);
  share_among_timing(selection, out.findings);
  const bool withdrawn = withdraw_what_explains_little(w.output, selection, remains, out.findings);
  // a noisy reference bends and delays everything that is regressed on it: nothing else is claimed beside it
  if (raw_says("reference_noise"))
    for (Finding& f : out.findings)
      if (f.form != "raw") f.probability *= 0.5;

  // one entry per effect, claims first
  // equally sure: what explains more of the error first
  std::map<std::string, double> most;
  for (const Finding& f : out.findings) most[f.unit] = std::max(most[f.unit], f.error_before);
  const auto rank = [&](const Finding& f) {
    const double of = most[f.unit],
                 fall = of > 0.0
                            ? (f.error_before * f.error_before - f.error_after * f.error_after) / (of * of)
                            : 0.0;
    const double sure = f.probability >= 0.8   ? 1.0
                        : f.probability >= 0.5 ? std::floor(10.0 * f.probability) / 10.0
                                               : f.probability;
    return std::pair{sure, f.form == "raw" ? 0.0 : fall};
  };
  std::stable_sort(out.findings.begin(), out.findings.end(),
                   [&](const Finding& a, const Finding& b) { return rank(a) > rank(b); });
  std::vector<Finding> unique;
  for (Finding& f : out.findings)
    if (std::none_of(unique.begin(), unique.end(), [&](const Finding& u) { return u.effect == f.effect; }))
      unique.push_back(std::move(f));
  out.findings = std::move(unique);
  const bool claims = std::any_of(out.findings.begin(), out.findings.end(),
                                  [](const Finding& f) { return f.probability >= 0.5; });
  tell_not_separable(selection, out);
  if (w.has_rig && rig.base.valid) tell_not_separable(rig, out);
  // rivals that hold half of the probability together are no "none": there is something, and its name is open
  double together = 0.0;
  for (const std::vector<std::string>& set : out.not_separable)
    for (const Finding& f : out.findings)
      if (std::find(set.begin(), set.end(), f.effect) != set.end()) together += f.probability;
  const bool open = structured || withdrawn || together >= 0.8 || (!coloured && far_above_noise(w.output, w, resolved) >= 2);
  out.verdict = claims ? DiagnosisVerdict::known : open ? DiagnosisVerdict::unknown : DiagnosisVerdict::none;
  out.residual_unknown = claims && remains;

  const auto residual = residual_rows(w.output, selection.base);
  out.maps = residual_maps(w, w.output, residual, options.threads);
  // where all claims were withdrawn, what they soak up is unknown too
  if (out.verdict == DiagnosisVerdict::unknown || out.residual_unknown)
    out.depends_on = depends_on(withdrawn && !claims ? out.maps : out.maps_after);
  // what the user gets who takes the findings in, not what all forms of their families soak up beside them
  add_records(w, selection.base, selection.claimed, out);
  add_steps(w, selection, out);
  for (Finding& f : out.findings)
    if (f.form == "raw") {
      f.error_before = out.error_before;
      f.error_after = out.error_after;
    }
  add_ranking(w.input, w.output, selection, rules, out);
  if (coloured && is_structure(left, noise)) {
    char text[160];
    std::snprintf(text, sizeof text, "the noise of the output hangs together over time (%.2g %% of the span, RMS), of one size in every record whatever the load does",
                  100.0 * left.rms);
    out.notes.emplace_back(text);
  }
  constexpr int kFlips = 6;
  const NullCalibration null = calibrate_null(
      w.input, w.output, selection.final, skip, [&](const std::string& name) { return threshold_of(name, rules); },
      kFlips, options.threads);
  out.expected_false = null.expected_false;
  for (RankedEffect& r : out.ranking)
    if (const auto found = null.score.find(r.effect); found != null.score.end()) r.null_score = found->second;
  if (w.has_rig && rig.base.valid) add_ranking(w.input, w.rig, rig, rules, out);
  if (w.has_command && drive.base.valid) add_ranking(w.input, w.command, drive, rules, out);
  if (!w.input.single) tell_visible_from(out);
  const auto sd = [&](int k) { return std::sqrt(selection.final.variance[k]); };
  out.repeatability = {sd(0), sd(1) * w.output.scale, sd(2), sd(3)};
  // a family may come up, and be turned down, once for every model that it is tried beside
  for (const std::string& what : selection.nuisance)
    if (std::find(out.notes.begin(), out.notes.end(), what) == out.notes.end()) out.notes.push_back(what);
  for (const Selection* tried : std::initializer_list<const Selection*>{&selection, &rig, &drive})
    for (const RefusedEffect& r : tried->refused)
      if (std::none_of(out.refused.begin(), out.refused.end(),
                       [&](const RefusedEffect& o) { return o.effect == r.effect && o.reason == r.reason; }))
        out.refused.push_back(r);
  suspect_refused(out);
  if (options.pictures) add_pictures(w, selection, residual, residual_claimed, out);
  return out;
}

}  // namespace forcegate::diagnose
