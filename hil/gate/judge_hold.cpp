#include "hil/gate/judge_hold.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

namespace forcegate {

void judge_hold(const Plan& plan, const PlanCase& planned, const CaseRecord& record, bool sound, CaseChecks& checks) {
  if (!(planned.checks & kCheckHold)) return;
  const HoldFacts& h = record.hold;
  if (!sound) {
    checks.value_check("hold_amplification", "Amplification of a static hold", std::numeric_limits<double>::quiet_NaN(), "%", 0.0, 0,
                       {Limit::Kind::upper, plan.limits.hold_pct, "ours: plan"},
                       "the record is not whole and sound");
    return;
  }
  if (h.seconds <= 0.0 || !(std::fabs(h.raw_N) > 0.05)) {
    checks.final_check("hold_amplification", "Amplification of a static hold", Verdict::not_run,
                       record.rig.can_move ? Blame::user : Blame::recording,
                       record.rig.can_move ? "the profile holds no force for more than 30 s after cycling"
                                           : "the recording has no set-point (F_cmd_N) that stands still for more than 30 s after cycling, and a hold is told by that alone");
    return;
  }
  const double excess_pct = 100.0 * (h.dut_N / h.raw_N - 1.0);
  checks.value_check(
      "hold_amplification", "Amplification of a static hold", std::fabs(excess_pct), "%", 0.0, 1,
      {Limit::Kind::upper, plan.limits.hold_pct, "ours: plan"},
      fmt::format("firmware {:.3f} N, static law {:.3f} N, ATI {:.3f} N over {:.0f} s of hold", h.dut_N,
                  h.raw_N, h.ati_N, h.seconds));
}

}  // namespace forcegate
