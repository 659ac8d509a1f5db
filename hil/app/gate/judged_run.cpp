#include "hil/app/gate/judged_run.h"

#include "hil/base/iso_date.h"
#include "hil/base/text.h"

namespace forcegate {

Result<void> check_day(const std::string& today) {
  if (today.empty() || is_iso_date(today)) return {};
  return fail(ErrorCode::usage, "'" + printable_utf8(today) + "' is no date", "--today", "write 2026-12-31");
}

Result<RunEvidence> read_evidence(const GateRequest& request, const std::filesystem::path& plan,
                                  const std::string& goldens) {
  RunEvidence evidence;
  evidence.today = request.today;
  std::error_code ignored;
  if (!request.goldens.empty() && !std::filesystem::is_directory(request.goldens, ignored))
    return fail(ErrorCode::usage, "there is no folder of golden traces", request.goldens.string(),
                "mend the name; for the first goldens make the folder (mkdir " + file_quoted(request.goldens.string()) + "), gate with --golden, and forcegate bless the run");
  if (!goldens.empty()) {
    FORCEGATE_TRY(evidence.goldens, read_goldens(plan.parent_path() / goldens));
  }
  FORCEGATE_CHECK_OK(check_day(request.today));
  if (request.waivers.empty()) return evidence;
  FORCEGATE_TRY(evidence.waivers, read_waivers(request.waivers));
  return evidence;
}

}  // namespace forcegate
