#include "hil/app/recording/record.h"

#include <fmt/format.h>

#include "hil/base/plain_number.h"
#include "hil/cli/command.h"
#include "hil/cli/parse.h"
#include "hil/cli/verbs/rig_choice.h"

namespace forcegate {
namespace {

Result<int> run(const Invocation& in) {
  RecordRequest request;
  request.plan = in.text("plan");
  request.only_cases = in.texts("case");
  request.output = in.text("output");
  request.go_on = in.flag("continue");
  FORCEGATE_TRY(RigChoice rig, rig_choice(in));
  request.bench.rig = std::move(rig.rig);
  request.bench.rig_options = std::move(rig.options);
  request.bench.specimen = in.text("specimen");
  FORCEGATE_TRY(request.bench.seed, in.seed("seed"));
  FORCEGATE_TRY(request.bench.rate_Hz, in.number("rate", 1.0, 1e5));
  const auto made = record(request, in.console().progress_callback(), &in.interrupt_flag());
  in.console().end_progress();
  if (!made) return Unexpected(made.error());
  std::string text = fmt::format("{}: {}, {:.0f} min of rig time without rests{}\n", made->folder.string(), counted(made->files.size(), "record"), made->rig_minutes,
                                 made->were_there > 0 ? fmt::format(", beside {} that were there", made->were_there) : "");
  for (const RecordedFile& f : made->files)
    text += fmt::format("  {:<32} {:>6.0f} s {:>8} rows\n", f.file, f.duration_s, f.rows);
  in.console().print(text);
  in.console().notes(made->notes);
  in.console().print_json(record_json(*made));
  in.console().next("forcegate diagnose " + file_quoted(made->folder.string()));
  return kExitSuccess;
}

const Registration<Command> kRow{Command{
    .name = "record",
    .group = "Diagnosis",
    .summary = "record a campaign of one sensor on a rig",
    .description = "Plays the open-loop profiles of a plan on a rig, without any firmware, and writes what "
                   "the reference cell and the "
                   "sensor said: one CSV for each record and campaign.json (docs/campaign.md). The rig "
                   "checks itself around every "
                   "record; what is recorded stays when a later record fails, and --continue records the others. The plan `campaign` holds what "
                   "a diagnosis needs: slow "
                   "triangles at two speeds, long holds, minor loops, sines, a sweep.",
    .options = joined(
        {{{.name = "plan",
           .value_name = "PLAN",
           .doc = "Plan file, or the name of one in ci/plans.",
           .fallback = "campaign",
           .names = Names::input},
          {.name = "case", .value_name = "NAME", .doc = "Only this case of the plan.", .repeatable = true}},
         rig_rows(),
         {{.name = "specimen",
           .value_name = "NAME",
           .doc = "Which sensor lies on the bench.",
           .fallback = "q50"},
          {.name = "seed", .value_name = "N", .doc = "Seed of the emulated rig.", .fallback = "1"},
          {.name = "rate", .value_name = "HZ", .doc = "Rows a second in the files; the nearest that whole samples of the rig give.", .fallback = "200"},
          {.name = "continue", .value_name = "", .doc = "Record what is missing of a campaign that this command began and did not end."},
          {.name = "output",
           .value_name = "FOLDER",
           .doc = "Folder of the campaign.",
           .required = true,
           .letter = 'o',
           .names = Names::folder}}}),
    .examples = {{"forcegate record --specimen q50 -o mine", "A campaign on the emulated rig:"},
                 {"forcegate record --rig-option hidden=creep:strong -o creeping",
                  "A sensor that has more than the model knows:"}},
    .exit_codes = {kExitSuccess, kExitUsage, kExitRigFault, kExitSafetyStop, kExitInterrupted},
    .run = run,
}};

}  // namespace
}  // namespace forcegate
