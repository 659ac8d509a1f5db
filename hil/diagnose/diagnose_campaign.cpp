#include <algorithm>

#include "hil/diagnose/engine.h"

namespace forcegate::diagnose {

namespace {

Result<Diagnosed> diagnose_once(Campaign campaign, const EngineOptions& options) {
  Diagnosed out;
  FORCEGATE_TRY(out.workspace, prepare(std::move(campaign), options));
  out.diagnosis = diagnose_workspace(*out.workspace, options);
  return out;
}

// A zero that wanders by itself and what a hold shows of creep look alike within a fifth of a recording. It is asked with zeros of its
// parts and with one zero for all. The second answer counts where it describes the whole recording down to its noise, which no course of
// an effect does with a wander; where the first finds nothing and leaves the whole far above its floor, and above what a zero wanders by,
// that is no "none".
Result<Diagnosed> diagnose_one_recording(Campaign campaign, const EngineOptions& options) {
  constexpr double kFarBetter = 0.6, kToItsNoise = 1.5, kFarAbove = 5.0;
  constexpr double kLargestWander = 0.01;  // of the span
  EngineOptions standing = options;
  standing.zero_wanders = false;
  FORCEGATE_TRY(Diagnosed stands, diagnose_once(campaign, standing));
  FORCEGATE_TRY(Diagnosed wanders, diagnose_once(std::move(campaign), options));
  Diagnosis& answer = wanders.diagnosis;
  const Diagnosis& other = stands.diagnosis;
  if (other.plain_after < kFarBetter * answer.plain_after && other.plain_after < kToItsNoise * other.floor) return stands;
  const double plain = std::max(kFarAbove * answer.floor, kLargestWander * wanders.workspace->output.scale);
  if (answer.verdict != DiagnosisVerdict::none || answer.plain_after < plain) return wanders;
  if (other.verdict == DiagnosisVerdict::unknown) return stands;
  answer.verdict = DiagnosisVerdict::unknown;
  answer.depends_on = {"time"};
  answer.notes.push_back("parts of the recording differ in gain or zero by far more than its noise: something changes with time");
  return wanders;
}

}  // namespace

Result<Diagnosed> diagnose_campaign_in(Campaign campaign, const EngineOptions& options) {
  if (campaign.records.size() == 1) return diagnose_one_recording(std::move(campaign), options);
  return diagnose_once(std::move(campaign), options);
}

Result<Diagnosis> diagnose_campaign(Campaign campaign, const EngineOptions& options) {
  FORCEGATE_TRY(Diagnosed out, diagnose_campaign_in(std::move(campaign), options));
  return std::move(out.diagnosis);
}

}  // namespace forcegate::diagnose
