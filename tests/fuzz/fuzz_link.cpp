// The link parser on any bytes: it always makes progress, and whatever it accepts encodes to a frame that it
// accepts again as the same.

#include <cstdint>
#include <cstdlib>
#include <span>

#include "adapters/link/frame.h"
#include "adapters/link/messages.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace forcegate::link;
  std::span<const std::uint8_t> stream(data, size);
  while (!stream.empty()) {
    const ParseResult result = parse(stream);
    if (result.consumed > stream.size()) std::abort();
    if (result.kind == Parse::need_more) break;
    if (result.consumed == 0) std::abort();
    if (result.kind == Parse::value) {
      const Frame& f = result.frame;
      if (f.payload.size() > kPayloadMax) std::abort();
      const auto again = parse(encode(f));
      if (again.kind != Parse::value || again.frame.type != f.type || again.frame.sequence != f.sequence ||
          again.frame.t_us != f.t_us || again.frame.version != f.version || again.frame.payload != f.payload)
        std::abort();
      (void)decode_info(f.payload);
      (void)decode_samples(f.payload);
      (void)decode_nak(f.payload);
      (void)decode_param_value(f.payload);
    }
    stream = stream.subspan(result.consumed);
  }
  return 0;
}
