#pragma once
// What tells a damaged golden from one of another profile.

#include <string>
#include <string_view>

namespace forcegate {

/// SHA-256 of a golden's lines as they were blessed; comments, line ends and tolerances, which a person may change, are no part
/// of it, nor is the line `digest` itself.
std::string golden_digest(std::string_view text);

}  // namespace forcegate
