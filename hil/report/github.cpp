// "github": workflow commands that become annotations. GitHub shows ten a step, so there are at most ten: the
// decision, then what decided it, worst first.

#include <algorithm>

#include "hil/base/text.h"
#include "hil/interface/reporter.h"
#include "hil/report/figures/text.h"
#include "hil/report/judged.h"

namespace forcegate {
namespace {

std::string data(std::string_view text, bool property) {
  std::string out;
  for (const char c : figures::shorten(printable_utf8(text), 900)) {
    if (c == '%')
      out += "%25";
    else if (c == '\n')
      out += "%0A";
    else if (c == '\r')
      out += "%0D";
    else if (property && c == ':')
      out += "%3A";
    else if (property && c == ',')
      out += "%2C";
    else
      out += c;
  }
  return out;
}

std::string annotation(std::string_view level, std::string_view title, std::string_view message) {
  return "::" + std::string(level) + " title=" + data(title, true) + "::" + data(message, false) + "\n";
}

std::string render(const RunResult& result) {
  constexpr std::size_t kMost = 10;
  const Decision& d = result.decision;
  std::string out = annotation(d.kind == DecisionKind::accept ? "notice" : "error",
                               "forcegate " + std::string(to_string(d.kind)), d.reason);
  std::vector<JudgedRow> rows = rows_to_look_at(result);
  std::erase_if(rows, [](const JudgedRow& r) { return r.check->verdict == Verdict::waived; });
  for (std::size_t i = 0; i < rows.size() && i + 1 < kMost; ++i) {
    const Check& c = *rows[i].check;
    const bool hard = c.required && (c.verdict == Verdict::fail || c.verdict == Verdict::rig_error);
    out += annotation(hard ? "error" : "warning",
                      std::string(word(c.verdict)) + ": " + c.id +
                          (rows[i].in_case == nullptr ? "" : " in " + rows[i].in_case->id),
                      c.title + ": " + value_text(c, Glyphs::unicode) + ", limit " +
                          limit_text(c, Glyphs::unicode) + (c.evidence.empty() ? "" : ". " + c.evidence));
  }
  return out;
}

const Registration<ReporterKind> kRegistered{
    {"github", "", "workflow commands for GitHub annotations, at most ten", render}};

}  // namespace
}  // namespace forcegate
