#include <fmt/format.h>

#include "hil/base/text.h"
#include "hil/cli/help.h"
#include "hil/cli/parse.h"

namespace forcegate {
namespace {

// roff reads "." and "'" at the start of a line, and "\" and "-" anywhere, as its own.
std::string roff(const std::string& text) {
  std::string out;
  bool line_start = true;
  for (const char c : text) {
    if (line_start && (c == '.' || c == '\'')) out += "\\&";
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else
      out += c;
    line_start = c == '\n';
  }
  return out;
}

std::string paragraphs(const std::string& text) {
  std::string out;
  for (const std::string& line : split(text, '\n')) out += line.empty() ? ".PP\n" : roff(line) + "\n";
  return out;
}

std::string tagged(const std::string& head, const std::string& doc) {
  return ".TP\n.B " + roff(head) + "\n" + roff(doc) + "\n";
}

std::string option_entry(const Option& o) {
  std::string head = o.letter != 0 ? fmt::format("-{}, --{}", o.letter, o.name) : "--" + o.name;
  if (!o.value_name.empty()) head += " " + o.value_name;
  std::string doc = o.doc;
  if (!o.fallback.empty()) doc += " Default: " + o.fallback + ".";
  return tagged(head, doc);
}

}  // namespace

std::string man_page(const std::vector<Command>& table, const std::string& version) {
  std::string out = fmt::format(".TH FORCEGATE 1 \"\" \"forcegate {}\" \"User Commands\"\n", version);
  out +=
      ".SH NAME\nforcegate \\- hardware-in-the-loop gate for the firmware of piezoresistive force sensors\n"
      ".SH SYNOPSIS\n.B forcegate\n.I VERB\n[OPTIONS] ...\n"
      ".SH DESCRIPTION\nPlays force profiles on a bench or on an emulated rig, compares what the firmware reports with "
      "an ATI reference, and accepts or rejects the build.\n.SH VERBS\n";
  for (const Command& c : table) {
    if (c.hidden) continue;
    out += ".SS " + roff(usage_line(c)) + "\n" + paragraphs(c.description);
    for (const Positional& p : c.positionals) out += tagged(p.name, p.doc);
    for (const Option& o : c.options) out += option_entry(o);
    for (const Example& e : c.examples)
      out += ".PP\n" + roff(e.doc) + "\n.RS\n.nf\n" + roff(e.command) + "\n.fi\n.RE\n";
  }
  out += ".SH OPTIONS OF EVERY VERB\n";
  for (const Option& o : global_options()) out += option_entry(o);
  out += ".SH EXIT STATUS\n";
  for (const int code : exit_codes()) out += tagged(std::to_string(code), exit_code_text(code));
  out += ".SH ENVIRONMENT\n" + tagged("NO_COLOR", "When set, no colour.") +
         tagged("CLICOLOR_FORCE", "When set and not 0, colour even when stdout is not a terminal.");
  return out;
}

}  // namespace forcegate
