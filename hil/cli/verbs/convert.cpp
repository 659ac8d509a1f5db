#include "hil/app/recording/convert.h"
#include "hil/app/recording/split.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "hil/base/plain_number.h"
#include "hil/base/text.h"
#include "hil/cli/command.h"
#include "hil/cli/parse.h"

namespace forcegate {
namespace {

// A diagnosis needs the force and the output, and enough of them.
std::string line_after(const ConvertReport& report, const std::string& file) {
  constexpr std::size_t kFewest = 1000;
  const auto has = [&](const char* name) {
    return std::ranges::any_of(report.channels, [&](const ConvertedChannel& c) { return c.name == name && c.samples - c.missing >= kFewest; });
  };
  return has("F_ref") && has("U") ? "forcegate diagnose " + file_quoted(file) : "forcegate convert --help";
}

std::vector<std::string> print_notes(Console& console, const std::vector<std::string>& notes) {
  std::vector<std::string> shown;
  for (const std::string& note : notes) {
    shown.push_back(printable_utf8(note));
    if (!console.quiet()) console.print("  note: " + shown.back());
  }
  return shown;
}

Result<int> run_split(const Invocation& in, ConvertRequest given) {
  FORCEGATE_TRY(const SplitReport report, split({given.from, given.to, in.text("split"), std::move(given.column_map), given.assumed_rate_Hz, given.overwrite}));
  Console& console = in.console();
  nlohmann::ordered_json parts = nlohmann::ordered_json::array();
  for (const SplitPart& p : report.parts) {
    console.print(fmt::format("  {:<12} {:>10} samples over {} s: {}", printable_utf8(p.part), p.rows, with_uncertainty(p.duration_s, 0.0), printable_utf8(p.file.string())));
    parts.push_back({{"part", printable_utf8(p.part)}, {"file", printable_utf8(p.file.string())}, {"samples", p.rows}, {"duration_s", p.duration_s}});
  }
  const std::vector<std::string> notes = print_notes(console, report.notes);
  console.print(counted(report.parts.size(), "file") + " written to " + in.text("TO"));
  console.print_json(nlohmann::ordered_json{{"format", 1}, {"from", printable_utf8(in.text("FROM"))}, {"to", printable_utf8(in.text("TO"))}, {"split", printable_utf8(in.text("split"))}, {"parts", parts}, {"notes", notes}}
                         .dump(2));
  console.next("forcegate diagnose " + file_quoted(report.take_turns ? report.parts.front().file.string() : in.text("TO")));
  return kExitSuccess;
}

Result<int> run(const Invocation& in) {
  ConvertRequest request{.from = in.text("FROM"), .to = in.text("TO"), .column_map = {}};
  FORCEGATE_TRY(request.column_map, parse_column_map(in.texts("map")));
  if (in.given("rate")) {
    FORCEGATE_TRY(request.assumed_rate_Hz, in.number("rate", 1e-6, 1e7));
  }
  request.overwrite = in.flag("force");
  if (in.given("split")) return run_split(in, std::move(request));
  FORCEGATE_TRY(const ConvertReport report, convert(request));

  Console& console = in.console();
  nlohmann::ordered_json channels = nlohmann::ordered_json::array();
  for (const ConvertedChannel& c : report.channels) {
    console.print(fmt::format("  {:<10} {:<6} {:>10} samples {:>6} missing {:>4} gaps  ({})",
                              printable_utf8(c.name), printable_utf8(c.unit), c.samples, c.missing, c.gaps,
                              printable_utf8(c.device)));
    channels.push_back({{"name", printable_utf8(c.name)},
                        {"unit", printable_utf8(c.unit)},
                        {"time_base", printable_utf8(c.device)},
                        {"samples", c.samples},
                        {"missing", c.missing},
                        {"gaps", c.gaps}});
  }
  const std::vector<std::string> notes = print_notes(console, report.notes);
  console.print(fmt::format("{} s written to {}", with_uncertainty(report.duration_s, 0.0), in.text("TO")));
  console.print_json(nlohmann::ordered_json{
      {"format", 1},
      {"from", printable_utf8(in.text("FROM"))},
      {"to", printable_utf8(in.text("TO"))},
      {"duration_s", report.duration_s},
      {"channels", channels},
      {"notes", notes}}.dump(2));
  console.next(line_after(report, in.text("TO")));
  return kExitSuccess;
}

const Registration<Command> kRow{Command{
    .name = "convert",
    .group = "Traces",
    .summary = "a recording from one file format into another",
    .description =
        "Reads CSV (also with ; or tab), HDF5, MAT 5 or a journal, and writes CSV, HDF5 or MAT 5, each known by the "
        "ending of its name. The unit stands in the name of a column (F_ref_N, U_mV, theta_deg) and becomes SI. Gaps "
        "and missing samples stay what they are; nothing is interpolated. What had to be assumed is said.\n\n"
        "A table of several sensors or trials, with a column that tells which row is whose, becomes one file for each with --split; TO is a folder then. Sensors "
        "are diagnosed one by one, trials of one sensor as the folder.\n\n"
        "A CSV has one clock: a trace whose devices have clocks of their own needs HDF5 or MAT.",
    .positionals = {{.name = "FROM", .doc = "File to read.", .names = Names::input}, {.name = "TO", .doc = "File to write; a folder with --split.", .names = Names::file}},
    .options =
        {{.name = "map",
          .value_name = "COLUMN=NAME",
          .doc = "Take a foreign column as one of ours.",
          .repeatable = true},
         {.name = "rate", .value_name = "HZ", .doc = "Rate of a file that has no clock."},
         {.name = "split", .value_name = "COLUMN", .doc = "One file for each value of a column of whole numbers or words."},
         {.name = "force", .value_name = "", .doc = "Replace the output if it exists.", .letter = 'f'}},
    .examples = {{"forcegate convert run.h5 run.csv", "For a spreadsheet:"},
                 {"forcegate convert labview.txt run.h5 --map \"Load cell (N)=F_ref_N\" --rate 1000",
                  "A file of another program without a clock:"},
                 {"forcegate convert trials.csv trials --split trial", "Trials that stand one below the other in one table:"}},
    .exit_codes = {kExitSuccess, kExitUsage},
    .run = run,
}};

}  // namespace
}  // namespace forcegate
