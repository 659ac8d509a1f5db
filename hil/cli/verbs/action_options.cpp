#include "hil/cli/verbs/action_options.h"

#include <fmt/format.h>

#include <algorithm>

#include "hil/base/text.h"

namespace forcegate {

Result<void> check_action_options(const Invocation& in, std::string_view action, std::span<const ActionOptions> table) {
  const auto row = std::ranges::find(table, action, &ActionOptions::action);
  if (row == table.end()) return {};
  const std::string who = fmt::format("{} {}", in.command().name, action);
  for (const Option& o : in.command().options) {
    if (!in.given(o.name) || std::ranges::find(row->options, o.name) != row->options.end()) continue;
    std::vector<std::string> others;
    for (const ActionOptions& other : table)
      if (std::ranges::find(other.options, o.name) != other.options.end()) others.emplace_back(other.action);
    return fail(ErrorCode::usage, fmt::format("--{} means nothing to {}", o.name, who), "--" + o.name, "leave it out; it is for " + join(others, ", "));
  }
  if (const auto files = in.texts("FILE"); files.size() > row->most_files)
    return fail(ErrorCode::usage, row->most_files == 0 ? who + " takes no file" : who + " takes one bench file", files[row->most_files],
                row->most_files == 0 ? "leave it out" : "ask for one after the other");
  return {};
}

}  // namespace forcegate
