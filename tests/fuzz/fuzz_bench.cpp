// Any text as a bench file: read or refused with a position, never a crash.

#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "hil/rig/bench_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace forcegate;
  const auto bench = read_bench_text({reinterpret_cast<const char*>(data), size}, "fuzz.toml");
  if (!bench) {
    if (bench.error().where.empty() || bench.error().text.empty()) std::abort();
    return 0;
  }
  (void)check_devices(*bench);
  (void)rig_info(*bench);
  return 0;
}
