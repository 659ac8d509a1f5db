#include "hil/app/recording/recover.h"

namespace forcegate {

Result<Recovered> recover(const RecoverRequest& request) {
  Recovered out;
  out.output = request.output;
  if (out.output.empty()) out.output = std::filesystem::path(request.journal).replace_extension(".h5");
  std::error_code ignored;
  if (out.output == request.journal || std::filesystem::equivalent(out.output, request.journal, ignored))
    return fail(ErrorCode::usage, "the journal itself would be overwritten", out.output.string(),
                "choose another name with --out");
  if (!request.overwrite && std::filesystem::exists(out.output, ignored))
    return fail(ErrorCode::usage, "the output exists already", out.output.string(),
                "add --force to replace it");
  FORCEGATE_TRY(out.report, recover_journal(request.journal, out.output));
  return out;
}

}  // namespace forcegate
