#pragma once
// One function in a forked child, whose text comes back: for code of a firmware image that may crash or hang.

#include <functional>
#include <string>

#include "hil/base/result.h"

namespace forcegate {

/// Runs `work` in a child and returns its text. A child that dies or takes more than `cpu_s` of processor time or `wall_s` of
/// time gives ErrorCode::firmware when it was inside the image (FirmwareGuard), else internal. An error of `work` comes back as
/// it was. The calling process must have no other threads.
Result<std::string> run_in_child(const std::function<Result<std::string>()>& work, double cpu_s, double wall_s);

}  // namespace forcegate
