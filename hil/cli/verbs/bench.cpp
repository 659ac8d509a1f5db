#include "hil/app/bench/bench.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "hil/base/text.h"
#include "hil/cli/command.h"
#include "hil/cli/parse.h"
#include "hil/cli/verbs/action_options.h"
#include "hil/cli/verbs/bench_line.h"

namespace forcegate {
namespace {

using Json = nlohmann::ordered_json;

std::map<std::string, std::string> options_of(const Invocation& in) {
  std::map<std::string, std::string> options{{"purpose", in.command_line()}};
  if (in.given("attach")) options["attach"] = in.text("attach");
  if (in.flag("arm")) options["arm"] = "yes";
  return options;
}

Result<std::string> file_of(const Invocation& in) {
  if (const auto files = in.texts("FILE"); !files.empty()) return files.front();
  return fail(ErrorCode::usage, "bench " + in.text("ACTION") + " needs a bench file", {},
              "forcegate bench list shows those that there are");
}

Result<int> list(const Invocation& in) {
  std::vector<std::filesystem::path> files;
  for (const std::string& f : in.texts("FILE")) files.emplace_back(f);
  Json document = Json::array();
  bool good = true;
  const std::vector<BenchRow> benches = list_benches(files);
  for (const BenchRow& row : benches) {
    good = good && row.mistake.empty();
    in.console().print(
        row.mistake.empty()
            ? fmt::format("{:<24} {}  {}\n{:24} {} + {} + {}", row.file, row.twins ? "twins" : "real ",
                          row.doc, "", row.motor, row.reference, row.board)
            : fmt::format("{:<24} {}{}", row.file, in.console().paint(Paint::fail, row.mistake),
                          row.remedy.empty() ? "" : fmt::format("\n{:24} help: {}", "", row.remedy)));
    document.push_back({{"file", row.file},
                        {"name", row.name},
                        {"id", row.id},
                        {"doc", row.doc},
                        {"twins", row.twins},
                        {"motor", row.motor},
                        {"reference", row.reference},
                        {"board", row.board},
                        {"mistake", row.mistake},
                        {"remedy", row.remedy}});
  }
  in.console().print_json(Json({{"format", 1}, {"benches", document}}).dump(2));
  in.console().next(line_after_list(benches));
  return good ? kExitSuccess : kExitUsage;
}

Result<int> doctor(const Invocation& in) {
  FORCEGATE_TRY(const std::string file, file_of(in));
  FORCEGATE_TRY(const auto items, examine_bench(file, options_of(in)));
  Json document = Json::array();
  bool good = true;
  for (const BenchItem& item : items) {
    good = good && item.good;
    in.console().print(fmt::format(
        "{}  {:<24} {}",
        item.good ? in.console().paint(Paint::pass, "ok  ") : in.console().paint(Paint::fail, "BAD "),
        item.name, item.found));
    if (!item.remedy.empty()) in.console().print(fmt::format("{:30} help: {}", "", item.remedy));
    document.push_back(
        {{"name", item.name}, {"good", item.good}, {"found", item.found}, {"remedy", item.remedy}});
  }
  in.console().print_json(Json({{"format", 1}, {"ready", good}, {"items", document}}).dump(2));
  if (!good) in.console().print("mend what is BAD, then ask again");
  in.console().next(good ? line_that_gates_on(in, file) : "forcegate bench doctor " + bench_words(in, file));
  return good ? kExitSuccess : kExitRigFault;
}

Result<int> scan(const Invocation& in) {
  Json document = Json::array();
  const auto ports = scan_ports();
  for (const ScannedPort& p : ports) {
    in.console().print(fmt::format("{:<16} {}\n{:16} {}", p.port, p.description, "", p.stable_name));
    document.push_back({{"port", p.port}, {"stable_name", p.stable_name}, {"description", p.description}});
  }
  if (ports.empty()) in.console().print("no serial or HID device is connected");
  in.console().print_json(Json({{"format", 1}, {"ports", document}}).dump(2));
  if (!ports.empty()) in.console().print("the stable names belong under [ports] of a bench file (docs/bench.md)");
  in.console().next("forcegate bench list");
  return kExitSuccess;
}

Result<int> serve(const Invocation& in) {
  FORCEGATE_TRY(const std::string file, file_of(in));
  const std::string folder = in.text("folder");
  const auto ready = [&](const std::vector<std::string>& endpoints) {
    for (const std::string& e : endpoints) in.console().print(e);
    in.console().print("Ctrl-C ends the twins; in another terminal:");
    in.console().print_json(Json({{"format", 1}, {"folder", folder}, {"endpoints", endpoints}}).dump(2));
    in.console().next("forcegate bench doctor " + file_quoted(file) + " --attach " + file_quoted(folder));
    std::fflush(stdout);
  };
  FORCEGATE_CHECK_OK(serve_bench(file, folder, ready, in.interrupt_flag()));
  return kExitSuccess;
}

Result<int> park(const Invocation& in) {
  FORCEGATE_TRY(const std::string file, file_of(in));
  FORCEGATE_TRY(const int holder, park_bench(file, options_of(in)));
  in.console().print(holder > 0 ? fmt::format("the motor is stopped; process {} was told to end", holder)
                                : "the motor is stopped");
  in.console().print_json(Json({{"format", 1}, {"stopped", true}, {"holder", holder}}).dump(2));
  in.console().next("forcegate bench doctor " + bench_words(in, file));
  return kExitSuccess;
}

Result<int> reset(const Invocation& in) {
  FORCEGATE_TRY(const std::string file, file_of(in));
  FORCEGATE_TRY(const auto fault, reset_bench(file, options_of(in)));
  in.console().print(fault ? fmt::format("the drive has forgotten fault {:#x}; the motor is stopped", *fault) : "the drive reports no fault");
  in.console().print_json(Json({{"format", 1}, {"reset", fault.has_value()}, {"fault_code", fault ? Json(*fault) : Json()}}).dump(2));
  in.console().next("forcegate bench doctor " + bench_words(in, file));
  return kExitSuccess;
}

Result<int> jog(const Invocation& in) {
  FORCEGATE_TRY(const std::string file, file_of(in));
  FORCEGATE_TRY(const double angle, in.number("angle", -6.3, 6.3));
  FORCEGATE_TRY(const double speed, in.number("speed", 0.01, 5.0));
  FORCEGATE_TRY(const JogResult r, jog_bench(file, options_of(in), angle, speed, in.interrupt_flag()));
  const double off_rad = r.to_rad - angle;
  const std::string short_of = std::fabs(off_rad) < 0.0015 ? "" : fmt::format(" ({:+.0f} mrad from {} rad)", 1000.0 * off_rad, shortest(angle));
  in.console().print(fmt::format("from {:.3f} to {:.3f} rad{}; the reference reads {:.3f} N", r.from_rad, r.to_rad, short_of, r.force_N));
  in.console().print_json(
      Json({{"format", 1}, {"from_rad", r.from_rad}, {"to_rad", r.to_rad}, {"force_N", r.force_N}}).dump(2));
  in.console().next(line_that_parks(in, file).value_or("forcegate bench doctor " + bench_words(in, file)));
  return kExitSuccess;
}

Result<int> who(const Invocation& in) {
  FORCEGATE_TRY(const std::string file, file_of(in));
  FORCEGATE_TRY(const auto holder, bench_holder(file));
  if (!holder) {
    in.console().print("nobody holds the bench");
    in.console().print_json(Json({{"format", 1}, {"held", false}}).dump(2));
    in.console().next("forcegate bench doctor " + bench_words(in, file));
    return kExitSuccess;
  }
  in.console().print(fmt::format("process {} since {:.0f} s, last sign of life {:.0f} s ago\n{}", holder->pid,
                                 holder->held_s, holder->silent_s, holder->purpose));
  in.console().print_json(Json({{"format", 1},
                                {"held", true},
                                {"pid", holder->pid},
                                {"token", holder->token},
                                {"held_s", holder->held_s},
                                {"silent_s", holder->silent_s},
                                {"purpose", holder->purpose}})
                              .dump(2));
  const std::optional<std::string> park = line_that_parks(in, file);
  if (park) in.console().print("park stops the motor and ends that process");
  in.console().next(park.value_or("forcegate bench who " + bench_words(in, file)));
  return kExitSuccess;
}

Result<int> specimens(const Invocation& in) {
  FORCEGATE_TRY(const std::string file, file_of(in));
  FORCEGATE_TRY(const auto rows, list_specimens(file));
  Json document = Json::array();
  for (const SpecimenRow& r : rows) {
    in.console().print(fmt::format("{:<12} rest {:8.2f} h {:<10} {:4} records {:8} cycles, last {}", r.id,
                                   r.rest_h, r.rested ? "" : "(too short)", r.records, r.cycles, r.last_use));
    document.push_back({{"id", r.id},
                        {"rest_h", r.rest_h},
                        {"rested", r.rested},
                        {"records", r.records},
                        {"cycles", r.cycles},
                        {"last_use", r.last_use}});
  }
  if (rows.empty()) in.console().print("no specimen has been used on this bench");
  in.console().print_json(Json({{"format", 1}, {"specimens", document}}).dump(2));
  in.console().next(line_that_gates_on(in, file));
  return kExitSuccess;
}

// --attach also where only the next line needs it.
const ActionOptions kActions[] = {
    {"list", {}, std::numeric_limits<std::size_t>::max()},
    {"doctor", {"attach", "arm"}},
    {"scan", {}, 0},
    {"serve", {"folder"}},
    {"park", {"attach", "arm"}},
    {"reset", {"attach", "arm"}},
    {"jog", {"attach", "arm", "angle", "speed"}},
    {"who", {"attach"}},
    {"specimens", {"attach"}},
};

Result<int> run(const Invocation& in) {
  const std::string action = in.text("ACTION");
  FORCEGATE_CHECK_OK(check_action_options(in, action, kActions));
  if (action == "list") return list(in);
  if (action == "doctor") return doctor(in);
  if (action == "scan") return scan(in);
  if (action == "serve") return serve(in);
  if (action == "park") return park(in);
  if (action == "reset") return reset(in);
  if (action == "jog") return jog(in);
  if (action == "specimens") return specimens(in);
  return who(in);
}

const Registration<Command> kRow{Command{
    .name = "bench",
    .group = "Bench",
    .summary = "instruments on the table: list, doctor, scan, serve, park, reset, jog, who, specimens",
    .description =
        "A bench is one TOML file: instruments, ports, limits, calibrations, geometry (docs/bench.md). A bench with "
        "[twins] has wire-level twins instead of instruments and needs no hardware.\n\n"
        "list    bench files, and what is wrong with them\n"
        "doctor  opens every instrument, asks who it is and for one reading; nothing moves\n"
        "scan    serial ports and HID devices with their stable names\n"
        "serve   leaves the twins of a bench running for a person or another program\n"
        "park    emergency stop: the motor at once, whoever holds the bench\n"
        "reset   makes a drive forget its fault when you have found the cause; stops it first, nothing moves\n"
        "jog     turns the wheel to an angle, slowly and under the limits\n"
        "who     which process holds the bench\n"
        "specimens  how long each specimen has rested, and what it has been through\n\n"
        "Nothing real moves without --arm. When the program dies while the bench is armed, a process of its own stops "
        "the motor, and the drive's own timeout stands behind it.",
    .positionals = {{.name = "ACTION",
                     .doc = "What to do.",
                     .choices =
                         [] {
                           return std::vector<std::string>{"list", "doctor", "scan", "serve",    "park",
                                                           "reset", "jog",   "who",  "specimens"};
                         }},
                    {.name = "FILE", .doc = "Bench file.", .required = false, .repeatable = true, .names = Names::input}},
    .options = {{.name = "attach",
                 .value_name = "FOLDER",
                 .doc = "Twins that `bench serve` runs in that folder."},
                {.name = "arm", .value_name = "", .doc = "Let a real bench move: nobody reaches into it."},
                {.name = "folder",
                 .value_name = "FOLDER",
                 .doc = "serve: where the ports appear.",
                 .fallback = "/tmp/forcegate-twins"},
                {.name = "angle", .value_name = "RAD", .doc = "jog: where to.", .fallback = "0"},
                {.name = "speed", .value_name = "RAD_PER_S", .doc = "jog: how fast.", .fallback = "0.5"}},
    .examples = {{"forcegate bench list", "Which benches are there?"},
                 {"forcegate bench doctor rigs/twin.toml", "Do all instruments answer?"},
                 {"forcegate bench serve rigs/twin.toml", "Twins to talk to with any program:"},
                 {"forcegate bench park rigs/lab.toml", "Emergency stop:"}},
    .exit_codes = {kExitSuccess, kExitUsage, kExitRigFault, kExitSafetyStop, kExitInternal, kExitInterrupted},
    .run = run,
}};

}  // namespace
}  // namespace forcegate
