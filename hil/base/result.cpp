#include "hil/base/result.h"

namespace forcegate {

std::string_view to_string(ErrorCode code) {
  switch (code) {
    case ErrorCode::usage: return "usage";
    case ErrorCode::config: return "config";
    case ErrorCode::parse: return "parse";
    case ErrorCode::io: return "io";
    case ErrorCode::device: return "device";
    case ErrorCode::timeout: return "timeout";
    case ErrorCode::firmware: return "firmware";
    case ErrorCode::safety: return "safety";
    case ErrorCode::cancelled: return "cancelled";
    case ErrorCode::internal: return "internal";
  }
  return "internal";
}

std::string Error::to_text() const {
  std::string out = "error: " + text;
  if (!where.empty()) out += "\n  where: " + where;
  if (!hint.empty()) out += "\n  help: " + hint;
  return out;
}

}  // namespace forcegate
