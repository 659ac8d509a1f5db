#include "hil/cli/parse.h"

#include <fmt/format.h>

#include <algorithm>

#include "hil/base/text.h"

namespace forcegate {
namespace {

Error usage_error(std::string text, std::string where, std::string hint) {
  return {ErrorCode::usage, std::move(text), std::move(where), std::move(hint)};
}

std::string suggestion(std::string_view word, const std::vector<std::string>& names, std::string_view before,
                       std::string otherwise) {
  const std::string near = nearest_name(word, names);
  return near.empty() ? otherwise : fmt::format("did you mean \"{}{}\"?", before, near);
}

std::vector<std::string> option_names(const Command& command) {
  std::vector<std::string> names;
  for (const Option& o : command.options) names.push_back(o.name);
  for (const Option& o : global_options()) names.push_back(o.name);
  return names;
}

const Option* find_option(const std::vector<Option>& options, std::string_view name) {
  for (const Option& o : options)
    if (o.name == name || (o.letter != 0 && name.size() == 1 && name[0] == o.letter)) return &o;
  return nullptr;
}

std::optional<Error> check_choice(const std::string& value, std::string_view shown, const Choices& choices,
                                  bool only_choices, const std::string& where) {
  if (!choices || !only_choices) return std::nullopt;
  const std::vector<std::string> allowed = choices();
  if (std::find(allowed.begin(), allowed.end(), value) != allowed.end()) return std::nullopt;
  return usage_error(fmt::format("\"{}\" is not one of the values of {}", value, shown), where,
                     suggestion(value, allowed, "", "choose from: " + join(allowed, ", ")));
}

// What is being read: the state of one pass over the arguments.
class Reader {
 public:
  Reader(std::span<const std::string> arguments, const std::vector<Command>& table)
      : arguments_(arguments), table_(table) {}

  ParsedLine read() {
    for (const std::string& argument : arguments_) line_.words.push_back({shell_quoted(argument), {}});
    read_globals_first();
    for (std::size_t i = 0; i < arguments_.size() && !line_.error; ++i) {
      const std::string& argument = arguments_[i];
      if (!options_ended_ && argument == "--")
        options_ended_ = true, end_of_options_ = i;
      else if (!options_ended_ && argument.size() > 1 && argument[0] == '-')
        take_option(i);
      else if (line_.command == nullptr)
        take_verb(argument);
      else
        take_positional(argument, i);
    }
    drop_end_of_options();
    need_second_word();
    if (!line_.error && !line_.help && line_.command != nullptr) check_required();
    return std::move(line_);
  }

 private:
  // So that the error of an earlier argument is already printed as the user wants.
  void read_globals_first() {
    for (const std::string& argument : arguments_) {
      if (argument == "--") break;
      if (argument == "--json") line_.console.json = true;
      if (argument == "--quiet" || argument == "-q") line_.console.quiet = true;
      if (argument == "--color=never") line_.console.color = ConsoleOptions::Color::never;
    }
  }

  std::string where() const {
    return line_.command == nullptr ? "forcegate" : "forcegate " + line_.command->name;
  }

  std::string see_help() const { return fmt::format("see \"{} --help\"", where()); }

  void take_verb(const std::string& word) {
    if (word == "help") {
      line_.help = true;
      return;
    }
    const std::string name = line_.family.empty() ? word : line_.family + " " + word;
    std::vector<std::string> names;
    bool begins_family = false;
    for (const Command& c : table_) {
      if (c.name == name) line_.command = &c;
      if (!c.hidden && (line_.family.empty() || in_family(c.name, line_.family))) names.push_back(c.name);
      begins_family = begins_family || in_family(c.name, name);
    }
    if (line_.command != nullptr) return;
    if (line_.family.empty() && begins_family)
      line_.family = word;
    else
      line_.error = usage_error(fmt::format("there is no verb \"{}\"", name), "forcegate",
                                suggestion(name, names, "forcegate ",
                                           line_.family.empty() ? "\"forcegate --help\" lists the verbs"
                                                                : "choose: " + join(names, ", ")));
  }

  // "forcegate bench" alone.
  void need_second_word() {
    if (line_.family.empty() || line_.command != nullptr || line_.help || line_.error) return;
    std::vector<std::string> names;
    for (const Command& c : table_)
      if (in_family(c.name, line_.family) && !c.hidden) names.push_back(c.name);
    line_.error = usage_error(fmt::format("\"{}\" wants a second word", line_.family), "forcegate",
                              "choose: " + join(names, ", "));
  }

  // "bench faults" is a verb of its own although "bench" is one too.
  bool continues_name(const std::string& word) {
    if (second_word_passed_) return false;
    second_word_passed_ = true;
    for (const Command& c : table_)
      if (c.name == line_.command->name + " " + word) {
        line_.command = &c;
        return true;
      }
    return false;
  }

  // The line is said again with more behind it, which "--" would turn into names of files; these are named so that they need none.
  void drop_end_of_options() {
    if (!options_ended_) return;
    const auto end = line_.words.begin() + static_cast<std::ptrdiff_t>(end_of_options_);
    if (std::none_of(end + 1, line_.words.end(), [](const LineWord& word) { return word.quoted.starts_with('-') || word.quoted.starts_with("'-"); })) end->quoted.clear();
  }

  void take_positional(const std::string& word, std::size_t i) {
    if (continues_name(word)) return;
    const auto& positionals = line_.command->positionals;
    if (line_.help) return;
    if (at_positional_ >= positionals.size()) {
      line_.error = usage_error(fmt::format("unexpected argument \"{}\"", word), where(), see_help());
      return;
    }
    const Positional& p = positionals[at_positional_];
    line_.error = check_choice(word, p.name, p.choices, p.only_choices, where());
    line_.values.emplace_back(p.name, word);
    if (p.names != Names::nothing) line_.words[i].quoted = file_quoted(word);
    if (!p.repeatable) ++at_positional_;
  }

  void take_option(std::size_t& i) {
    const std::size_t first = i;
    const std::string& argument = arguments_[i];
    const bool is_long = argument.starts_with("--");
    const std::size_t equals = is_long ? argument.find('=') : std::string::npos;
    const std::string name = argument.substr(is_long ? 2 : 1, equals - (is_long ? 2 : 1));
    const Option* option = line_.command != nullptr ? find_option(line_.command->options, name) : nullptr;
    const bool own = option != nullptr;
    if (!own) option = find_option(global_options(), name);
    if (option == nullptr || (is_long && name.size() == 1 && option->name != name)) {
      const std::string written = (is_long ? "--" : "-") + name;
      line_.error = usage_error(fmt::format("{} has no option \"{}\"", where(), written), where(),
                                line_.command == nullptr
                                    ? "the verb comes first: \"forcegate --help\" lists them"
                                    : suggestion(name, option_names(*line_.command), "--", see_help()));
      return;
    }
    std::string value;
    if (option->value_name.empty()) {
      if (equals != std::string::npos)
        line_.error = usage_error(fmt::format("--{} takes no value", option->name), where(), see_help());
    } else if (equals != std::string::npos) {
      value = argument.substr(equals + 1);
    } else if (i + 1 < arguments_.size()) {
      value = arguments_[++i];
    } else {
      line_.error = usage_error(fmt::format("--{} wants a value {}", option->name, option->value_name),
                                where(), option->doc);
    }
    if (line_.error) return;
    if (option->names != Names::nothing && value.empty()) {
      line_.error = usage_error(fmt::format("--{} names nothing: its value is empty", option->name), where(),
                                fmt::format("give {}, or leave the option out; is a variable of the shell not set?", option->value_name));
      return;
    }
    if (!option->value_name.empty())
      line_.error = check_choice(value, "--" + option->name, option->choices, option->only_choices, where());
    for (std::size_t k = first; own && k <= i; ++k) line_.words[k].option = option->name;
    if (own)
      take_own(*option, value);
    else
      take_global(*option, value);
  }

  // The first of two files would be left unread without a word.
  void take_own(const Option& option, const std::string& value) {
    if (!option.value_name.empty() && !option.repeatable && given(option.name) && !line_.error)
      line_.error = usage_error(fmt::format("--{} is given twice", option.name), where(), "give it once");
    line_.values.emplace_back(option.name, value);
  }

  void take_global(const Option& option, const std::string& value) {
    if (option.name == "help") line_.help = true;
    if (option.name == "version") line_.version = true;
    if (option.name == "color")
      line_.console.color = value == "always"  ? ConsoleOptions::Color::always
                            : value == "never" ? ConsoleOptions::Color::never
                                               : ConsoleOptions::Color::automatic;
  }

  bool given(const std::string& name) const {
    return std::any_of(line_.values.begin(), line_.values.end(), [&](const auto& v) { return v.first == name; });
  }

  void check_required() {
    for (const Positional& p : line_.command->positionals)
      if (p.required && !given(p.name)) {
        line_.error = usage_error(fmt::format("{} is missing", p.name), where(), p.choices && p.list_choices ? "one of: " + join(p.choices(), ", ") : p.doc);
        return;
      }
    for (const Option& o : line_.command->options)
      if (o.required && !given(o.name)) {
        line_.error = usage_error(fmt::format("--{} {} is missing", o.name, o.value_name), where(), o.doc);
        return;
      }
  }

  std::span<const std::string> arguments_;
  const std::vector<Command>& table_;
  ParsedLine line_;
  bool options_ended_ = false, second_word_passed_ = false;
  std::size_t end_of_options_ = 0;
  std::size_t at_positional_ = 0;
};

}  // namespace

const std::vector<Option>& global_options() {
  static const std::vector<Option> kOptions = {
      {.name = "json",
       .value_name = "",
       .doc = "Print one JSON document on stdout instead of text; errors too."},
      {.name = "color",
       .value_name = "WHEN",
       .doc = "Colour of the text. auto obeys NO_COLOR, CLICOLOR_FORCE and the terminal.",
       .fallback = "auto",
       .choices =
           [] {
             return std::vector<std::string>{"auto", "always", "never"};
           }},
      {.name = "quiet", .value_name = "", .doc = "No progress, no notes, no \"next:\" line.", .letter = 'q'},
      {.name = "help", .value_name = "", .doc = "Print this text.", .letter = 'h'},
      {.name = "version", .value_name = "", .doc = "Print the version."},
  };
  return kOptions;
}

bool in_family(std::string_view name, std::string_view family) {
  return name.size() > family.size() + 1 && name.starts_with(family) && name[family.size()] == ' ';
}

ParsedLine parse_command_line(std::span<const std::string> arguments, const std::vector<Command>& table) {
  return Reader(arguments, table).read();
}

}  // namespace forcegate
