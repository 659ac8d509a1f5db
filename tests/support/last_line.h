#pragma once
// The last line of an answer, and what a shell makes of it when it is pasted.

#include <string>

#include "tests/support/process.h"

namespace forcegate::test {

/// Without "next: "; "" when there is none.
inline std::string next_of(const ProcessResult& r) {
  std::string text = r.out;
  while (!text.empty() && text.back() == '\n') text.pop_back();
  text = text.substr(text.rfind('\n') + 1);
  return text.starts_with("next: ") ? text.substr(6) : "";
}

/// As it stands, by a shell that finds the program.
inline ProcessResult pasted(const std::string& command, const TemporaryFolder& folder) {
  return run_process({"bash", "-c", "PATH=" FORCEGATE_BINARY_DIR ":$PATH; " + command}, {.folder = folder.path()});
}

}  // namespace forcegate::test
