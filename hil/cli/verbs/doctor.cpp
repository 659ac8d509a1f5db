#include "hil/app/help/doctor.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "hil/app/files/beside_program.h"
#include "hil/app/files/find_plan.h"
#include "hil/cli/command.h"
#include "hil/cli/parse.h"

namespace forcegate {
namespace {

using State = DoctorItem::State;

std::string word(const Console& console, const DoctorItem& item) {
  if (item.state == State::ok) return console.paint(Paint::pass, "ok     ");
  if (item.state == State::missing && item.required) return console.paint(Paint::fail, "MISSING");
  return console.paint(Paint::warn, item.state == State::missing ? "absent " : "limited");
}

std::string state_name(State state) {
  switch (state) {
    case State::ok: return "ok";
    case State::missing: return "missing";
    case State::limited: return "limited";
  }
  return "missing";
}

Result<int> run(const Invocation& in) {
  Console& console = in.console();
  nlohmann::ordered_json document = {
      {"format", 1}, {"ready", true}, {"items", nlohmann::ordered_json::array()}};
  bool ready = true;
  for (const DoctorItem& item : examine_machine("/proc/self/exe")) {
    if (item.required && item.state != State::ok) ready = false;
    console.print(fmt::format("{}  {:<18} {}", word(console, item), item.name, item.found));
    if (item.state != State::ok)
      console.print(fmt::format("{:27} for: {}\n{:27} get: {}", "", item.used_for, "", item.remedy));
    document["items"].push_back({{"name", item.name},
                                 {"state", state_name(item.state)},
                                 {"required", item.required},
                                 {"found", item.found},
                                 {"used_for", item.used_for},
                                 {"remedy", item.remedy}});
  }
  document["ready"] = ready;
  console.print(ready
                    ? console.paint(Paint::pass, "ready") + ": the gate on the emulated rig has all it needs"
                    : console.paint(Paint::fail, "not ready") + ": get what is MISSING above");
  console.print_json(document.dump(2));
  const std::optional<std::string> image = shipped_image("reference-m4f.block.elf");
  console.next(ready && image ? "forcegate gate " + file_quoted(*image) : image && !find_plan("smoke") ? "forcegate gate --help" : "./ci/build");
  return ready ? kExitSuccess : kExitNoDecision;
}

const Registration<Command> kRow{Command{
    .name = "doctor",
    .group = "House",
    .summary = "what this machine has, what it lacks and how to get it",
    .description =
        "Looks for the programs, images, devices and permissions that Forcegate uses, and says for each one that is "
        "missing what it is for and what to type. Changes nothing.\n\nMISSING is needed by the gate on the emulated "
        "rig; absent and limited only matter for what the \"for:\" line names.",
    .examples = {{"forcegate doctor", "Before the first run on a new machine:"}},
    .exit_codes = {kExitSuccess, kExitUsage, kExitNoDecision},
    .run = run,
}};

}  // namespace
}  // namespace forcegate
