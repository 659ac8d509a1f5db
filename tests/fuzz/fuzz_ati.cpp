// Records of the ATI controller from any bytes: the parsers make progress, never read past the end, and accept a binary
// record only with its checksum.

#include <cstdint>
#include <cstdlib>
#include <span>

#include "adapters/ati/record.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace forcegate::ati;
  for (const int form : {0, 1, 2, 3}) {
    std::span<const std::uint8_t> stream(data, size);
    while (!stream.empty()) {
      const ParseResult r = form == 0   ? parse_binary(stream, true)
                            : form == 1 ? parse_binary(stream, false)
                                        : parse_ascii(stream, form == 2 ? 0 : 45);
      if (r.kind == Parse::need_more) {
        if (r.consumed != 0) std::abort();
        break;
      }
      if (r.consumed == 0 || r.consumed > stream.size()) std::abort();
      if (r.kind == Parse::value) {
        for (const int counts : r.record.counts)
          if (counts < -32768 || counts > 32767) std::abort();
        if (form == 3 && r.consumed != 45) std::abort();
      }
      stream = stream.subspan(r.consumed);
    }
  }
  return 0;
}
