#pragma once
// The decision for a terminal: first line = symbol, word, reason; then what to look at, worst first.

#include <string>

#include "hil/interface/run_result.h"

namespace forcegate {

struct ConsoleView {
  bool colour = false;  ///< ANSI escape codes
  bool ascii = false;   ///< no byte above 0x7F of our own (texts of the firmware stay as they are)
  int max_rows = 20;
  bool notes = true;
};

std::string render_console(const RunResult& result, const ConsoleView& view);

}  // namespace forcegate
