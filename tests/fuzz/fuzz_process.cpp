// Answers of an adapter's program from any bytes: never a crash, and what is understood is finite and printable.

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "adapters/process/messages.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace forcegate;
  const auto reply = process::decode_reply({reinterpret_cast<const char*>(data), size});
  if (!reply) {
    if (reply.error().text.empty()) std::abort();
    return 0;
  }
  if (!reply->good && reply->error.empty()) std::abort();
  for (const auto& [name, value] : reply->number)
    if (!std::isfinite(value)) std::abort();
  for (const auto& row : reply->rows) {
    if (row.empty() || row.size() > process::kRowWidth) std::abort();
    for (const double value : row)
      if (std::isinf(value)) std::abort();
  }
  return 0;
}
