#pragma once
// A verb with actions of its own has one list of options for all of them. What an action does not take is refused: it would be
// ignored without a word.

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "hil/cli/command.h"

namespace forcegate {

struct ActionOptions {
  std::string_view action;
  std::vector<std::string_view> options;  ///< names in the verb's table
  std::size_t most_files = 1;             ///< values of the positional FILE
};

/// Error (usage): the first option that `action` does not take, or more files than it takes. An action without a row takes everything.
Result<void> check_action_options(const Invocation& in, std::string_view action, std::span<const ActionOptions> table);

}  // namespace forcegate
