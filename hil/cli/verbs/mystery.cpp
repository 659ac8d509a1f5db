#include "hil/app/mystery/mystery.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "hil/base/plain_number.h"
#include "hil/base/text.h"
#include "hil/cli/command.h"
#include "hil/cli/parse.h"

namespace forcegate {
namespace {

std::vector<std::string> strengths() { return {"weak", "medium", "strong"}; }

Result<int> list(const Invocation& in) {
  const std::vector<std::string> names = mystery_effect_names();
  in.console().print(join(names, "\n"));
  in.console().print_json(nlohmann::ordered_json{{"format", 1}, {"effects", names}}.dump(2));
  return kExitSuccess;
}

Result<int> run(const Invocation& in) {
  if (in.flag("list")) return list(in);
  if (!in.given("DIR"))
    return fail(ErrorCode::usage, "DIR to write is missing", "forcegate mystery",
                "forcegate mystery --seed 7 m7");
  MysteryRequest request;
  FORCEGATE_TRY(request.seed, in.seed("seed"));
  FORCEGATE_TRY(request.minutes, in.number("minutes", 1.0, 60.0));
  request.folder = in.text("DIR");
  request.effect = in.text("effect");
  request.strength = in.text("strength");
  request.overwrite = in.flag("force");
  request.interrupted = [&in] { return in.interrupt_flag().load(); };
  if (in.given("pair")) request.pair = split(in.text("pair"), ',');

  Console& console = in.console();
  FORCEGATE_TRY(const MysteryResult made, make_mystery(request, [&](const std::string& commitment) {
                  console.print("commitment " + commitment + "  (SHA-256 of the sealed truth)");
                  console.flush();
                }));
  console.print(fmt::format("{}: {}, {}, {:.0f} minutes of rig time", made.folder.string(),
                            counted(made.records, "record"), counted(made.rows, "sample"), made.campaign_minutes));
  console.print("with an answer: forcegate reveal " + file_quoted(made.folder.string()) + " --effect NAME");
  console.print_json(nlohmann::ordered_json{{"format", 1},
                                            {"folder", made.folder.string()},
                                            {"seed", request.seed},
                                            {"commitment_sha256", made.commitment},
                                            {"records", made.records},
                                            {"rows", made.rows},
                                            {"campaign_minutes", made.campaign_minutes}}
                         .dump(2));
  console.next("forcegate diagnose " + file_quoted(made.folder.string()));
  return kExitSuccess;
}

const Registration<Command> kRow{Command{
    .name = "mystery",
    .group = "Diagnosis",
    .summary = "make a campaign with a hidden physical effect to find",
    .description =
        "Writes a campaign (campaign.json and one CSV per record) of an emulated FlexiForce bench in which "
        "one effect, "
        "two, a foreign one or none at all is hidden. Bench, noise, repeatability and what the lab wrote "
        "down are drawn "
        "from the seed.\n\nThe truth is sealed in DIR/sealed_truth.json. Its SHA-256 is printed before the "
        "data are "
        "written: keep it, and `forcegate reveal` proves that the truth was not changed afterwards (with --json it stands in the answer). "
        "What is interrupted leaves nothing behind, and the same command works again.",
    .positionals = {{.name = "DIR", .doc = "Folder to write.", .required = false, .names = Names::folder}},
    .options =
        {{.name = "seed", .value_name = "N", .doc = "Seed of everything.", .fallback = "1"},
         {.name = "effect",
          .value_name = "NAME",
          .doc = "What to hide; drawn from the seed when not given.",
          .choices = mystery_effect_names},
         {.name = "pair", .value_name = "A,B", .doc = "Hide two effects."},
         {.name = "strength",
          .value_name = "TIER",
          .doc = "How much of it; drawn when not given.",
          .choices = strengths},
         {.name = "minutes", .value_name = "MIN", .doc = "Length of the two long sines.", .fallback = "20"},
         {.name = "force", .value_name = "", .doc = "Overwrite a campaign that is there."},
         {.name = "list", .value_name = "", .doc = "Names of the effects that can be hidden."}},
    .examples = {{"forcegate mystery --seed 7 m7", "Something is hidden in m7, or nothing:"},
                 {"forcegate mystery --seed 8 --effect hysteresis --strength medium m8",
                  "To see what a loop looks like:"}},
    .run = run,
}};

}  // namespace
}  // namespace forcegate
