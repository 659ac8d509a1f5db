#include "hil/cli/verbs/limits_line.h"

#include <fmt/format.h>

#include <algorithm>

#include "hil/cli/parse.h"

namespace forcegate {

std::string line_after_limits(const Invocation& in, const DerivedLimits& limits, const std::string& file, const std::string& on) {
  if (limits.by_case_and_check.empty()) return "forcegate explain NO-DECISION";
  const bool recorded = on.starts_with(" --record");
  if (!recorded && takes_derived_limits(limits.plan)) {
    std::size_t n = 0;
    for (const auto& [key, limit] : limits.by_case_and_check) n = std::max(n, limit.n);
    const std::string reason = fmt::format("derived for plan {} from {} values each", limits.plan, n);
    return bless_line(file, shell_quoted(reason), "\"$(id -un)\"") + " --dry-run";
  }
  const std::string plan = recorded && !in.given("plan") ? "" : " --plan " + file_quoted(in.text("plan"));
  return "forcegate gate " + file_quoted(in.text("FIRMWARE")) + on + plan + " --limits " + file_quoted(file);
}

std::string bless_line(const std::string& source, const std::string& reason, const std::string& who) {
  return "forcegate bless " + file_quoted(source) + " --reason " + reason + " --who " + who;
}

}  // namespace forcegate
