#pragma once
// Texts made from the command table.

#include <string>
#include <vector>

#include "hil/cli/command.h"

namespace forcegate {

/// `forcegate --help`: the verbs by group, what to type first, the exit codes.
std::string overview_text(const std::vector<Command>& table, const Console& console);

/// `forcegate VERB --help`.
std::string command_text(const Command& command, const Console& console);

/// The same two as one JSON document each, format 1.
std::string overview_json(const std::vector<Command>& table);
std::string command_json(const Command& command);

/// "forcegate gate [OPTIONS] FIRMWARE"
std::string usage_line(const Command& command);

/// One page of roff (man 1) for the whole program; same bytes for the same table and version.
std::string man_page(const std::vector<Command>& table, const std::string& version);

/// What an exit code means, one sentence; "" for an unknown one.
/// `reject_text`: of code 1, where a verb has its own (Command::reject_text).
std::string exit_code_text(int code, const std::string& reject_text = {});

/// All documented exit codes, ascending.
const std::vector<int>& exit_codes();
/// Those of the row, and 130: Ctrl-C ends every verb.
std::vector<int> exit_codes_of(const Command& command);

/// `text` in lines of at most `width` columns, every line after `indent` spaces; "\n" stays a line end.
std::string wrapped(const std::string& text, std::size_t indent, std::size_t width = 100);

}  // namespace forcegate
