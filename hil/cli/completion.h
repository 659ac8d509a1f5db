#pragma once
// Shell completion: a small fixed script per shell that calls the binary back, so that it never grows old.

#include <span>
#include <string>
#include <vector>

#include "hil/cli/command.h"

namespace forcegate {

/// Words that may stand at the end of `words` (all words after the program's name; the last is being typed and may be
/// empty). Empty: nothing to offer, the shell completes file names.
std::vector<std::string> completions(std::span<const std::string> words, const std::vector<Command>& table);

/// The script for "bash", "zsh" or "fish"; "" for another shell.
std::string completion_script(std::string_view shell);

}  // namespace forcegate
