#include <algorithm>
#include <optional>
#include <utility>

#include "hil/diagnose/answer/opened_contact.h"
#include "hil/diagnose/answer/remainder.h"
#include "hil/diagnose/answer/steady_line.h"
#include "hil/diagnose/base/open_contact.h"
#include "hil/diagnose/base/whole_recording.h"
#include "hil/diagnose/base_errors.h"
#include "hil/diagnose/candidates/model_effects.h"
#include "hil/diagnose/candidates/unnamed_dependences.h"
#include "hil/diagnose/engine.h"
#include "hil/diagnose/one_zero.h"
#include "hil/diagnose/partly_told.h"
#include "hil/diagnose/second_look.h"

namespace forcegate::diagnose {

namespace {

Result<Diagnosed> diagnose_rows(CampaignRows rows, const EngineOptions& options) {
  Diagnosed out;
  FORCEGATE_TRY(out.workspace, prepare(std::move(rows), options));
  FORCEGATE_TRY(out.diagnosis, diagnose_workspace(*out.workspace, options));
  return out;
}

// Nothing is unknown in what the law with one zero describes to its noise, though a part may tell little of the others, such as the decay of
// the first cycles.
bool law_describes(const Workspace& with_one_zero, const EngineOptions& options) {
  if (steady_line(with_one_zero)) return false;  // no noise, whatever stands between two rows
  std::vector<std::string> notes;
  const MixedFit base = base_model(with_one_zero, options, notes);
  return is_down_to_noise(with_one_zero.output, base) && follows_force(with_one_zero.output, base);
}

constexpr const char* kPartsDiffer =
    "parts of the recording differ in gain or zero by more than its noise, within 1 % of the span, as zeros wander: a rest without load before "
    "and after tells whether the reference or the output moves";

// The answer with one zero knows no zeros that move.
void list_moving_zero(const Diagnosis& of_wandering, Diagnosis& out) {
  const auto is_drift = [](const Finding& f) { return f.effect == "reference_drift"; };
  const auto moving = std::ranges::find_if(of_wandering.findings, is_drift);
  if (moving == of_wandering.findings.end() || std::ranges::any_of(out.findings, is_drift)) return;
  out.findings.insert(std::ranges::find_if(out.findings, [&](const Finding& f) { return f.probability < moving->probability; }), *moving);
}

// Where zeros of its parts leave nothing to be found and the whole far above its floor, and above what a zero wanders by, that is no "none".
Result<Diagnosed> diagnose_parts(CampaignRows rows, const EngineOptions& options) {
  constexpr double kFarAbove = 5.0;
  constexpr double kLargestWander = 0.01;  // of the span
  constexpr double kTheSame = 0.7;         // of the error with one gain and zero: where own ones leave that much, parts do not differ
  FORCEGATE_TRY(Diagnosed stands, diagnose_rows(rows, with_one_zero(options)));
  FORCEGATE_TRY(Diagnosed wanders, diagnose_rows(std::move(rows), options));
  Diagnosis& answer = wanders.diagnosis;
  const Diagnosis& other = stands.diagnosis;
  const bool zero_drifts = std::ranges::find(other.follows, kZeroWithTime) != other.follows.end();
  if (!zero_drifts && one_zero_is_enough(other.plain_after, answer.plain_after, other.floor)) return stands;
  if (answer.verdict != DiagnosisVerdict::known && law_describes(*stands.workspace, options)) {
    answer.verdict = DiagnosisVerdict::none;
    answer.depends_on.clear();
    answer.follows.clear();
    return wanders;
  }
  const double plain = std::max(kFarAbove * answer.floor, kLargestWander * wanders.workspace->output.scale);
  if (answer.verdict != DiagnosisVerdict::none) return wanders;
  // what was chosen and is not claimed explains nothing yet
  if (answer.plain_before < plain) {
    if (answer.plain_before > kFarAbove * answer.floor) answer.notes.push_back(kPartsDiffer);
    return wanders;
  }
  if (other.verdict == DiagnosisVerdict::unknown) {
    list_moving_zero(answer, stands.diagnosis);
    return stands;
  }
  answer.verdict = DiagnosisVerdict::unknown;
  answer.depends_on = depends_on(answer.maps);
  if (answer.error_after > kTheSame * answer.plain_before) return wanders;
  answer.depends_on = {"time"};
  answer.notes.push_back("parts of the recording differ in gain or zero by far more than its noise: something changes with time");
  return wanders;
}

Result<Diagnosed> diagnose_as_recorded(CampaignRows rows, const EngineOptions& options) {
  return rows.input.single ? diagnose_parts(std::move(rows), options) : diagnose_rows(std::move(rows), options);
}

Result<Diagnosed> diagnose_all(CampaignRows rows, const EngineOptions& options) { return look_again(std::move(rows), options, diagnose_as_recorded); }

// An angle or a command shows itself whether the wheel goes on where the force rests.
bool has_witness_of_drive(const CampaignInput& input) { return input.has_theta || input.has_spindle || input.has_command; }

Result<Diagnosed> diagnose_records(Campaign campaign, const EngineOptions& options) {
  FORCEGATE_TRY(CampaignRows rows, take_rows(std::move(campaign), options));
  // a curve that the model lacks is steepest at no load: what rows of a closed contact leave of it tells nothing of the contact
  const OpenContact open = has_witness_of_drive(rows.input) || !lacking_partner(options).empty() ? OpenContact{} : open_contact(rows.input);
  if (!open) return diagnose_all(std::move(rows), options);
  CampaignRows closed = rows;
  leave_out_open(open, closed.input);
  FORCEGATE_TRY(Diagnosed out, diagnose_all(std::move(rows), options));
  if (!asks_for_closed_contact(out.diagnosis)) return out;
  // too few rows may be left to ask
  if (const Result<Diagnosed> while_closed = diagnose_all(std::move(closed), options)) judge_by_closed_contact(open, while_closed->diagnosis, out.diagnosis);
  return out;
}

}  // namespace

Result<Diagnosed> diagnose_campaign_in(Campaign campaign, const EngineOptions& options) {
  std::vector<PartlyTold> partly = partly_told(campaign);
  FORCEGATE_TRY(Diagnosed out, diagnose_records(std::move(campaign), options));
  for (PartlyTold& part : partly) {
    Result<Diagnosed> of_told = diagnose_records(part.told, options);  // too few may be left to ask
    if (of_told && take_partly_told(part, out.diagnosis, of_told->diagnosis)) return of_told;
  }
  return out;
}

Result<Diagnosis> diagnose_campaign(Campaign campaign, const EngineOptions& options) {
  FORCEGATE_TRY(Diagnosed out, diagnose_campaign_in(std::move(campaign), options));
  return std::move(out.diagnosis);
}

}  // namespace forcegate::diagnose
