#include "hil/app/gate/same_conditions.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "hil/base/text.h"
#include "hil/gate/calibrate.h"

namespace forcegate {
namespace {

// Of a bench its file says what it is; where a recording and its calibration lie is no condition.
std::string options_in_words(const GateRequest& request) {
  static const std::set<std::string> kPlaces = {"record", "cal"};
  std::vector<std::string> out;
  if (request.rig == "bench") return {};
  for (const auto& [name, value] : request.rig_options)
    if (!kPlaces.contains(name)) out.push_back(name + "=" + printable_utf8(value));
  return join(out, ", ");
}

bool same_recording(const RigInfo& a, const RigInfo& b) {
  const auto x = a.details.find("record_sha256"), y = b.details.find("record_sha256");
  return x != a.details.end() && y != b.details.end() && x->second == y->second;
}

}  // namespace

void state_conditions(const GateRequest& request, RunResult& head) {
  std::vector<std::string> faults;
  for (const auto& [name, value] : request.faults) faults.push_back(name + "=" + shortest(value));
  if (!faults.empty()) head.environment[kFaults] = join(faults, ", ");
  if (std::string options = options_in_words(request); !options.empty()) head.environment[kRigOptions] = std::move(options);
}

std::string stated_condition(const RunResult& run, const std::string& what) {
  const auto at = run.environment.find(what);
  return at == run.environment.end() ? kNoCondition : at->second;
}

std::string calibration_difference(const Calibration& a, const Calibration& b) {
  std::vector<std::string> out;
  const auto compare = [&](const char* what, double x, double y) {
    if (x != y) out.push_back(fmt::format("{} {} and {}", what, shortest(x), shortest(y)));
  };
  if (a.level != b.level) out.push_back(fmt::format("level {} and {}", to_string(a.level), to_string(b.level)));
  compare("gain_N_per_V", a.gain_N_per_V, b.gain_N_per_V);
  compare("offset_N", a.offset_N, b.offset_N);
  compare("b_scale", a.b_scale, b.b_scale);
  compare("q_scale", a.q_scale, b.q_scale);
  compare("adc_bits", a.adc_bits, b.adc_bits);
  compare("v_range_V", a.v_range_V, b.v_range_V);
  return join(out, ", ");
}

Result<void> check_same_conditions(const RunResult& stored, const RunResult& head, const GateRequest& request, const GateSetup* setup,
                                   const std::filesystem::path& path) {
  const auto other = [&](const std::string& what) {
    return fail(ErrorCode::usage, "the stored run has " + what, path.string(),
                "compare runs of one plan, seed, rig and calibration, with the same faults and options of the rig, or give the image itself");
  };
  const auto differs = [&](const char* what, const std::string& theirs, const std::string& ours) -> Result<void> {
    if (theirs == ours) return {};
    return other(fmt::format("{}: {} (here {})", what, printable_utf8(theirs), printable_utf8(ours)));
  };
  FORCEGATE_CHECK_OK(differs("another plan", stored.plan_sha256, head.plan_sha256));
  FORCEGATE_CHECK_OK(differs("another seed", std::to_string(stored.seed), std::to_string(head.seed)));
  FORCEGATE_CHECK_OK(differs("another rig", stored.rig.name + "/" + stored.rig.version, head.rig.name + "/" + head.rig.version));
  FORCEGATE_CHECK_OK(differs("other faults", stated_condition(stored, kFaults), stated_condition(head, kFaults)));
  FORCEGATE_CHECK_OK(differs("other options of the rig", stated_condition(stored, kRigOptions), stated_condition(head, kRigOptions)));
  if (setup == nullptr) return {};
  // A bench is calibrated anew for every session, and so is what another recording was made with.
  const bool values = !calibrates(request, *setup) && (setup->rig.emulated || same_recording(stored.rig, setup->rig));
  const CalibrationLevel level = setup->calibration ? setup->calibration->level : calibrates(request, *setup) ? setup->plan.calibration.level : CalibrationLevel::nominal;
  const Calibration ours = setup->calibration ? *setup->calibration : nominal_calibration(setup->rig);
  for (const CaseResult& theirs : stored.cases) {
    const Calibration& a = theirs.calibration;
    const std::string what = values            ? calibration_difference(a, ours)
                             : a.level != level ? fmt::format("level {} and {}", to_string(a.level), to_string(level))
                                                : std::string();
    const bool played = std::any_of(setup->plan.cases.begin(), setup->plan.cases.end(),
                                    [&](const PlanCase& c) { return theirs.id.starts_with(c.name + "/"); });
    if (played && theirs.samples > 0 && !what.empty()) return other(fmt::format("another calibration in {}: {}", theirs.id, what));
  }
  return {};
}

}  // namespace forcegate
