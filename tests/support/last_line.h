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

/// The file that the last line shows to people, by the opener of this machine or by its name alone; "" when it shows none.
inline std::string file_to_look_at(const ProcessResult& r) {
  std::string text = r.out;
  while (!text.empty() && text.back() == '\n') text.pop_back();
  text = text.substr(text.rfind('\n') + 1);
  for (const std::string head : {"look at: ", "next: xdg-open "}) {
    if (!text.starts_with(head)) continue;
    const std::string file = text.substr(head.size());
    return file.starts_with('\'') ? file.substr(1, file.size() - 2) : file;
  }
  return {};
}

/// As it stands, by a shell that finds the program.
inline ProcessResult pasted(const std::string& command, const TemporaryFolder& folder) {
  return run_process({"bash", "-c", "PATH=" FORCEGATE_BINARY_DIR ":$PATH; " + command}, {.folder = folder.path()});
}

}  // namespace forcegate::test
