// Any bytes as a CSV file: never a crash, and what is accepted holds together.

#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "hil/trace/csv.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  const auto file = forcegate::parse_csv(bytes, "fuzz.csv",
                                         {.column_map = {}, .assumed_rate_Hz = size % 2 == 0 ? 100.0 : 0.0});
  if (!file) {
    if (file.error().text.empty()) std::abort();
    return 0;
  }
  const auto& t = file->trace.time_bases.at(0).t_s;
  for (std::size_t i = 1; i < t.size(); ++i)
    if (!(t[i] > t[i - 1])) std::abort();
  for (const auto& channel : file->trace.channels)
    if (channel.value.size() != t.size() || (!channel.raw.empty() && channel.raw.size() != t.size()))
      std::abort();
  return 0;
}
