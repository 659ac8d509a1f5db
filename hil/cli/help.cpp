#include "hil/cli/help.h"

#include <fmt/format.h>

#include <algorithm>

#include "hil/base/text.h"
#include "hil/cli/parse.h"

namespace forcegate {
namespace {

std::string option_head(const Option& o) {
  std::string head = o.letter != 0 ? fmt::format("-{}, ", o.letter) : "    ";
  head += "--" + o.name;
  if (!o.value_name.empty()) head += " " + o.value_name;
  return head;
}

std::string option_doc(const Option& o) {
  std::string doc = o.doc;
  if (o.choices) doc += fmt::format(" [{}{}]", join(o.choices(), ", "), o.only_choices ? "" : ", ...");
  if (!o.fallback.empty()) doc += fmt::format(" (default {})", o.fallback);
  if (o.required) doc += " (required)";
  if (o.repeatable) doc += " (repeatable)";
  return doc;
}

// "  head      doc", the doc wrapped in its own column.
std::string row(const std::string& head, const std::string& doc, std::size_t column) {
  std::string body = wrapped(doc, column);
  const std::string lead = "  " + head;
  if (lead.size() + 1 >= column) return lead + "\n" + body;
  return lead + body.substr(std::min(lead.size(), body.size()));
}

std::string options_block(const std::vector<Option>& options) {
  std::string out;
  for (const Option& o : options) out += row(option_head(o), option_doc(o), 32);
  return out;
}

std::string exit_code_block(const std::vector<int>& codes, const std::string& reject_text) {
  std::string out;
  for (const int code : codes) out += row(fmt::format("{:>3}", code), exit_code_text(code, reject_text), 8);
  return out;
}

const std::vector<std::string>& group_order() {
  static const std::vector<std::string> kOrder = {"Gate", "Bench", "Traces", "Diagnosis", "House"};
  return kOrder;
}

std::vector<std::string> groups_of(const std::vector<Command>& table) {
  std::vector<std::string> groups = group_order();
  for (const Command& c : table)
    if (std::find(groups.begin(), groups.end(), c.group) == groups.end()) groups.push_back(c.group);
  return groups;
}

}  // namespace

std::string wrapped(const std::string& text, std::size_t indent, std::size_t width) {
  const std::string margin(indent, ' ');
  std::string out;
  for (const std::string& paragraph : split(text, '\n')) {
    std::string line;
    // A line that begins with a space is a table or an example: it stays as it is.
    if (paragraph.starts_with(' ')) {
      out += margin + paragraph + "\n";
      continue;
    }
    for (const std::string& word : split(paragraph, ' ')) {
      if (!line.empty() && indent + line.size() + 1 + word.size() > width) {
        out += margin + line + "\n";
        line.clear();
      }
      line += (line.empty() ? "" : " ") + word;
    }
    out += line.empty() ? "\n" : margin + line + "\n";
  }
  return out;
}

const std::vector<int>& exit_codes() {
  static const std::vector<int> kCodes = {kExitSuccess,  kExitReject,     kExitUsage,    kExitNoDecision,
                                          kExitRigFault, kExitSafetyStop, kExitInternal, kExitInterrupted};
  return kCodes;
}

std::vector<int> exit_codes_of(const Command& command) {
  std::vector<int> codes = command.exit_codes;
  if (std::ranges::find(codes, int{kExitInterrupted}) == codes.end()) codes.push_back(kExitInterrupted);
  return codes;
}

std::string exit_code_text(int code, const std::string& reject_text) {
  if (code == kExitReject && !reject_text.empty()) return reject_text;
  switch (code) {
    case kExitSuccess: return "ACCEPT, or the verb did what it was asked.";
    case kExitReject: return "REJECT: the firmware failed a required check on a sound rig, crashed or hung.";
    case kExitUsage:
      return "The command line, a plan, a bench file or a data file is wrong; the message says how to mend it.";
    case kExitNoDecision:
      return "NO-DECISION: something required could not be judged; the reason names who must act.";
    case kExitRigFault: return "The rig misbehaved. The only code after which a retry makes sense.";
    case kExitSafetyStop:
      return "A safety limit parked the rig and the cause is undecided: a person must look.";
    case kExitInternal: return "A defect of Forcegate itself.";
    case kExitInterrupted: return "Interrupted by Ctrl-C, SIGTERM or SIGHUP.";
    default: return "";
  }
}

std::string usage_line(const Command& command) {
  std::string line = "forcegate " + command.name;
  for (const Option& o : command.options)
    if (o.required) line += fmt::format(" --{} {}", o.name, o.value_name);
  line += " [OPTIONS]";
  for (const Positional& p : command.positionals)
    line += (p.required ? " " : " [") + p.name + (p.repeatable ? "..." : "") + (p.required ? "" : "]");
  return line;
}

std::string overview_text(const std::vector<Command>& table, const Console& console) {
  std::string out =
      "forcegate - hardware-in-the-loop gate for the firmware of piezoresistive force sensors\n\n"
      "Plays force profiles on a bench or on an emulated rig, compares what the firmware reports with an ATI\n"
      "reference, and accepts or rejects the build.\n\n";
  out += console.paint(Paint::strong, "Usage:") + " forcegate VERB [OPTIONS] ...\n";
  for (const std::string& group : groups_of(table)) {
    std::string rows;
    for (const Command& c : table)
      if (c.group == group && !c.hidden) rows += row(c.name, c.summary, 24);
    if (!rows.empty()) out += "\n" + console.paint(Paint::strong, group + ":") + "\n" + rows;
  }
  out +=
      "\n" + console.paint(Paint::strong, "Options of every verb:") + "\n" + options_block(global_options());
  out += "\n" + console.paint(Paint::strong, "Exit codes:") + "\n" + exit_code_block(exit_codes(), "");
  out += "\n\"forcegate VERB --help\" teaches one verb; \"forcegate doctor\" says what this machine lacks.\n";
  return out;
}

std::string command_text(const Command& command, const Console& console) {
  std::string out = fmt::format("forcegate {} - {}\n\n", command.name, command.summary);
  out += console.paint(Paint::strong, "Usage:") + " " + usage_line(command) + "\n\n";
  out += wrapped(command.description, 0);
  if (command.details) out += "\n" + command.details();
  if (!command.positionals.empty()) {
    out += "\n" + console.paint(Paint::strong, "Arguments:") + "\n";
    for (const Positional& p : command.positionals)
      out += row(p.name, p.choices && p.list_choices ? fmt::format("{} [{}]", p.doc, join(p.choices(), ", ")) : p.doc, 32);
  }
  if (!command.options.empty())
    out += "\n" + console.paint(Paint::strong, "Options:") + "\n" + options_block(command.options);
  out +=
      "\n" + console.paint(Paint::strong, "Options of every verb:") + "\n" + options_block(global_options());
  if (!command.examples.empty()) {
    out += "\n" + console.paint(Paint::strong, "Examples:") + "\n";
    for (const Example& e : command.examples) out += wrapped(e.doc, 2) + "    " + e.command + "\n";
  }
  out += "\n" + console.paint(Paint::strong, "Exit codes:") + "\n" + exit_code_block(exit_codes_of(command), command.reject_text);
  return out;
}

}  // namespace forcegate
