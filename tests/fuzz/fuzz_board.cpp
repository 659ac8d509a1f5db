// Two decoders of one byte table, written apart: what the board's twin takes for a frame, the harness takes for the same
// frame, and the other way round.

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <vector>

#include "adapters/link/frame.h"
#include "adapters/link/messages.h"
#include "rigs/emulated/twins/board_frame.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace forcegate;
  std::span<const std::uint8_t> rest(data, size);
  while (!rest.empty()) {
    const auto zero = std::find(rest.begin(), rest.end(), std::uint8_t{0});
    const auto length = static_cast<std::size_t>(zero - rest.begin());
    const auto stretch = rest.first(length);
    const auto twin = emulated::frame_of(stretch);
    std::vector<std::uint8_t> closed(stretch.begin(), stretch.end());
    closed.push_back(0);
    const auto harness = link::parse(closed);
    const bool same_major = harness.kind == link::Parse::value && harness.frame.version >> 4 == 1;
    if (twin.has_value() != same_major) std::abort();
    if (twin && (twin->type != harness.frame.type || twin->sequence != harness.frame.sequence ||
                 twin->t_us != harness.frame.t_us || twin->payload != harness.frame.payload))
      std::abort();
    if (twin) {
      (void)link::decode_stream_state(twin->payload);
      if (harness.frame.version == link::kVersion && emulated::frame_bytes(*twin) != closed) std::abort();
    }
    rest = rest.subspan(std::min(length + 1, rest.size()));
  }
  // Any payload crosses from either side to the other.
  emulated::BoardFrame frame;
  frame.type = size > 0 ? data[0] : 0;
  frame.payload.assign(data, data + std::min<std::size_t>(size, link::kPayloadMax));
  const auto bytes = emulated::frame_bytes(frame);
  const auto read = link::parse(bytes);
  if (read.kind != link::Parse::value || read.frame.payload != frame.payload ||
      link::encode(read.frame) != bytes)
    std::abort();
  return 0;
}
