// Lane "tick": the same image, paced by its own 1 kHz clock in virtual time that counts instructions: what a
// sample costs is the same on every run of every machine.

#include "adapters/emulator/block_dut.h"
#include "adapters/emulator/qemu.h"
#include "adapters/link/image.h"
#include "hil/interface/dut.h"

namespace forcegate {
namespace {

const Registration<LaneKind> kRegistered{{
    "tick",
    "The Cortex-M image (block port) paced by its own 1 kHz timer, counting instructions: worst-case time of "
    "a "
    "sample, stack.",
    [](const std::filesystem::path& path) {
      const auto image = link::inspect_image(path);
      return image && image->port == "block" && image->ticks;
    },
    [](const std::map<std::string, std::string>& options) -> Result<std::unique_ptr<Dut>> {
      FORCEGATE_TRY(QemuOptions given, Qemu::options("tick", options, 20.0));
      return make_block_dut(std::move(given.program), given.timeout_s, BlockMode::tick);
    },
}};

}  // namespace
}  // namespace forcegate
