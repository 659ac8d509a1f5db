#include "hil/app/gate/wire_faults.h"

#include <algorithm>

#include "hil/base/text.h"
#include "hil/interface/stimulus.h"
#include "hil/rig/bench_file.h"
#include "rigs/emulated/twins/host.h"

namespace forcegate {
namespace {

double longest_record_s(const Plan& plan, bool calibrates) {
  double longest_s = 0.0;
  const auto take = [&](const StimulusSpec& spec) {
    if (const auto made = make_stimulus(spec)) longest_s = std::max(longest_s, (*made)->duration_s());
  };
  for (const PlanCase& c : plan.cases) take(c.stimulus);
  if (!calibrates) return longest_s;
  const PlanCalibration& cal = plan.calibration;
  if (cal.level == CalibrationLevel::identified && cal.identification) take(cal.identification->stimulus);
  return std::max(longest_s, cal.sweep_s * cal.sweeps);
}

}  // namespace

Result<void> check_wire_faults(const GateRequest& request, const Plan& plan, bool calibrates) {
  const auto file = request.rig_options.find("file");
  if (request.rig != "bench" || file == request.rig_options.end()) return {};
  FORCEGATE_TRY(const BenchFile bench, read_bench(file->second));
  if (!bench.twins) return {};
  FORCEGATE_TRY(const emulated::TwinOptions twins, emulated::read_twin_options(bench.root));
  const double longest_s = longest_record_s(plan, calibrates);
  for (const emulated::FaultEntry& fault : twins.faults)
    if (fault.at_s >= longest_s && !fault.where.empty())
      return fail(ErrorCode::config, "the fault of the " + fault.device + " begins at " + shortest(fault.at_s) + " s: no record of plan " + plan.name + " is so long",
                  fault.where, "at_s is of the record, and the longest ends after " + shortest(longest_s) + " s");
  return {};
}

}  // namespace forcegate
