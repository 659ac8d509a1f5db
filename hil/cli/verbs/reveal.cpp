#include "hil/app/mystery/reveal.h"

#include <nlohmann/json.hpp>

#include "hil/cli/command.h"
#include "hil/cli/parse.h"

namespace forcegate {
namespace {

using Json = nlohmann::ordered_json;

Json score_json(const RevealResult& result) {
  if (!result.score) return nullptr;
  const Score& s = *result.score;
  Json j = {{"right", result.right},
            {"sentence", result.sentence},
            {"rank", s.rank},
            {"named", s.named},
            {"look_alike", s.look_alike},
            {"side_right", s.side_right},
            {"false_claims", s.false_claims}};
  const Answer& answer = *result.answer;
  if (answer.error_before) j["error_before_V"] = *answer.error_before;
  if (answer.error_after) j["error_after_V"] = *answer.error_after;
  if (answer.force_error_before) j["force_error_before_N"] = *answer.force_error_before;
  if (answer.force_error_after) j["force_error_after_N"] = *answer.force_error_after;
  return j;
}

Result<int> run(const Invocation& in) {
  RevealRequest request{in.text("DIR"), in.text("answer"), in.text("effect")};
  FORCEGATE_TRY(const RevealResult result, reveal(request));
  Console& console = in.console();
  console.print("commitment " + result.commitment + "  fits the sealed truth");
  std::string text = truth_text(result.truth);
  if (!text.empty() && text.back() == '\n') text.pop_back();
  console.print(text);
  if (result.score) console.print(console.paint(result.right ? Paint::pass : Paint::fail, result.sentence));
  console.print_json(Json{{"format", 1},
                          {"commitment_sha256", result.commitment},
                          {"truth", Json::parse(result.truth_json)},
                          {"score", score_json(result)}}
                         .dump(2));
  if (!result.score)
    console.next("forcegate diagnose " + file_quoted(in.text("DIR")) + " --json > answer.json");
  else
    console.next("forcegate mystery --help");
  return kExitSuccess;
}

const Registration<Command> kRow{Command{
    .name = "reveal",
    .group = "Diagnosis",
    .summary = "open the sealed truth of a mystery and score an answer",
    .description = "Opens DIR/sealed_truth.json, checks it against the commitment that `forcegate mystery` "
                   "printed, says what "
                   "was hidden and how large it was in the recorded channels, and scores an answer: a name, "
                   "or the JSON of "
                   "`forcegate diagnose`. Of such an answer it says how far the held-out error fell; which share of what "
                   "could be reduced that is, only `forcegate league` knows, for it makes the same records without the "
                   "effect.",
    .positionals = {{.name = "DIR", .doc = "Folder of the mystery.", .names = Names::input}},
    .options = {{.name = "answer", .value_name = "FILE", .doc = "Answer of `forcegate diagnose DIR --json`.", .names = Names::input},
                {.name = "effect",
                 .value_name = "NAME",
                 .doc = "Your own answer: an effect's name, none or unknown."}},
    .examples = {{"forcegate reveal m7 --effect hysteresis", "Was it hysteresis?"},
                 {"forcegate reveal m7 --answer answer.json", "Did the engine find it?"}},
    .run = run,
}};

}  // namespace
}  // namespace forcegate
