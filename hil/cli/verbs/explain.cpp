#include "hil/app/help/explain.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <nlohmann/json.hpp>

#include "hil/base/text.h"
#include "hil/cli/command.h"
#include "hil/cli/help.h"

namespace forcegate {
namespace {

std::vector<std::string> checks() {
  std::vector<std::string> out;
  for (const Explanation& e : check_explanations()) out.push_back(e.term);
  return out;
}

std::vector<std::string> terms() {
  std::vector<std::string> out;
  for (const Explanation& e : explanations())
    if (std::ranges::find(out, e.term) == out.end()) out.push_back(e.term);
  for (const std::string& check : checks())
    if (std::ranges::find(out, check) == out.end()) out.push_back(check);
  for (const std::string& effect : EffectRegistry::instance().names())
    if (std::ranges::find(out, effect) == out.end()) out.push_back(effect);
  return out;
}

std::string row_of(const std::string& head, const std::string& words) {
  return fmt::format("  {:<14}{}", head, wrapped(words, 16).substr(16));
}

// What a gate left here shows its checks over time.
const std::filesystem::path kPageOfLastRun = std::filesystem::path("forcegate-run") / "report.html";

std::string line_after(const std::string& term, const std::string& kind) {
  if (kind == "exit code") {
    if (term == "1") return "forcegate explain REJECT";
    if (term == "3") return "forcegate explain NO-DECISION";
    return term == "130" ? "forcegate recover --help" : "forcegate doctor";
  }
  if (term == "NO-DECISION") return "forcegate plan --help";
  if (kind == "header") return "forcegate export --help";
  if (kind == "figure" && (term == "ratio" || term == "%GRR")) return "forcegate report --help";
  return kind == "diagnosis" || kind == "figure" || kind == "form" || kind == "side" || kind == "effect" ? "forcegate diagnose --help" : "forcegate report --help";
}

// The terms of each kind on one line.
std::string topics() {
  std::string out = "Terms:\n", kind;
  std::vector<std::string> of_kind;
  const auto put = [&] {
    if (!of_kind.empty()) out += row_of(kind, join(of_kind, ", "));
    of_kind.clear();
  };
  for (const Explanation& e : explanations()) {
    if (e.kind != kind) put();
    kind = e.kind;
    of_kind.push_back(e.term);
  }
  put();
  return out + row_of("check", join(checks(), ", ")) + row_of("effect", join(EffectRegistry::instance().names(), ", "));
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
      console.print(row_of(e.term, e.meaning));
      add(e);
    }
    std::ranges::for_each(check_explanations(), add);
    for (const EffectKind& effect : EffectRegistry::instance().all()) add(explanation_of(effect));
    console.print("\n" + console.paint(Paint::strong, "check") + "\n" + row_of("", join(checks(), ", ")));
    console.print("\n" + console.paint(Paint::strong, "effect") + "\n" + row_of("", join(EffectRegistry::instance().names(), ", ")));
    console.print_json(document.dump(2));
    console.next("forcegate explain NO-DECISION");
    return kExitSuccess;
  }
  const std::string term(trim(in.text("TERM")));
  if (term.empty())
    return fail(ErrorCode::usage, "TERM is empty", "forcegate explain", "give a word of a report; \"forcegate explain\" lists all of them");
  const std::vector<Explanation> found = find_explanations(term);
  if (found.empty()) {
    const std::vector<std::string> known = terms();
    const bool number = term.find_first_not_of("0123456789") == std::string::npos;
    if (number) {
      std::vector<std::string> codes;
      std::ranges::copy_if(known, std::back_inserter(codes), [](const std::string& t) { return t.find_first_not_of("0123456789") == std::string::npos; });
      return fail(ErrorCode::usage, fmt::format("no verb ends with the code {}", term), "forcegate explain", "exit codes: " + join(codes, ", "));
    }
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
  const Explanation& last = found.back();
  std::error_code unknown;
  if (last.kind == "check" && std::filesystem::exists(kPageOfLastRun, unknown)) console.look_at(kPageOfLastRun.string());
  else console.next(line_after(last.term, last.kind));
  return kExitSuccess;
}

const Registration<Command> kRow{Command{
    .name = "explain",
    .group = "House",
    .summary = "what a verdict, a decision, an effect or an exit code means and what to do about it",
    .description =
        "Every word that a report uses for a verdict, a decision, a side, a figure or the one who must act, every exit code and every effect of the "
        "library with its forms, in one sentence, with what to do next. Without TERM: all of them.",
    .positionals = {{.name = "TERM",
                     .doc = "One of the terms above, in any case.",
                     .required = false,
                     .choices = terms,
                     .only_choices = false,
                     .list_choices = false}},
    .examples = {{"forcegate explain marginal", "Why a value inside its limit is not simply \"pass\":"},
                 {"forcegate explain creep", "What an effect does and what parts it from its look-alikes:"},
                 {"forcegate explain 4", "What a continuous integration should do after exit code 4:"}},
    .details = topics,
    .run = run,
}};

}  // namespace
}  // namespace forcegate
