#include "hil/app/judged_run.h"

namespace forcegate {

Result<RunEvidence> read_evidence(const GateRequest& request, const std::filesystem::path& plan,
                                  const std::string& goldens) {
  RunEvidence evidence;
  evidence.today = request.today;
  if (!goldens.empty()) {
    FORCEGATE_TRY(evidence.goldens, read_goldens(plan.parent_path() / goldens));
  }
  if (!request.today.empty() && !is_iso_date(request.today))
    return fail(ErrorCode::usage, "'" + request.today + "' is no date", "--today", "write 2026-12-31");
  if (request.waivers.empty()) return evidence;
  FORCEGATE_TRY(evidence.waivers, read_waivers(request.waivers));
  return evidence;
}

}  // namespace forcegate
