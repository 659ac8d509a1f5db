#include <fmt/format.h>
#include <unistd.h>

#include <iostream>
#include <nlohmann/json.hpp>

#include "hil/app/bench/bench_calibrate.h"
#include "hil/app/files/own_file.h"
#include "hil/app/files/write_file.h"
#include "hil/base/read_number.h"
#include "hil/base/text.h"
#include "hil/base/utc_clock.h"
#include "hil/cli/command.h"
#include "hil/cli/parse.h"
#include "hil/cli/verbs/action_options.h"
#include "hil/cli/verbs/bench_line.h"
#include "hil/cli/verbs/force_row.h"

namespace forcegate {
namespace {

using Json = nlohmann::ordered_json;

Result<std::vector<double>> masses_of(const std::string& text) {
  std::vector<double> out;
  for (const std::string& word : split(text, ',')) {
    const std::optional<double> mass_g = read_number(word);
    if (!mass_g || *mass_g < 0.0 || *mass_g > 1e6)
      return fail(ErrorCode::usage, "'" + printable_utf8(word) + "' is no mass in grams", "--masses",
                  "for example --masses 0,50,100,200,400");
    out.push_back(*mass_g);
  }
  return out;
}

// --specimen and --arm also where only the next line needs them.
const ActionOptions kActions[] = {
    {"reference", {"masses", "mass-u-rel", "gravity", "seconds", "specimen", "yes", "arm", "attach"}},
    {"spring", {"seconds", "specimen", "arm", "attach"}},
    {"sensor", {"specimen", "arm", "attach", "output", "force"}},
};

Result<Calibrated> calibrate(const Invocation& in) {
  CalibrateRequest q;
  q.bench = in.text("FILE");
  q.options = {{"purpose", in.command_line()}, {"today", utc_today()}};
  if (in.given("attach")) q.options["attach"] = in.text("attach");
  if (in.flag("arm")) q.options["arm"] = "yes";
  FORCEGATE_TRY(q.masses_g, masses_of(in.text("masses")));
  FORCEGATE_TRY(q.gravity_m_per_s2, in.number("gravity", 9.7, 9.9));
  FORCEGATE_TRY(q.mass_u_rel, in.number("mass-u-rel", 0.0, 0.1));
  FORCEGATE_TRY(q.seconds, in.number("seconds", 0.1, 600.0));
  q.specimen = in.text("specimen");
  q.stop = &in.interrupt_flag();
  const std::string what = in.text("WHAT");
  if (what == "spring") return calibrate_spring(q);
  if (what == "sensor") return calibrate_sensor(q);
  if (in.flag("yes")) return calibrate_reference(q, {});
  if (isatty(STDIN_FILENO) == 0)
    return fail(ErrorCode::usage, "nobody is there to lay the masses on", {},
                "run it in a terminal; with twins, give --yes");
  return calibrate_reference(q, [&](const std::string& instruction) -> Result<void> {
    in.console().print(instruction + ", then press Enter");
    std::fflush(stdout);
    std::string line;
    if (!std::getline(std::cin, line) || q.stop->load()) return fail(ErrorCode::cancelled, "interrupted", {});
    return {};
  });
}

// Reference, spring, sensor, then the gate with what was written.
std::string line_after(const Invocation& in, const Calibrated& c) {
  const std::string file = in.text("FILE");
  if (c.what == "sensor" && in.given("output")) return line_that_gates_on(in, file, in.text("output"));
  if (c.what == "sensor") return in.command_line() + " -o sensor.toml";
  std::string then = bench_words(in, file) + (c.what == "spring" ? " sensor -o sensor.toml" : " spring");
  if (in.given("specimen")) then += " --specimen " + shell_quoted(in.text("specimen"));
  if (in.flag("arm")) then += " --arm";
  return "forcegate bench calibrate " + then;
}

Result<int> run(const Invocation& in) {
  FORCEGATE_CHECK_OK(check_action_options(in, in.text("WHAT"), kActions));
  const std::string out = in.text("output");
  if (!in.flag("force")) FORCEGATE_CHECK_OK(check_own_file(out, kMarkOfCalibration));
  if (!out.empty()) FORCEGATE_CHECK_OK(check_writable(out));
  FORCEGATE_TRY(const Calibrated c, calibrate(in));
  if (c.line)
    for (const CalibrationPoint& p : c.line->points)
      in.console().print(fmt::format("{:>9.4f} {}  {:>9.4f} N  s {:.4f} N  {} readings", p.x,
                                     c.what == "spring" ? "mm" : "N ", p.y, p.s, p.n));
  for (const std::string& finding : c.findings) in.console().print(finding);
  std::string lines;
  for (const std::string& line : c.bench_lines) lines += line + "\n";
  const std::string file = in.text("FILE");
  if (c.what == "sensor" && !out.empty()) {
    FORCEGATE_CHECK_OK(write_file_atomically(out, lines));
  } else {
    in.console().print((c.what == "sensor" ? "\ncalibration file:\n" : "\nto enter into " + file + ":\n") +
                       lines);
  }
  Json points = Json::array();
  if (c.line)
    for (const CalibrationPoint& p : c.line->points)
      points.push_back({{"x", p.x}, {"reading_N", p.y}, {"s_N", p.s}, {"n", p.n}});
  Json document{{"format", 1},      {"what", c.what},         {"u_rel", c.u_rel},
                {"points", points}, {"findings", c.findings}, {"lines", c.bench_lines}};
  if (c.line)
    document["line"] = {{"slope", c.line->slope},
                        {"u_slope", c.line->u_slope},
                        {"intercept", c.line->intercept},
                        {"residual", c.line->residual},
                        {"worst", c.line->worst}};
  in.console().print_json(document.dump(2));
  in.console().next(line_after(in, c));
  return kExitSuccess;
}

const Registration<Command> kRow{Command{
    .name = "bench calibrate",
    .group = "Bench",
    .summary = "calibrate reference, spring or sensor, step by step",
    .description =
        "reference  asks for one known mass after the other on the ATI (unloaded by the wheel; nothing moves) and fits a line\n"
        "spring     turns the wheel slowly through its travel and back and fits F = k (preload + e (1 - cos theta)) to the "
        "reference, which must be calibrated first\n"
        "sensor     two slow sweeps of the specimen: gain and offset of F = gain U + offset (Lebosse 2011, eq. 1)\n\n"
        "Nothing is changed: what follows is printed as lines for the bench file, and the sensor's calibration can be written with -o "
        "for `gate --cal`. A bench of twins lays the masses on by itself with --yes.",
    .positionals = {{.name = "FILE", .doc = "Bench file.", .names = Names::input},
                    {.name = "WHAT",
                     .doc = "What to calibrate.",
                     .choices =
                         [] {
                           return std::vector<std::string>{"reference", "spring", "sensor"};
                         }}},
    .options =
        {{.name = "masses",
          .value_name = "G,G,...",
          .doc = "Known masses in grams, in this order.",
          .fallback = "0,50,100,200,300,400"},
         {.name = "mass-u-rel",
          .value_name = "U",
          .doc = "Relative standard uncertainty of the masses.",
          .fallback = "0.0001"},
         {.name = "gravity", .value_name = "M_PER_S2", .doc = "Of the place.", .fallback = "9.80665"},
         {.name = "seconds", .value_name = "S", .doc = "Averaged at each point.", .fallback = "2"},
         {.name = "specimen", .value_name = "ID", .doc = "Sensor that lies in the bench.", .fallback = "q50"},
         {.name = "yes", .value_name = "", .doc = "Ask nothing: twins lay the masses on themselves."},
         {.name = "arm", .value_name = "", .doc = "Let a real bench move: nobody reaches into it."},
         {.name = "attach", .value_name = "FOLDER", .doc = "Twins that `bench serve` runs in that folder."},
         {.name = "output",
          .value_name = "FILE",
          .doc = "sensor: write the calibration there.",
          .letter = 'o',
          .names = Names::file},
         force_row()},
    .examples = {{"forcegate bench calibrate rigs/twin.toml reference --masses 0,100,200,400 --yes",
                  "The reference of the twins:"},
                 {"forcegate bench calibrate rigs/twin.toml spring", "The spring against the reference:"},
                 {"forcegate bench calibrate rigs/twin.toml sensor -o q50.toml",
                  "The sensor that lies in the bench:"}},
    .exit_codes = {kExitSuccess, kExitUsage, kExitRigFault, kExitSafetyStop, kExitInternal, kExitInterrupted},
    .run = run,
}};

}  // namespace
}  // namespace forcegate
