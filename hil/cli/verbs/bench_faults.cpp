#include "hil/app/bench/fault_matrix.h"

#include <fmt/format.h>

#include <algorithm>

#include "hil/cli/command.h"
#include "hil/cli/parse.h"

namespace forcegate {
namespace {

std::vector<std::string> names() {
  std::vector<std::string> out;
  for (const FaultScenario& s : fault_scenarios())
    if (out.empty() || out.back() != s.name) out.push_back(s.name);
  return out;
}

// The report of one row: one that is wrong, else the first.
std::string line_that_shows(const Invocation& in, const FaultMatrix& matrix) {
  auto row = std::ranges::find_if(matrix.rows, [](const FaultRow& r) { return !r.wrong.empty(); });
  if (row == matrix.rows.end()) row = matrix.rows.begin();
  return "forcegate gate " + file_quoted(in.text("FIRMWARE")) + " --plan " + file_quoted(in.text("plan")) + " --fault " +
         shell_quoted(fmt::format("{}={}", row->scenario.name, row->scenario.magnitude)) + " -o faulty";
}

Result<int> run(const Invocation& in) {
  FaultMatrixRequest request;
  request.good = in.text("FIRMWARE");
  if (in.given("bad")) request.bad = in.text("bad");
  for (const std::string& path : in.texts("runaway")) request.runaway.emplace_back(path);
  request.plan = in.text("plan");
  request.only = in.texts("fault");
  FORCEGATE_TRY(const std::int64_t threads, in.integer("threads", 0, 1024));
  request.threads = static_cast<unsigned>(threads);
  const auto matrix = fault_matrix(request, in.console().progress_callback(), &in.interrupt_flag());
  in.console().end_progress();
  if (!matrix) return Unexpected(matrix.error());
  in.console().print(fault_matrix_text(*matrix));
  in.console().print_json(fault_matrix_json(*matrix));
  if (!matrix->rows.empty()) in.console().next(line_that_shows(in, *matrix));
  return matrix->wrong() == 0 ? kExitSuccess : kExitInternal;
}

const Registration<Command> kRow{Command{
    .name = "bench faults",
    .group = "Bench",
    .summary = "show that no fault of the rig accepts or rejects a build",
    .description =
        "Injects every fault of reference, motor, spring, sensor, converter, clock, link and board into the emulated rig, "
        "one after the other, and gates a good build and a bad one on it. A row is wrong when the fault rejects the good "
        "build, accepts any build, goes unseen although it is large, or when the wrong party is blamed. Faults too small to "
        "be seen may pass when they cannot tip a verdict. First the sound rig must accept the good build, else exit code 2.\n\nExit code 6 when a row is wrong: that is a defect of Forcegate.",
    .positionals = {{.name = "FIRMWARE", .doc = "Known-good firmware image.", .names = Names::input}},
    .options = {{.name = "bad", .value_name = "FILE", .doc = "Image that a sound rig rejects.", .names = Names::input},
                {.name = "runaway",
                 .value_name = "FILE",
                 .doc = "Image that drives the closed loop to a limit: must be rejected on the sound rig.",
                 .repeatable = true,
                 .names = Names::input},
                {.name = "fault",
                 .value_name = "NAME",
                 .doc = "Only this fault.",
                 .choices = names,
                 .repeatable = true},
                {.name = "plan",
                 .value_name = "PLAN",
                 .doc = "Plan file, or the name of one in ci/plans.",
                 .fallback = "faults",
                 .names = Names::input},
                {.name = "threads",
                 .value_name = "N",
                 .doc = "Worker processes at a time; 0: one per processor.",
                 .fallback = "0"}},
    .examples =
        {{"forcegate bench faults build/firmware/reference.native.so --bad build/firmware/mutants/compensation_off.native.so",
          "The whole matrix:"},
         {"forcegate bench faults build/firmware/reference.native.so --fault spring_slipped --json",
          "One fault, for a program:"}},
    .exit_codes = {kExitSuccess, kExitUsage, kExitInternal, kExitInterrupted},
    .run = run,
}};

}  // namespace
}  // namespace forcegate
