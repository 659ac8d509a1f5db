#pragma once

#include <string_view>

namespace forcegate {

/// How a value of Rig::settings() begins that nobody shall read: it is compared, and never shown.
inline constexpr std::string_view kSealedSetting = "sealed:";

}  // namespace forcegate
