#include <filesystem>

#include "hil/app/diagnose/next_run.h"
#include "hil/app/mystery/mystery.h"
#include "hil/cli/command.h"
#include "hil/cli/parse.h"
#include "hil/cli/verbs/campaign_options.h"
#include "hil/cli/verbs/next_line.h"
#include "hil/cli/verbs/rig_choice.h"
#include "hil/interface/rig.h"

namespace forcegate {
namespace {

std::string given_words(const Invocation& in) { return campaign_words(in, in.text("CAMPAIGN")) + model_words(in); }

// Where nothing is to be measured nobody else would read these names.
Result<void> check_names(const Invocation& in) {
  const std::string rig = in.text("rig");
  if (in.given("rig") && !rig.ends_with(".toml")) FORCEGATE_CHECK_OK(find_rig(rig));
  std::vector<std::string> files = in.texts("record");
  if (rig.ends_with(".toml")) files.push_back(rig);
  std::error_code unknown;
  for (const std::string& file : files)
    if (!std::filesystem::exists(file, unknown)) return fail(ErrorCode::io, "there is no such file", file, "check the name");
  return {};
}

// Nothing is to be measured: an answer, whatever it was asked for.
int settled(const Invocation& in, const Diagnosis& diagnosis) {
  in.console().print(next_text(diagnosis));
  if (in.flag("run")) in.console().print("nothing was played");
  else if (in.given("output")) in.console().print("nothing was written to " + in.text("output"));
  in.console().print_json(next_json(diagnosis));
  in.console().next(line_after_diagnosis(in, diagnosis, {.campaign = in.text("CAMPAIGN"), .model = named_model(in), .experiment = true}));
  return kExitSuccess;
}

Result<int> play(const Invocation& in) {
  NextRunRequest request;
  FORCEGATE_TRY(request.campaign, campaign_request(in, in.text("CAMPAIGN"), named_model(in)));
  FORCEGATE_TRY(RigChoice rig, rig_choice(in));
  request.bench.rig = std::move(rig.rig);
  request.bench.rig_options = std::move(rig.options);
  for (const std::string& file : in.texts("record")) request.recorded.push_back(file);
  if (request.bench.rig == "replay" && request.recorded.empty())
    return fail(ErrorCode::usage, "the rig replay needs recordings", "--record",
                "give each of them with --record FILE");
  if (in.given("specimen")) request.bench.specimen = in.text("specimen");
  if (in.given("seed")) {
    FORCEGATE_TRY(request.bench.seed, in.seed("seed"));
  }
  for (const char* option : {"rig", "rig-option", "arm", "specimen", "seed"})
    if (in.given(option)) request.named.push_back(std::string("--") + option);
  request.output = in.text("output");
  const auto made = next_run(request, in.console().progress_callback(), &in.interrupt_flag());
  in.console().end_progress();
  if (!made) return Unexpected(made.error());
  if (made->planned.segments.empty()) return settled(in, made->before);
  in.console().print(next_run_text(*made));
  in.console().notes(made->after.notes);
  in.console().print_json(next_run_json(*made));
  in.console().next(line_after_diagnosis(in, made->after, {.campaign = made->folder.string(), .model = named_model(in)}));
  return kExitSuccess;
}

// Forces as files, for who records them by hand.
Result<int> write(const Invocation& in, const Diagnosis& diagnosis) {
  FORCEGATE_TRY(const std::vector<std::filesystem::path> files, write_profiles(diagnosis.next_experiment, in.text("output")));
  std::string text;
  for (const std::filesystem::path& file : files) text += "wrote " + file.string() + "\n";
  in.console().print(text + "record each of them on your rig, then give the recordings: forcegate next " + given_words(in) +
                     " --run --record FILE -o " + file_quoted(in.text("output")));
  in.console().print_json(next_json(diagnosis));
  in.console().next("forcegate stimulus replay path=" + file_quoted(files.front().string()) + " --plot " +
                    file_quoted(std::filesystem::path(files.front()).replace_extension(".svg").string()));
  return kExitSuccess;
}

Result<int> run(const Invocation& in) {
  FORCEGATE_CHECK_OK(check_names(in));
  if (in.flag("run")) return play(in);
  FORCEGATE_TRY(const CampaignRequest request, campaign_request(in, in.text("CAMPAIGN"), named_model(in)));
  FORCEGATE_TRY(const Diagnosis diagnosis, diagnose_request(request));
  const NextExperiment& answer = diagnosis.next_experiment;
  if (answer.segments.empty()) return settled(in, diagnosis);
  in.console().print(next_text(diagnosis, in.given("output") ? std::filesystem::path(in.text("output")) : std::filesystem::path()));
  if (in.given("output")) return write(in, diagnosis);
  in.console().print_json(next_json(diagnosis));
  // a rig that was named, or the sensor of a mystery, can play them; the emulated rig's own sensor is not that of the records
  if (in.given("record"))
    in.console().next(in.command_line() + " --run");
  else if (is_playable(answer) && is_mystery(in.text("CAMPAIGN")))
    in.console().next("forcegate next " + given_words(in) + " --run");
  else if (is_playable(answer) && (in.given("rig") || in.given("rig-option")))
    in.console().next(in.command_line() + " --run");
  else
    in.console().next("forcegate next " + given_words(in) + " -o " + file_quoted(next_folder(in.text("CAMPAIGN")).string()));
  return kExitSuccess;
}

const Registration<Command> kRow{Command{
    .name = "next",
    .group = "Diagnosis",
    .summary = "say what to measure next so that look-alike effects part",
    .description =
        "Plans one to four pieces of rig time, the best per minute, that separate the effects which compete "
        "for the explanation; each is simulated for all rivals and the rival is refitted inside.\n\n"
        "--run plays them on a rig, appends the records to a copy of the campaign (nothing is overwritten) "
        "and diagnoses again: "
        "odds before, expected and now. With --record the segments are picked from files that you recorded; -o FOLDER without "
        "--run writes the forces to record. "
        "The sensor of a mystery is played on as long as its seal lies beside it, behind all that was played on it before; nothing is revealed.",
    .positionals = {campaign_positional()},
    .options = joined({{model_row()},
                       campaign_rows(),
                       {{.name = "run", .value_name = "", .doc = "Play them and diagnose again."}},
                       rig_rows(),
                       {{.name = "record",
                         .value_name = "FILE",
                         .doc = "A recording that may be one of the segments (rig replay).",
                         .repeatable = true,
                         .names = Names::input},
                        {.name = "specimen",
                         .value_name = "NAME",
                         .doc = "Which sensor lies on the bench; default: the one of the campaign, where it was recorded on this rig, else q50."},
                        {.name = "seed",
                         .value_name = "N",
                         .doc = "Seed of the emulated rig; default: that of the campaign, where it was recorded there, else 1."},
                        {.name = "output",
                         .value_name = "FOLDER",
                         .doc = "New campaign, default: CAMPAIGN-next; without --run the forces to record are written there.",
                         .letter = 'o',
                         .names = Names::records}}}),
    .examples = {{"forcegate next m7", "Which records would settle it:"},
                 {"forcegate next mine --run --rig-option hidden=creep:strong",
                  "Play them on the emulated rig and ask again:"}},
    .run = run,
}};

}  // namespace
}  // namespace forcegate
