#pragma once

#include <fmt/format.h>

#include <set>
#include <span>
#include <string>
#include <string_view>

#include "hil/base/result.h"
#include "hil/base/text.h"

namespace forcegate {

/// Specimens that `--specimen` names. Errors: usage where one is named twice: its sessions would count twice.
inline Result<void> check_named_once(std::span<const std::string> specimens) {
  std::set<std::string_view> seen;
  for (const std::string& name : specimens)
    if (!seen.insert(name).second)
      return fail(ErrorCode::usage, fmt::format("specimen '{}' is named twice", printable_utf8(name)), "--specimen", "name every specimen once");
  return {};
}

}  // namespace forcegate
