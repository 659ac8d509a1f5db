#include "hil/app/explain.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "hil/base/text.h"
#include "hil/cli/command.h"
#include "hil/cli/help.h"

namespace forcegate {
namespace {

std::vector<std::string> terms() {
  std::vector<std::string> out;
  for (const Explanation& e : explanations()) out.push_back(e.term);
  return out;
}

Result<int> run(const Invocation& in) {
  Console& console = in.console();
  nlohmann::ordered_json document = {{"format", 1}, {"terms", nlohmann::ordered_json::array()}};
  const auto add = [&](const Explanation& e) {
    document["terms"].push_back(
        {{"term", e.term}, {"kind", e.kind}, {"meaning", e.meaning}, {"what_to_do", e.what_to_do}});
  };
  if (!in.given("TERM")) {
    std::string kind;
    for (const Explanation& e : explanations()) {
      if (e.kind != kind) console.print((kind.empty() ? "" : "\n") + console.paint(Paint::strong, e.kind));
      kind = e.kind;
      console.print(fmt::format("  {:<14}{}", e.term, wrapped(e.meaning, 16).substr(16)));
      add(e);
    }
    console.print_json(document.dump(2));
    console.next("forcegate explain NO-DECISION");
    return kExitSuccess;
  }
  const std::string term = in.text("TERM");
  const std::vector<Explanation> found = find_explanations(term);
  if (found.empty()) {
    const std::vector<std::string> known = terms();
    const std::string near = nearest_name(term, known);
    return fail(
        ErrorCode::usage, fmt::format("no report uses the word \"{}\"", term), "forcegate explain",
        near.empty() ? "\"forcegate explain\" lists all of them" : fmt::format("did you mean \"{}\"?", near));
  }
  for (const Explanation& e : found) {
    console.print(fmt::format("{} ({})\n{}\nWhat to do: {}", console.paint(Paint::strong, e.term), e.kind,
                              trim(wrapped(e.meaning, 0)), trim(wrapped(e.what_to_do, 0))));
    add(e);
  }
  console.print_json(document.dump(2));
  console.next("forcegate explain");
  return kExitSuccess;
}

const Registration<Command> kRow{Command{
    .name = "explain",
    .group = "House",
    .summary = "what a verdict, a decision or an exit code means and what to do about it",
    .description =
        "Every word that a report uses for a verdict, a decision or the one who must act, and every exit "
        "code, in one sentence, with what to do next. Without TERM: all of them.",
    .positionals = {{.name = "TERM",
                     .doc = "Word of a report or exit code, in any case.",
                     .required = false,
                     .choices = terms,
                     .only_choices = false}},
    .examples = {{"forcegate explain marginal", "Why a check that passed is not simply \"pass\":"},
                 {"forcegate explain 4", "What a continuous integration should do after exit code 4:"}},
    .run = run,
}};

}  // namespace
}  // namespace forcegate
