#include "hil/diagnose/second_look.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "hil/diagnose/choose/bent_output.h"
#include "hil/diagnose/choose/late_output.h"

namespace forcegate::diagnose {

namespace {

constexpr double kHelps = 0.8;  // of the error that the first answer leaves
constexpr const char* kCurve = "static_nonlinearity";

// Rig and command are compared with the force as it was recorded: what they say stays.
void leave_out_drive(CampaignInput& input) {
  input.has_theta = input.has_command = false;
  for (RecordInput& r : input.records)
    for (std::vector<double>* channel : {&r.theta_rad, &r.sin_theta, &r.cos_theta, &r.late_cos_theta, &r.F_cmd_N}) channel->clear();
}

void keep_of_reference(const Diagnosis& before, Diagnosis& answer) {
  for (const Finding& f : before.findings)
    if (f.of_reference()) answer.findings.push_back(f);
  if (const auto of_rig = before.errors.find("F"); of_rig != before.errors.end()) answer.errors["F"] = of_rig->second;
}

// Among those that are as probable it comes first.
void put_first(Finding finding, Diagnosis& answer) {
  std::erase_if(answer.findings, [&](const Finding& f) { return f.effect == finding.effect; });
  std::ranges::stable_sort(answer.findings, std::greater<>{}, &Finding::probability);
  answer.findings.insert(std::ranges::find_if(answer.findings, [&](const Finding& f) { return f.probability <= finding.probability; }), std::move(finding));
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

// Asked where a curve that bends much is claimed and more is left than the instruments leave, or something that is late stands beside it.
std::optional<Bend> bend_to_ask(const Diagnosed& of) {
  constexpr double kBentMuch = 1.25;
  const Diagnosis& d = of.diagnosis;
  const Finding* curve = claimed_curve(d);
  if (curve == nullptr) return std::nullopt;
  const bool is_late = std::ranges::any_of(d.findings, [](const Finding& f) { return f.claimed() && f.of_output() && is_timing(f.effect); });
  if (!is_late && !(d.error_after > kToItsNoise * d.floor)) return std::nullopt;
  std::optional<Bend> bend = bend_of(of.workspace->input, *curve);
  return bend && bend->slope_ratio > kBentMuch ? bend : std::nullopt;
}

// With the force that is bent as the claimed curve is.
Result<Diagnosed> behind_curve(const EngineOptions& options, const DiagnoseRows& diagnose, const Bend& bend, Diagnosed first) {
  CampaignRows rows = rows_of(*first.workspace);
  bend_force(rows.input, bend);
  for (Edges& edges : rows.edges)
    for (double& F : edges.F_N) F = bend.at(F);
  leave_out_drive(rows.input);
  Result<Diagnosed> out = diagnose(std::move(rows), options);
  const Diagnosis& before = first.diagnosis;
  if (!out || !(out->diagnosis.error_after < kHelps * before.error_after)) return first;
  Diagnosis& answer = out->diagnosis;
  Finding curve = *claimed_curve(before);
  for (Finding& f : answer.findings)
    if (f.effect == "delay" && f.claimed() && f.of_output()) f.form = kBehindCurve;
  if (!answer.steps.empty()) {
    answer.steps.front().effect = curve.effect;
    answer.steps.insert(answer.steps.begin(), {"", before.error_before});
  }
  keep_of_reference(before, answer);
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
  if (const std::optional<Bend> bend = bend_to_ask(out)) {
    FORCEGATE_TRY(out, behind_curve(options, diagnose, *bend, std::move(out)));
  }
  tell_once(out.diagnosis.notes);
  return out;
}

}  // namespace forcegate::diagnose
