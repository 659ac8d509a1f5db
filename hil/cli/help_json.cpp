#include <nlohmann/json.hpp>

#include "hil/cli/help.h"
#include "hil/cli/parse.h"

namespace forcegate {
namespace {

using Json = nlohmann::ordered_json;

void add_choices(const Choices& choices, bool only, Json& out) {
  if (!choices) return;
  out["choices"] = choices();
  out["only_choices"] = only;
}

Json options_json(const std::vector<Option>& options) {
  Json out = Json::array();
  for (const Option& o : options) {
    Json one = {{"name", "--" + o.name}, {"doc", o.doc}, {"required", o.required}, {"repeatable", o.repeatable}};
    if (o.letter != 0) one["letter"] = std::string("-") + o.letter;
    if (!o.value_name.empty()) one["value"] = o.value_name;
    if (!o.fallback.empty()) one["default"] = o.fallback;
    add_choices(o.choices, o.only_choices, one);
    out.push_back(std::move(one));
  }
  return out;
}

Json exit_codes_json(const std::vector<int>& codes, const std::string& reject_text = {}) {
  Json out = Json::object();
  for (const int code : codes) out[std::to_string(code)] = exit_code_text(code, reject_text);
  return out;
}

}  // namespace

std::string overview_json(const std::vector<Command>& table) {
  Json verbs = Json::array();
  for (const Command& c : table)
    if (!c.hidden) verbs.push_back({{"name", c.name}, {"group", c.group}, {"summary", c.summary}});
  const Json out = {{"format", 1}, {"verbs", verbs}, {"options", options_json(global_options())}, {"exit_codes", exit_codes_json(exit_codes())}};
  return out.dump(2) + "\n";
}

std::string command_json(const Command& command) {
  Json positionals = Json::array(), examples = Json::array();
  for (const Positional& p : command.positionals) {
    Json one = {{"name", p.name}, {"doc", p.doc}, {"required", p.required}, {"repeatable", p.repeatable}};
    add_choices(p.choices, p.only_choices, one);
    positionals.push_back(std::move(one));
  }
  for (const Example& e : command.examples) examples.push_back({{"command", e.command}, {"doc", e.doc}});
  Json out = {{"format", 1},
              {"verb", command.name},
              {"summary", command.summary},
              {"usage", usage_line(command)},
              {"description", command.description},
              {"arguments", positionals},
              {"options", options_json(command.options)},
              {"options_of_every_verb", options_json(global_options())},
              {"examples", examples},
              {"exit_codes", exit_codes_json(exit_codes_of(command), command.reject_text)}};
  if (command.details) out["details"] = command.details();
  return out.dump(2) + "\n";
}

}  // namespace forcegate
