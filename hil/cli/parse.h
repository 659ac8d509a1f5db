#pragma once
// Command line -> row of the table and its values.

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "hil/base/text.h"
#include "hil/cli/command.h"

namespace forcegate {

/// Options that every verb has: --json, --quiet, --color, --help.
const std::vector<Option>& global_options();

struct ParsedLine {
  ConsoleOptions console;            ///< filled even when there is an error
  const Command* command = nullptr;  ///< nullptr: no verb was given
  std::string family;                ///< "bench" when only the first word of "bench selfcheck" was given
  bool help = false;
  bool version = false;
  std::vector<std::pair<std::string, std::string>> values;  ///< name in the table, value ("" of a flag)
  std::vector<LineWord> words;                              ///< in the order in which they were given
  std::optional<Error> error;
};

/// Whether `name` is a two-word verb of that family ("bench selfcheck" of "bench").
bool in_family(std::string_view name, std::string_view family);

/// `arguments` without the program's name. Never touches files. `--name value`, `--name=value`, `-o value`; "--" ends
/// the options; an option takes the next argument whatever it looks like. A verb's option with a value is given once
/// unless it is repeatable; flags and global options may come again.
ParsedLine parse_command_line(std::span<const std::string> arguments, const std::vector<Command>& table);

}  // namespace forcegate
