#pragma once
// The Cortex-M image that ships, in qemu-system-arm, fed through semihosting files that are named pipes
// (docs/protocol.md). Memory stays bounded however long the record is, and a block may be as short as the ten
// samples of a control period.

#include <memory>
#include <string>

#include "hil/interface/dut.h"

namespace forcegate {

enum class BlockMode {
  block,  ///< as fast as it goes
  tick,   ///< one sample at each tick of the image's 1 kHz clock, in virtual time that counts instructions
};

std::unique_ptr<Dut> make_block_dut(std::string program, double timeout_s, BlockMode mode);

}  // namespace forcegate
