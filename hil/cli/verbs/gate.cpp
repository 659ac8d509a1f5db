#include "hil/app/gate/gate.h"
#include "hil/app/gate/weight_gate.h"

#include <charconv>

#include "hil/base/text.h"
#include "hil/base/utc_clock.h"
#include "hil/cli/command.h"
#include "hil/cli/verbs/rig_choice.h"
#include "hil/interface/dut.h"
#include "hil/interface/reporter.h"
#include "hil/report/console.h"

namespace forcegate {
namespace {

std::vector<std::string> lanes() { return Registry<LaneKind>::instance().names(); }
std::vector<std::string> levels() { return {"nominal", "static", "identified"}; }

// "reference_saturated=2.0". No fault has a magnitude that goes without saying: 0 is a sound rig for most.
Result<std::map<std::string, double>> faults_of(const std::vector<std::string>& words) {
  std::map<std::string, double> faults;
  for (const std::string& word : words) {
    const std::size_t equals = word.find('=');
    double magnitude = 0.0;
    const char* begin = word.data() + (equals == std::string::npos ? word.size() : equals + 1);
    const char* end = word.data() + word.size();
    const auto [stop, error] = std::from_chars(begin, end, magnitude);
    if (error != std::errc{} || stop != end || begin == end)
      return fail(ErrorCode::usage, "'" + printable_utf8(word) + "' is not NAME=VALUE", "--fault",
                  "for example --fault reference_saturated=2.0");
    faults[word.substr(0, equals)] = magnitude;
  }
  return faults;
}

Result<int> run(const Invocation& in) {
  GateRequest request;
  request.firmware = in.text("FIRMWARE");
  request.plan = in.text("plan");
  request.lane = in.text("lane");
  FORCEGATE_TRY(RigChoice rig, rig_choice(in));
  FORCEGATE_CHECK_OK(take_recording(in, rig));
  request.rig = std::move(rig.rig);
  request.rig_options = std::move(rig.options);
  FORCEGATE_TRY(request.lane_options, named_values(in, "lane-option"));
  if (request.rig == "replay" && !in.given("plan")) request.plan = "replay";
  if (request.lane == "tick" && !in.given("plan")) request.plan = "tick";
  if (in.given("accepted")) request.accepted = in.text("accepted");
  if (in.given("limits")) request.limits_file = in.text("limits");
  if (in.given("cal")) request.calibration_file = in.text("cal");
  if (in.given("calibration")) {
    const std::string level = in.text("calibration");
    request.level = level == "nominal"  ? CalibrationLevel::nominal
                    : level == "static" ? CalibrationLevel::statical
                                        : CalibrationLevel::identified;
  }
  if (in.given("seed")) {
    FORCEGATE_TRY(request.seed, in.seed("seed"));
  }
  FORCEGATE_TRY(request.faults, faults_of(in.texts("fault")));
  request.only_cases = in.texts("case");
  request.panel = in.texts("specimen");
  FORCEGATE_TRY(const std::int64_t threads, in.integer("threads", 0, 1024));
  request.threads = static_cast<unsigned>(threads);
  request.keep = in.flag("keep");
  request.started_at = utc_now();
  if (in.given("golden")) request.goldens = in.text("golden");
  if (in.given("waivers")) request.waivers = in.text("waivers");
  request.today = in.given("today") ? in.text("today") : request.started_at.substr(0, 10);
  if (request.rig == "bench") request.rig_options["today"] = request.today;
  request.output = in.text("output");
  request.command_line = in.command_line();

  Console& console = in.console();
  FORCEGATE_TRY(const bool weights, is_weight_plan(request.plan));
  const auto made = weights ? weight_gate(request, console.progress_callback(), &in.interrupt_flag())
                            : gate(request, console.progress_callback(), &in.interrupt_flag());
  console.end_progress();
  if (!made) return Unexpected(made.error());
  console.print(render_console(*made, {.colour = console.color(), .notes = !console.quiet()}));
  if (const ReporterKind* json = Registry<ReporterKind>::instance().find("json"))
    console.print_json(json->render(*made));
  if (made->not_written) {
    console.error_beside(*made->not_written);
    return made->decision.exit_code != kExitSuccess ? made->decision.exit_code : exit_code_of(made->not_written->code);
  }
  if (made->decision.exit_code == kExitInterrupted)
    console.next(in.command_line());
  else
    console.look_at((request.output / "report.html").string());
  return made->decision.exit_code;
}

const Registration<Command> kRow{Command{
    .name = "gate",
    .group = "Gate",
    .summary = "accept or reject a firmware build",
    .description =
        "Plays the force profiles of a plan on a rig, lets the firmware image turn the sensor's raw codes "
        "into force, and "
        "decides: ACCEPT, REJECT or NO-DECISION with the cause and who must act. The rig is checked before "
        "the "
        "firmware is judged, and every value carries its uncertainty (docs/gate.md).\n\nThe lane follows "
        "from the "
        "image: a shared object runs natively in a watched process, an ARM ELF in qemu-system-arm. The "
        "specimen is "
        "calibrated first; --calibration says how far.\n\nThe folder of the result appears whole at the end, "
        "result.json last in it. The same command with the same seed gives the same bytes except one time "
        "stamp.",
    .positionals = {{.name = "FIRMWARE", .doc = "Firmware image (ELF).", .names = Names::input}},
    .options = joined(
        {{{.name = "plan",
           .value_name = "PLAN",
           .doc = "Plan file, or the name of one in ci/plans; with --lane tick it is `tick`, with --record `replay`, where none is given.",
           .fallback = "smoke",
           .names = Names::input},
          {.name = "lane",
           .value_name = "LANE",
           .doc = "How the image runs; default: by its content.",
           .choices = lanes}},
         rig_rows(),
         {{.name = "record",
           .value_name = "FILE",
           .doc = "Recording to judge on (rig replay), CSV, HDF5 or MAT: columns t_s, U_V, F_ref_N.",
           .names = Names::input},
          map_row(),
          {.name = "cal",
           .value_name = "FILE",
           .doc = "Calibration of the specimen instead of measuring it.",
           .names = Names::input},
          {.name = "calibration",
           .value_name = "LEVEL",
           .doc = "How much of the specimen is told to the firmware; default: the plan's.",
           .choices = levels},
          {.name = "limits",
           .value_name = "FILE",
           .doc = "Limits of forcegate limits instead of the plan's, for its open-loop cases.",
           .names = Names::input},
          {.name = "accepted",
           .value_name = "IMAGE|RUN",
           .doc = "Build to be no worse than: its image, or the folder of its run under the same plan and "
                  "seed.", .names = Names::input},
          {.name = "seed", .value_name = "N", .doc = "Seed of the emulated rig; default: the plan's."},
          {.name = "fault",
           .value_name = "NAME=VALUE",
           .doc = "Fault of the rig to inject.",
           .repeatable = true},
          {.name = "case", .value_name = "NAME", .doc = "Only this case of the plan.", .repeatable = true},
          {.name = "specimen",
           .value_name = "NAME",
           .doc = "This specimen instead of the plan's.",
           .repeatable = true},
          {.name = "lane-option",
           .value_name = "NAME=VALUE",
           .doc = "Option of the lane.",
           .repeatable = true},
          {.name = "threads",
           .value_name = "N",
           .doc = "Worker processes at a time; 0: one per processor.",
           .fallback = "0"},
          {.name = "golden",
           .value_name = "FOLDER",
           .doc = "Hold every case against the golden traces of this folder (forcegate bless makes them).",
           .names = Names::input},
          {.name = "waivers",
           .value_name = "FILE",
           .doc = "Findings that somebody answers for until a day (docs/trust.md).",
           .names = Names::input},
          {.name = "today", .value_name = "DATE", .doc = "Day against which waivers expire; default: today."},
          {.name = "keep",
           .value_name = "",
           .doc = "Keep the samples of every record as HDF5, not only of those in doubt; a bench always does."},
          {.name = "output",
           .value_name = "FOLDER",
           .doc = "Folder of the result.",
           .fallback = "forcegate-run",
           .letter = 'o',
           .names = Names::folder}}}),
    .examples = {{"forcegate gate build/firmware/reference-m4f.block.elf",
                  "Is the image that ships any good, in a few seconds?"},
                 {"forcegate gate build/firmware/reference.native.so --plan nightly -o run",
                  "The whole nightly plan:"},
                 {"forcegate gate new.elf --accepted old.elf",
                  "Is it any worse than the build in the field?"},
                 {"forcegate gate build/firmware/reference.native.so --golden golden/traces/smoke",
                  "Against golden traces, with the margin of every sample in golden/*.csv:"},
                 {"forcegate gate build/firmware/reference-m4f.block.elf --lane tick",
                  "Worst-case instructions of a sample, stack, RAM and flash:"},
                 {"forcegate gate build/firmware/reference.native.so --record run.csv --cal cal.toml",
                  "On a recording:"},
                 {"forcegate gate build/firmware/reference.uart.elf --rig rigs/twin.toml --plan twin",
                  "Through the real adapters, on wire-level twins of the instruments:"},
                 {"forcegate gate build/firmware/two-variable.native.so --plan capacitance-gate",
                  "A firmware that reads conductance and capacitance:"},
                 {"forcegate gate build/firmware/reference.native.so --fault reference_saturated=2.0",
                  "What a broken reference looks like:"}},
    .exit_codes = {kExitSuccess, kExitReject, kExitUsage, kExitNoDecision, kExitRigFault, kExitSafetyStop,
                   kExitInternal, kExitInterrupted},
    .run = run,
}};

}  // namespace
}  // namespace forcegate
