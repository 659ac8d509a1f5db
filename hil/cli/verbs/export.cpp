#include "hil/app/diagnose/what_next.h"
#include "hil/app/export/export.h"
#include "hil/app/files/beside_program.h"
#include "hil/app/files/find_plan.h"
#include "hil/app/files/own_file.h"

#include <cmath>
#include <filesystem>

#include "hil/cli/command.h"
#include "hil/cli/parse.h"
#include "hil/cli/verbs/campaign_options.h"
#include "hil/cli/verbs/force_row.h"

namespace forcegate {
namespace {

// The firmware around the header is built by a script of the source tree. Elsewhere the header is first held against recordings. The check has
// compiled it; where no source tree lies around the program, it is compiled with all warnings.
std::string line_after(const Invocation& in, const ExportResult& answer) {
  const std::string file = file_quoted(answer.header.string());
  std::error_code ignored;
  // the firmware of the source tree reads volts
  if (answer.input.empty() && std::filesystem::is_regular_file("ci/firmware", ignored)) return "ci/firmware " + file + " mine";
  if (in.given("fit") && !in.given("check")) return in.command_line() + " --check " + file_quoted(in.text("fit"));
  const std::filesystem::path script = program_folder() / ".." / "ci" / "firmware";
  if (answer.input.empty() && std::filesystem::is_regular_file(script, ignored))
    return file_quoted(path_from_here(script.lexically_normal())) + " " + file + " mine firmware-mine";
  return "cc -std=c11 -Wall -fsyntax-only -x c " + file;
}

// Gain and offset that are not those of the records: a model of theirs.
std::string refit_on_checked(const Invocation& in) {
  std::string out = "forcegate fit " + file_quoted(in.text("check")) + " --model " + file_quoted(in.text("MODEL"));
  for (const std::string& map : in.texts("map")) out += " --map " + shell_quoted(map);
  if (in.given("divider")) out += " --divider " + shell_quoted(in.text("divider"));
  if (in.given("late")) out += " --late " + in.text("late");
  return out + " -o " + file_quoted(better_model_name(in.text("MODEL")));
}

Result<int> run(const Invocation& in) {
  ExportRequest request;
  request.model = in.text("MODEL");
  request.header = in.text("c");
  request.plan = in.text("plan");
  const bool without_plan = !in.given("plan") && !find_plan(request.plan);
  if (without_plan) request.plan = "none";
  FORCEGATE_TRY(request.rate_Hz, in.number("rate", 1.0, 1e6));
  if (in.given("reference-temperature")) {
    FORCEGATE_TRY(request.reference_temperature_C, in.number("reference-temperature", -273.0, 1000.0));
  }
  FORCEGATE_TRY(const double late_s, in.number("late", -kLatest_s, kLatest_s));
  const auto campaign = [&](const char* option) {
    std::optional<CampaignRequest> out;
    if (!in.given(option)) return out;
    out.emplace();
    out->campaign = in.text(option);
    out->maps = in.texts("map");
    out->divider = in.text("divider");
    out->late_s = late_s;
    return out;
  };
  request.check = campaign("check");
  request.fit = campaign("fit");
  if (in.given("output") && !in.given("fit"))
    return fail(ErrorCode::usage, "-o names the model file that --fit writes", "-o " + in.text("output"), "the header is --c FILE");
  request.fitted = in.text("output");
  if (!in.flag("force")) {
    FORCEGATE_CHECK_OK(check_own_file(in.text("c"), "Made by forcegate export"));
    FORCEGATE_CHECK_OK(check_own_file(in.text("output"), kMarkOfModel));
  }
  FORCEGATE_TRY(ExportResult answer, export_model(request));
  const std::string no_plan = "there is no plan " + in.text("plan") + " here, whose calibration would be taken back: the firmware must calibrate by the model, as with --plan none";
  if (without_plan) in.console().note(no_plan);
  in.console().print(export_text(answer, !in.console().quiet()));
  if (without_plan) answer.notes.push_back(no_plan);
  in.console().print_json(export_json(answer));
  if (answer.check && !objections(*answer.check).empty()) {
    // no diagnosis tells more of it, and one whose model leaves nothing would lead back here
    in.console().next(differs_from_model(*answer.check) ? "forcegate explain \"not undone\""
                      : is_off_in_gain(*answer.check) && objections(*answer.check).size() == 1 ? refit_on_checked(in)
                                                                                             : "forcegate explain \"no gain\"");
    return kExitReject;
  }
  if (!nothing_gained(answer).empty()) {
    in.console().next("forcegate explain \"no gain\"");
    return kExitSuccess;
  }
  in.console().next(answer.header.empty() ? in.command_line() + " --c comp.h" : line_after(in, answer));
  return kExitSuccess;
}

const Registration<Command> kRow{Command{
    .name = "export",
    .group = "Diagnosis",
    .summary = "write a model's inverse as a C header for firmware",
    .description =
        "Turns a fitted model with its added effects into one C11 header: voltage in, force out. No heap, no libm, no double, a "
        "fixed bound on the work of a sample, which stands in the header's comment beside parameters and provenance. Hysteresis, "
        "creep, lag, static curves, dead zone, thermal effects and your own equations can be inverted where a tenth of a sudden change of force reaches "
        "the output at --rate; what cannot be is refused by name, with the reason.\n\n"
        "A calibration by straight line and decay is wrong on a sensor that creeps. What the calibration of --plan makes of this "
        "sensor is simulated, and the header takes it back.\n\n"
        "The diagnosis lets every record have its own gain and decay; a firmware cannot. --fit refits one law for all records, "
        "with the form of each effect that predicts left-out records best, of those that can be undone.\n\n"
        "Before it is written the header is built with the host's compiler and held against the model's own inverse on swings over the model's "
        "range; one that does not undo the model is refused. The header takes what the model takes: volts, or the unit that the model file names.\n\n"
        "--check builds the header with the host's compiler and replays a campaign: how far it is from the model's own inverse, "
        "in newtons and in LSB, and what it does to the recorded samples of the voltage, noise included. Where the plan calibrates on the bench, the best straight line "
        "over the records is taken first, as that does; with --plan none gain and offset of the model count. The other error is told "
        "too. Of each record the first 600 s are replayed. Where the header is far from the model's inverse, makes the error larger (by more "
        "than 2 %, each with its best line), or has by --plan none a gain and an offset that are not those of the records, a warning says so and the exit "
        "code is 1. Where the error is as large as without the header or up to 2 % larger, a warning says so and the exit code is 0.",
    .positionals = {{.name = "MODEL", .doc = "Model file, or flexiforce, fsr.", .names = Names::input}},
    .options =
        {{.name = "c", .value_name = "FILE", .doc = "Header to write.", .names = Names::file},
         {.name = "fit",
          .value_name = "CAMPAIGN",
          .doc = "Refit one law for all records of this campaign first, as a firmware has it.",
          .names = Names::campaign},
         {.name = "output", .value_name = "FILE", .doc = "Model file to write after --fit.", .letter = 'o', .names = Names::file},
         {.name = "check",
          .value_name = "CAMPAIGN",
          .doc = "Build the header and replay this campaign through it.",
          .names = Names::campaign},
         {.name = "rate", .value_name = "HZ", .doc = "Samples a second in the firmware.", .fallback = "1000"},
         {.name = "plan",
          .value_name = "PLAN",
          .doc = "Whose calibration is taken back; none, and where nobody names one and there are no plans: the firmware calibrates by the model.",
          .fallback = "smoke",
          .names = Names::input},
         {.name = "reference-temperature",
          .value_name = "DEGC",
          .doc = "Where a thermal effect is zero, for a model file that does not say; forcegate fit and --fit write it."},
         divider_option(),
         {.name = "late", .value_name = "S", .doc = "The output of the campaign is so late behind the force, seconds: it is set as much earlier.", .fallback = "0"},
         {.name = "map",
          .value_name = "COLUMN=NAME",
          .doc = "Foreign column of the campaign.",
          .repeatable = true},
         force_row()},
    .examples = {{"forcegate export better.toml --fit m7 --c comp.h --check m7",
                  "Refit it, write it, build it, replay the campaign:"},
                 {"forcegate export flexiforce --c comp.h",
                  "The header of a model as it is; ci/firmware comp.h NAME builds the firmware around it:"}},
    .exit_codes = {kExitSuccess, kExitReject, kExitUsage},
    .reject_text = "The header is written, and on the records that it was checked on it does not take back what it should; the objections are printed.",
    .run = run,
}};

}  // namespace
}  // namespace forcegate
