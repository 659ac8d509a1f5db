#include "hil/gate/judge.h"

#include <string>
#include <string_view>
#include <utility>

#include "hil/gate/blame.h"
#include "hil/gate/case_checks.h"
#include "hil/gate/judge_accuracy.h"
#include "hil/gate/judge_conformance.h"
#include "hil/gate/judge_excursion.h"
#include "hil/gate/judge_hold.h"
#include "hil/gate/judge_inputs.h"
#include "hil/gate/judge_output.h"
#include "hil/gate/judge_target.h"

namespace forcegate {
namespace {

// Nothing further can be judged.
void judge_failure(const CaseFailure& f, CaseChecks& checks, JudgedCase& out) {
  const ErrorCode code = f.error.code;
  const std::string_view device = f.stage == CaseFailure::Stage::rig ? device_of(f.error.where) : std::string_view();
  const std::string text = (device.empty() ? "" : std::string(device) + ": ") + f.error.text + (f.error.hint.empty() ? "" : " (" + f.error.hint + ")");
  // An instrument that saw the firmware fail says so by its code: a board on the rig answers for the firmware too.
  const bool cancelled = code == ErrorCode::cancelled,
             firmware = f.stage == CaseFailure::Stage::firmware ||
                        (f.stage == CaseFailure::Stage::rig && code == ErrorCode::firmware);
  if (firmware && code == ErrorCode::firmware) {
    checks.final_check("firmware_runs", "The firmware answers every sample", Verdict::fail, Blame::firmware, text);
  } else if (firmware && code != ErrorCode::internal && !cancelled) {
    checks.final_check("firmware_runs", "The firmware answers every sample", Verdict::rig_error, Blame::link, text);
  } else if (f.stage == CaseFailure::Stage::rig && !cancelled) {
    checks.final_check("rig_runs", "The rig plays the record", Verdict::rig_error,
                       f.blame == Blame::none ? blame_of_device(f.error.where) : f.blame, text);
  } else {
    out.cancelled = cancelled;
    out.harness_error = !cancelled && f.stage != CaseFailure::Stage::setup;
    if (out.harness_error) out.harness_text = text;
    checks.final_check("record", "Record", Verdict::not_run,
                       out.harness_error ? Blame::harness : code == ErrorCode::firmware ? Blame::firmware
                                                                                        : Blame::user,
                       cancelled ? "interrupted" : text);
  }
}

void judge_record(const Plan& plan, const PlanCase& planned, const CaseRecord& record, const DerivedLimits& limits,
                  CaseChecks& checks, JudgedCase& out) {
  const InputsFound inputs = judge_inputs(plan, planned, record, checks, out);
  judge_output(plan, record, inputs.calibration_fits, checks);
  judge_excursion(plan, planned, record, checks);
  judge_conformance(plan, planned, record, inputs.link_sound, checks);
  const Blame spoiled = !inputs.link_sound ? Blame::link : checks.rig_sound ? Blame::none
                                                                            : checks.rig_blame;
  for (JudgedCheck& check : judge_target(plan, record, spoiled)) checks.list.push_back(std::move(check));
  judge_accuracy(plan, planned, record, limits, checks, out);
  judge_hold(plan, planned, record, out.sound, checks);
}

}  // namespace

JudgedCase judge_case(const Plan& plan, const PlanCase& planned, const CaseRecord& record,
                      const DerivedLimits& limits) {
  CaseChecks checks(record.id);
  JudgedCase out;
  if (record.failure)
    judge_failure(*record.failure, checks, out);
  else
    judge_record(plan, planned, record, limits, checks, out);
  out.checks = std::move(checks.list);
  return out;
}

}  // namespace forcegate
