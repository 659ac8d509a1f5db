// Lane "block": the Cortex-M image as fast as the emulator goes.

#include "adapters/emulator/block_dut.h"
#include "adapters/emulator/qemu.h"
#include "adapters/link/image.h"
#include "hil/interface/dut.h"

namespace forcegate {
namespace {

const Registration<LaneKind> kRegistered{{
    "block",
    "The Cortex-M image (block port) in qemu-system-arm with semihosting. Open loop; closed loop in short "
    "blocks.",
    [](const std::filesystem::path& path) {
      const auto image = link::inspect_image(path);
      return image && image->port == "block";
    },
    [](const std::map<std::string, std::string>& options) -> Result<std::unique_ptr<Dut>> {
      FORCEGATE_TRY(QemuOptions given, Qemu::options("block", options, 20.0));
      return make_block_dut(std::move(given.program), given.timeout_s, BlockMode::block);
    },
}};

}  // namespace
}  // namespace forcegate
