#include "hil/cli/completion.h"

#include <nlohmann/json.hpp>

#include "hil/cli/command.h"

namespace forcegate {
namespace {

std::vector<std::string> shells() { return {"bash", "zsh", "fish"}; }

Result<int> run(const Invocation& in) {
  const std::vector<std::string> words = in.texts("SHELL");
  if (in.flag("words")) {
    const std::vector<std::string> offered = completions(words, Registry<Command>::instance().all());
    for (const std::string& word : offered) in.console().print(word);
    in.console().print_json(nlohmann::ordered_json{{"format", 1}, {"words", offered}}.dump(2));
    return kExitSuccess;
  }
  if (words.size() != 1 || completion_script(words[0]).empty())
    return fail(ErrorCode::usage,
                words.empty() ? "SHELL is missing" : "there is no script for \"" + words[0] + "\"",
                "forcegate completion", "choose from: bash, zsh, fish");
  in.console().print(completion_script(words[0]));
  in.console().print_json(nlohmann::ordered_json{{"format", 1}, {"shell", words[0]}, {"script", completion_script(words[0])}}.dump(2));
  return kExitSuccess;
}

const Registration<Command> kRow{Command{
    .name = "completion",
    .group = "House",
    .summary = "script that teaches a shell to complete verbs, options and their values",
    .description =
        "Prints a small script for bash, zsh or fish. The script asks this binary for the words, so it "
        "stays right when verbs, stimuli or rigs are added. Where there is nothing to offer the shell "
        "completes file names.",
    .positionals = {{.name = "SHELL",
                     .doc = "Shell to make the script for.",
                     .required = false,
                     .repeatable = true,
                     .choices = shells,
                     .only_choices = false}},
    .options = {{.name = "words",
                 .value_name = "",
                 .doc = "Used by the scripts: offer words for the last argument."}},
    .examples = {{"eval \"$(forcegate completion bash)\"", "In this bash, from now on:"}},
    .run = run,
}};

}  // namespace
}  // namespace forcegate
