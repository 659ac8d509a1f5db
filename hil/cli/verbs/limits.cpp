#include "hil/app/power/limits.h"

#include "hil/app/files/write_file.h"
#include "hil/base/utc_clock.h"
#include "hil/cli/command.h"
#include "hil/cli/parse.h"
#include "hil/cli/verbs/limits_line.h"
#include "hil/cli/verbs/rig_choice.h"

namespace forcegate {
namespace {

Result<int> run(const Invocation& in) {
  LimitsRequest request;
  request.firmware = in.text("FIRMWARE");
  request.plan = in.given("record") && !in.given("plan") ? "replay" : in.text("plan");
  request.only_cases = in.texts("case");
  FORCEGATE_TRY(const std::int64_t n, in.integer("count", 10, 100000));
  request.n = static_cast<std::size_t>(n);
  for (const std::string& record : in.texts("record")) request.records.emplace_back(record);
  for (const char* option : {"cal", "case", "map"})
    if (request.records.empty() && in.given(option))
      return fail(ErrorCode::usage, "limits of the emulated rig have no recordings to read with it", std::string("--") + option, "it is for --record FILE");
  FORCEGATE_TRY(request.map, column_map_lines(in));
  if (in.given("cal")) request.calibration_file = in.text("cal");
  FORCEGATE_TRY(request.first_seed, in.seed("first-seed"));
  FORCEGATE_TRY(const std::int64_t threads, in.integer("threads", 0, 1024));
  request.threads = static_cast<unsigned>(threads);
  request.date = utc_today();
  if (in.given("output")) FORCEGATE_CHECK_OK(check_limits_output(in.text("output"), request.plan));
  const auto made = derive_limits(request, in.console().progress_callback(), &in.interrupt_flag());
  in.console().end_progress();
  if (!made) return Unexpected(made.error());
  if (in.given("output")) FORCEGATE_CHECK_OK(write_file_atomically(in.text("output"), made_limits_text(*made)));
  in.console().print(write_limits(made->limits));
  in.console().notes(made->notes);
  in.console().print_json(made_limits_json(*made));
  std::string recorded;
  if (!request.records.empty()) recorded = " --record NEW.csv";  // none that the limits were made of: it passes by construction
  for (const std::string& name : request.only_cases) recorded += " --case " + shell_quoted(name);
  for (const std::string& word : in.texts("map")) recorded += " --map " + shell_quoted(word);
  if (in.given("cal")) recorded += " --cal " + file_quoted(in.text("cal"));
  in.console().next(in.given("output") ? line_after_limits(in, made->limits, in.text("output"), recorded)
                                       : in.command_line() + " -o limits.toml");
  return kExitSuccess;
}

const Registration<Command> kRow{Command{
    .name = "limits",
    .group = "Gate",
    .summary = "derive the limits of a plan from a known-good build",
    .description = "Plays every open-loop case of a plan on many specimens that belong to no panel, and "
                   "takes as limits of the errors of extrema what 99 % of specimens stay below with 95 % "
                   "confidence (below 299 of them: the largest), and 2 sd. The file says n, date, rig and the firmware it was made "
                   "with; it is "
                   "part of the goldens and changes only with a reason: -o refuses the file of a plan, forcegate bless writes it.",
    .positionals = {{.name = "FIRMWARE", .doc = "Known-good firmware image.", .names = Names::input}},
    .options =
        {{.name = "plan",
          .value_name = "PLAN",
          .doc = "Plan file, or the name of one in ci/plans; with --record it is `replay`, where none is given.",
          .fallback = "smoke",
          .names = Names::input},
         {.name = "count", .value_name = "N", .doc = "Specimens.", .fallback = "300"},
         {.name = "first-seed", .value_name = "N", .doc = "Seed of the first specimen.", .fallback = "1000"},
         {.name = "record",
          .value_name = "FILE",
          .doc = "Recording of a bench's repeatability run, at least five; then no rig is emulated.",
          .repeatable = true,
          .names = Names::input},
         {.name = "case", .value_name = "NAME", .doc = "Case of the plan that was recorded, where it has several.", .repeatable = true},
         map_row(),
         {.name = "cal", .value_name = "FILE", .doc = "Calibration of the specimen in the recordings.", .names = Names::input},
         {.name = "threads",
          .value_name = "N",
          .doc = "Worker processes at a time; 0: one per processor.",
          .fallback = "0"},
         {.name = "output", .value_name = "FILE", .doc = "Write the limits there.", .letter = 'o', .names = Names::file}},
    .examples =
        {{"forcegate limits good.so --record 1.csv --record 2.csv --record 3.csv --record 4.csv --record "
          "5.csv -o "
          "bench.toml",
          "Limits from a bench's own recordings, for gate --record new.csv --limits bench.toml:"},
         {"forcegate limits build/firmware/reference.native.so --plan nightly -o new.toml",
          "Limits of the nightly plan; forcegate bless new.toml puts them in force:"}},
    .run = run,
}};

}  // namespace
}  // namespace forcegate
