#include "hil/diagnose/second_look.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <optional>
#include <utility>

#include "hil/base/plain_number.h"
#include "hil/diagnose/candidates/model_effects.h"
#include "hil/diagnose/choose/bent_output.h"
#include "hil/diagnose/choose/lag_and_curve.h"
#include "hil/diagnose/choose/late_output.h"

namespace forcegate::diagnose {

namespace {

constexpr double kHelps = 0.8;  // of the error that the first answer leaves
constexpr double kAlone = 0.9;  // of the error of the law alone, for a curve that nothing else claims

// Rig and command are compared with the force as it was recorded: what they say stays.
void leave_out_drive(CampaignInput& input) {
  input.has_theta = input.has_spindle = input.has_command = false;
  for (RecordInput& r : input.records)
    for (std::vector<double>* channel : {&r.theta_rad, &r.sin_theta, &r.cos_theta, &r.late_cos_theta, &r.F_cmd_N}) channel->clear();
}

void keep_of_reference(const Diagnosis& before, Diagnosis& answer) {
  for (const Finding& f : before.findings)
    if (f.of_reference()) answer.findings.push_back(f);
  if (const auto of_rig = before.errors.find("F"); of_rig != before.errors.end()) answer.errors["F"] = of_rig->second;
}

// In place of what the answer says of the effect; among those that are as probable it comes first.
void put_in_place(Finding finding, Diagnosis& answer) {
  std::erase_if(answer.findings, [&](const Finding& f) { return f.effect == finding.effect; });
  std::ranges::stable_sort(answer.findings, std::greater<>{}, &Finding::probability);
  answer.findings.insert(std::ranges::find_if(answer.findings, [&](const Finding& f) { return f.probability <= finding.probability; }), std::move(finding));
}

void put_first(Finding finding, Diagnosis& answer) {
  put_in_place(std::move(finding), answer);
  if (answer.verdict == DiagnosisVerdict::unknown) answer.residual_unknown = true;
  answer.verdict = DiagnosisVerdict::known;
}

CampaignRows rows_of(const Workspace& w) { return {w.input, w.health, w.edges, w.raw_claims, w.scales, w.output.unit, w.judges}; }

// A second look at the same samples says again what it says of them.
void tell_once(std::vector<std::string>& notes) {
  std::vector<std::string> once;
  for (std::string& note : notes)
    if (std::ranges::find(once, note) == once.end()) once.push_back(std::move(note));
  notes = std::move(once);
}

// The model's lag, and what is called for by it, with the output so much later than the force.
Result<Diagnosed> behind_late_output(CampaignRows rows, const EngineOptions& options, const DiagnoseRows& diagnose, const LateOutput& late, Diagnosed first) {
  constexpr double kSure = 0.9;
  const EffectKind* kind = EffectRegistry::instance().find("delay");
  delay_force(rows.input, late.delay_s);
  rows.edges.clear();
  leave_out_drive(rows.input);
  Result<Diagnosed> out = diagnose(std::move(rows), options);
  const Diagnosis& before = first.diagnosis;
  if (!out || kind == nullptr || !(out->diagnosis.error_after < kHelps * before.error_after)) return first;
  Diagnosis& answer = out->diagnosis;
  Finding delay = finding_about(*kind, out->workspace->output);
  delay.form = kBehindLag;
  delay.probability = kSure;
  delay.parameters.push_back({"delay_s", late.delay_s, late.u_s, "s"});
  delay.error_before = before.error_after;
  delay.error_after = answer.error_after;
  delay.evidence = fmt::format("{}; moved together with the model's lag ({:.2g} s beside it) and the bend of the sensor it leaves {:.2g} of what the best lag without a delay "
                               "leaves (mean square), and no lag of another kind comes near",
                               kind->summary, late.tau_s, late.share_left);
  keep_of_reference(before, answer);
  put_first(std::move(delay), answer);
  answer.notes.push_back(fmt::format("the output is {:.3g} s late: errors and pictures of the others are with the force as much later", late.delay_s));
  return out;
}

const Finding* claimed_curve(const Diagnosis& d) {
  const auto at = std::ranges::find_if(d.findings, [](const Finding& f) { return f.effect == kCurve && f.claimed() && f.of_output(); });
  return at == d.findings.end() ? nullptr : &*at;
}

/// The force as the curve has it, behind the model's lag where the curve is one of the lagged force.
struct AskedBend {
  Bend bend;
  double lag_s = 0.0;
  bool is_whole = false;  ///< of any law, steps of a touch among it
};

// A curve that the model leaves to its owner: beside its lag it is asked for, whether the library's forms are near it or not.
bool lacks_curve(const EngineOptions& options) { return lacking_partner(options) == kCurve; }

// Asked where a curve that bends is claimed or lacking and more is left than the instruments leave, or something that is late stands beside it.
std::optional<AskedBend> bend_to_ask(const Diagnosed& of, const EngineOptions& options) {
  constexpr double kBends = 0.01;  // of the range, from straight
  const Diagnosis& d = of.diagnosis;
  const Finding* curve = claimed_curve(d);
  if (curve == nullptr && !lacks_curve(options)) return std::nullopt;
  const bool is_late = std::ranges::any_of(d.findings, [](const Finding& f) { return f.claimed() && f.of_output() && is_timing(f.effect); });
  if (!is_late && !(d.error_after > kToItsNoise * d.floor)) return std::nullopt;
  if (std::optional<LaggedBend> lagged = bend_beside_lag(*of.workspace, options.threads); lagged && lagged->bend.departure > kBends)
    return AskedBend{std::move(lagged->bend), lagged->after_lag ? lagged->tau_s : 0.0, true};
  std::optional<Bend> bend = curve != nullptr ? bend_of(of.workspace->input, *curve) : std::nullopt;
  if (!bend || !(bend->departure > kBends)) return std::nullopt;
  return AskedBend{*std::move(bend)};
}

// The force has the model's lag already.
EngineOptions without_lag(EngineOptions options) {
  constexpr double kNone_s = 1e-4, kSure_s = 1e-5;  // estimated: no guess that would move
  for (ModelEffect& effect : options.model_effects)
    if (effect.effect == kLag)
      for (ModelParameter& p : effect.shape)
        if (p.unit == "s") p.value = kNone_s, p.se = kSure_s;
  return options;
}

// The model's lag, where the bent force has it: what the first look says of it stays.
void keep_of_lag(const Diagnosis& before, Diagnosis& answer) {
  const auto lag = std::ranges::find_if(before.findings, [](const Finding& f) { return f.effect == kLag && f.in_model; });
  if (lag != before.findings.end()) put_in_place(*lag, answer);
  const auto of_guess = [](const std::string& note) { return note.starts_with("the model's lag"); };
  std::ranges::copy_if(before.notes, std::back_inserter(answer.notes), of_guess);
}

const Finding* claimed_zero(const Diagnosis& d) {
  const auto at = std::ranges::find_if(d.findings, [](const Finding& f) { return f.effect == "reference_drift" && f.of_output() && f.claimed(); });
  return at == d.findings.end() ? nullptr : &*at;
}

// A zero of the reference that moves is no such thing of the bent one.
void keep_of_zero(const Diagnosis& before, Diagnosis& answer) {
  if (const Finding* drift = claimed_zero(before); drift != nullptr && claimed_zero(answer) == nullptr) put_in_place(*drift, answer);
}

// A curve that is steepest at the touch, at forces whose zero moves.
void leave_start_open(Diagnosis& answer) {
  if (claimed_zero(answer) == nullptr) return;
  for (Finding& f : answer.findings)
    if (f.effect == "dead_zone") f.limit(kNoClaim, "the zero of the reference moves, and where the output begins moves with it");
}

// Of which the library's forms describe too little for a claim.
Finding whole_curve(const Diagnosis& before, const Diagnosis& answer, const Workspace& w) {
  constexpr double kSure = 0.9;
  const EffectKind& kind = *EffectRegistry::instance().find(kCurve);
  Finding out = finding_about(kind, w.output);
  out.form = kWholeCurve;
  out.probability = kSure;
  out.error_before = before.error_before;
  out.error_after = answer.error_before;
  const PrintedUnit unit = printed_unit(out.unit);
  out.evidence = fmt::format("{}; one curve of any law beside the model's lag takes the error of records left out from {:.3g} to {:.3g} {}", kind.summary,
                             unit.factor * out.error_before, unit.factor * out.error_after, unit.name);
  return out;
}

// With the force that is bent as the curve is.
Result<Diagnosed> behind_curve(const EngineOptions& options, const DiagnoseRows& diagnose, const AskedBend& asked, Diagnosed first) {
  CampaignRows rows = rows_of(*first.workspace);
  bend_force(rows.input, asked.bend, asked.lag_s);
  if (asked.lag_s > 0.0) rows.edges.clear();
  for (Edges& edges : rows.edges)
    for (double& F : edges.F_N) F = asked.bend.at(F);
  leave_out_drive(rows.input);
  Result<Diagnosed> out = diagnose(std::move(rows), asked.lag_s > 0.0 ? without_lag(options) : options);
  const Diagnosis& before = first.diagnosis;
  if (!out || !(out->diagnosis.error_after < kHelps * before.error_after)) return first;
  Diagnosis& answer = out->diagnosis;
  const Finding* claimed = claimed_curve(before);
  if (claimed == nullptr && !(answer.error_before < kAlone * before.error_before)) return first;
  Finding curve = claimed != nullptr ? *claimed : whole_curve(before, answer, *out->workspace);
  for (Finding& f : answer.findings)
    if (f.effect == "delay" && f.claimed() && f.of_output()) f.form = kBehindCurve;
  if (!answer.steps.empty()) {
    answer.steps.front().effect = curve.effect;
    answer.steps.insert(answer.steps.begin(), {"", before.error_before});
  }
  if (asked.lag_s > 0.0) keep_of_lag(before, answer);
  keep_of_reference(before, answer);
  keep_of_zero(before, answer);
  if (asked.is_whole) leave_start_open(answer);
  put_first(std::move(curve), answer);
  answer.error_before = before.error_before;
  answer.plain_before = before.plain_before;
  answer.maps = before.maps;
  for (RecordError& r : answer.records)
    if (const auto first_seen = std::ranges::find(before.records, r.record, &RecordError::record); first_seen != before.records.end())
      r.before = first_seen->before, r.plain_before = first_seen->plain_before;
  answer.notes.emplace_back("what acts behind the bent curve is judged by the force that a straight sensor would have felt: errors and pictures of the others begin with the whole curve in the model");
  return out;
}

}  // namespace

Result<Diagnosed> look_again(CampaignRows rows, const EngineOptions& options, const DiagnoseRows& diagnose) {
  std::optional<CampaignRows> kept;
  if (!options.model_effects.empty()) kept = rows;
  FORCEGATE_TRY(Diagnosed out, diagnose(std::move(rows), options));
  if (kept) {
    const LateOutput late = late_output(*out.workspace, options.threads);
    if (late) return behind_late_output(*std::move(kept), options, diagnose, late, std::move(out));
  }
  if (const std::optional<AskedBend> asked = bend_to_ask(out, options)) {
    FORCEGATE_TRY(out, behind_curve(options, diagnose, *asked, std::move(out)));
  }
  tell_once(out.diagnosis.notes);
  return out;
}

}  // namespace forcegate::diagnose
