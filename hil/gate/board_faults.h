#pragma once
// Faults between harness and board, injected behind any lane: the answers of a sound image are spoiled the way a real
// link or board spoils them, and reported the way a lane reports them.

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "hil/interface/dut.h"

namespace forcegate {

struct BoardFaultKind {
  std::string name;
  std::string doc;  ///< what the magnitude means
  double minimum, maximum;
  double none;  ///< the magnitude that changes nothing
};

/// board_dead, board_reset, board_stale, link_corrupt, link_late, link_loss.
const std::vector<BoardFaultKind>& board_fault_kinds();

/// The faults of a request that are the rig's own.
std::map<std::string, double> rig_faults(const std::map<std::string, double>& faults);

/// Error (config) when a board fault has a magnitude out of range or that changes nothing.
Result<void> check_board_faults(const std::map<std::string, double>& faults);

/// `dut` itself when none of the faults is the board's.
std::unique_ptr<Dut> with_board_faults(std::unique_ptr<Dut> dut, const std::map<std::string, double>& faults,
                                       std::uint64_t seed);

}  // namespace forcegate
