#include "hil/cli/completion.h"

#include <algorithm>

#include "hil/cli/parse.h"

namespace forcegate {
namespace {

const Option* option_of(const Command& command, std::string_view word) {
  if (!word.starts_with("-")) return nullptr;
  const std::string_view name = word.substr(word.starts_with("--") ? 2 : 1);
  for (const auto* list : {&command.options, &global_options()})
    for (const Option& o : *list)
      if (o.name == name || (name.size() == 1 && o.letter == name[0])) return &o;
  return nullptr;
}

std::vector<std::string> starting_with(const std::vector<std::string>& words, std::string_view start) {
  std::vector<std::string> out;
  for (const std::string& w : words)
    if (w.starts_with(start)) out.push_back(w);
  return out;
}

constexpr const char* kBash = R"sh(# forcegate completion for bash: put into ~/.bashrc
#   eval "$(forcegate completion bash)"
_forcegate() {
  local IFS=$'\n'
  COMPREPLY=($("${COMP_WORDS[0]}" completion --words -- "${COMP_WORDS[@]:1:COMP_CWORD}" 2>/dev/null))
}
complete -o default -F _forcegate forcegate
)sh";

constexpr const char* kZsh = R"sh(#compdef forcegate
# forcegate completion for zsh: put into ~/.zshrc after compinit
#   eval "$(forcegate completion zsh)"
_forcegate() {
  local -a candidates
  candidates=(${(f)"$("${words[1]}" completion --words -- "${(@)words[2,CURRENT]}" 2>/dev/null)"})
  if (( ${#candidates} )); then compadd -- "${candidates[@]}"; else _files; fi
}
compdef _forcegate forcegate
)sh";

constexpr const char* kFish =
    R"sh(# forcegate completion for fish: save as ~/.config/fish/completions/forcegate.fish
function __forcegate_words
  set -l typed (commandline -opc) (commandline -ct)
  $typed[1] completion --words -- $typed[2..-1] 2>/dev/null
end
complete -c forcegate -a '(__forcegate_words)'
)sh";

}  // namespace

namespace {

// words.front() is the whole name of the verb.
std::vector<std::string> completions_of(std::span<const std::string> words,
                                        const std::vector<Command>& table) {
  const std::string current = words.back();
  const Command* command = nullptr;
  for (const Command& c : table)
    if (c.name == words.front()) command = &c;
  if (command == nullptr) return {};

  const Option* pending = nullptr;  // the option whose value is being typed
  std::size_t positional = 0;
  for (std::size_t i = 1; i + 1 < words.size(); ++i) {
    if (pending != nullptr) {
      pending = nullptr;
      continue;
    }
    const Option* option = option_of(*command, words[i]);
    if (option != nullptr && !option->value_name.empty())
      pending = option;
    else if (!words[i].starts_with("-") && positional < command->positionals.size() &&
             !command->positionals[positional].repeatable)
      ++positional;
  }
  if (pending != nullptr)
    return pending->choices ? starting_with(pending->choices(), current) : std::vector<std::string>{};
  if (current.starts_with("-")) {
    std::vector<std::string> names;
    for (const auto* list : {&command->options, &global_options()})
      for (const Option& o : *list) names.push_back("--" + o.name);
    return starting_with(names, current);
  }
  if (positional < command->positionals.size() && command->positionals[positional].choices)
    return starting_with(command->positionals[positional].choices(), current);
  return {};
}

}  // namespace

std::vector<std::string> completions(std::span<const std::string> words, const std::vector<Command>& table) {
  const std::string current = words.empty() ? "" : words.back();
  if (words.size() <= 1) {
    std::vector<std::string> verbs;
    for (const Command& c : table) {
      const std::string first = c.name.substr(0, c.name.find(' '));
      if (!c.hidden && std::find(verbs.begin(), verbs.end(), first) == verbs.end()) verbs.push_back(first);
    }
    return starting_with(verbs, current);
  }
  std::vector<std::string> second;
  for (const Command& c : table)
    if (!c.hidden && in_family(c.name, words.front()))
      second.push_back(c.name.substr(words.front().size() + 1));
  if (!second.empty()) {
    if (words.size() == 2) {
      for (std::string& word : completions_of(words, table)) second.push_back(std::move(word));
      return starting_with(second, current);
    }
    if (std::find(second.begin(), second.end(), words[1]) == second.end())
      return completions_of(words, table);
    std::vector<std::string> joined(words.begin() + 1, words.end());
    joined.front() = words.front() + " " + joined.front();
    return completions_of(joined, table);
  }
  return completions_of(words, table);
}

std::string completion_script(std::string_view shell) {
  if (shell == "bash") return kBash;
  if (shell == "zsh") return kZsh;
  if (shell == "fish") return kFish;
  return "";
}

}  // namespace forcegate
