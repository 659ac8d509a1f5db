#include "hil/cli/verbs/rig_choice.h"

#include <algorithm>

#include "hil/app/recording/convert.h"
#include "hil/base/text.h"
#include "hil/base/utc_clock.h"
#include "hil/cli/parse.h"
#include "hil/interface/rig.h"

namespace forcegate {

Result<std::map<std::string, std::string>> named_values(const Invocation& in, const std::string& option) {
  std::map<std::string, std::string> values;
  for (const std::string& word : in.texts(option)) {
    const std::size_t equals = word.find('=');
    if (equals == std::string::npos || equals == 0)
      return fail(ErrorCode::usage, "'" + printable_utf8(word) + "' is not NAME=VALUE", "--" + option,
                  "write the name, = and the value");
    values[word.substr(0, equals)] = word.substr(equals + 1);
  }
  return values;
}

std::vector<Option> rig_rows() {
  return {{.name = "rig",
           .value_name = "NAME|FILE",
           .doc = "Rig, or a bench file.",
           .fallback = "emulated",
           .choices = [] { return Registry<RigKind>::instance().names(); },
           .only_choices = false,
           .names = Names::input},
          {.name = "rig-option", .value_name = "NAME=VALUE", .doc = "Option of the rig.", .repeatable = true},
          {.name = "arm", .value_name = "", .doc = "Let a real bench move: nobody reaches into it."}};
}

std::string rig_words(const Invocation& in) {
  std::string out = in.given("rig") ? " --rig " + file_quoted(in.text("rig")) : "";
  for (const std::string& option : in.texts("rig-option")) out += " --rig-option " + shell_quoted(option);
  return out + (in.flag("arm") ? " --arm" : "");
}

Result<RigChoice> rig_choice(const Invocation& in) {
  RigChoice choice;
  choice.rig = in.text("rig");
  FORCEGATE_TRY(choice.options, named_values(in, "rig-option"));
  const auto& rows = in.command().options;
  const bool plays_recordings =
      std::any_of(rows.begin(), rows.end(), [](const Option& o) { return o.name == "record"; });
  if (plays_recordings && in.given("record") && !in.given("rig")) choice.rig = "replay";
  if (choice.rig.ends_with(".toml")) {
    choice.options["file"] = choice.rig;
    choice.rig = "bench";
  }
  if (choice.rig == "bench") {
    choice.options["today"] = utc_today();
    choice.options["purpose"] = in.command_line();
    if (in.flag("arm")) choice.options["arm"] = "yes";
  } else if (in.flag("arm")) {
    return fail(ErrorCode::usage, "nothing of the rig " + choice.rig + " can be armed", "--arm",
                "a bench file moves real instruments: --rig BENCH.toml --arm");
  }
  return choice;
}

Option map_row() {
  return {.name = "map",
          .value_name = "COLUMN=NAME",
          .doc = "Name of a column of the recording, for instance Load=F_ref_N.",
          .repeatable = true};
}

Result<std::string> column_map_lines(const Invocation& in) {
  const std::vector<std::string> words = in.texts("map");
  FORCEGATE_CHECK_OK(parse_column_map(words));
  return join(words, "\n");
}

Result<void> take_recording(const Invocation& in, RigChoice& choice) {
  if (in.given("record")) choice.options["record"] = in.text("record");
  if (!in.given("map")) return {};
  if (choice.rig != "replay")
    return fail(ErrorCode::usage, "the rig " + choice.rig + " has no columns to map", "--map", "it is for --record FILE");
  FORCEGATE_TRY(choice.options["map"], column_map_lines(in));
  return {};
}

}  // namespace forcegate
