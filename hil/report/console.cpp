// "console": ConsoleView without colour. Columns are as wide as their widest cell.

#include "hil/report/console.h"

#include <algorithm>
#include <array>

#include "hil/base/text.h"
#include "hil/interface/reporter.h"
#include "hil/report/figures/text.h"
#include "hil/report/judged.h"

namespace forcegate {
namespace {

std::size_t width_of(std::string_view text) {
  return static_cast<std::size_t>(std::count_if(
      text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }));
}

std::string one_line(std::string_view text) {
  std::string out = printable_utf8(text);
  std::replace(out.begin(), out.end(), '\n', ' ');
  std::replace(out.begin(), out.end(), '\t', ' ');
  return out;
}

class Painter {
 public:
  explicit Painter(bool on) : on_(on) {}
  std::string operator()(std::string_view code, std::string_view text) const {
    if (!on_) return std::string(text);
    return "\x1b[" + std::string(code) + "m" + std::string(text) + "\x1b[0m";
  }

 private:
  bool on_;
};

std::string_view colour_of(Verdict v) {
  switch (v) {
    case Verdict::pass: return "32";
    case Verdict::fail: return "31;1";
    case Verdict::rig_error: return "31";
    case Verdict::not_run:
    case Verdict::waived: return "2";
    default: return "33";
  }
}

std::string_view colour_of(DecisionKind kind) {
  return kind == DecisionKind::accept ? "32;1" : kind == DecisionKind::reject ? "31;1" : "33;1";
}

using Row = std::array<std::string, 6>;

}  // namespace

std::string render_console(const RunResult& result, const ConsoleView& view) {
  const Glyphs glyphs = view.ascii ? Glyphs::ascii : Glyphs::unicode;
  const Painter paint(view.colour);
  const std::string dot = view.ascii ? " | " : " \u00b7 ";
  const Decision& d = result.decision;

  std::string out =
      paint(colour_of(d.kind), std::string(symbol(d.kind, glyphs)) + " " + std::string(to_string(d.kind)));
  out += "  " + one_line(d.reason) + "\n";
  if (d.kind != DecisionKind::accept) {
    constexpr int kInterrupted = 130;  // by a person: nobody has to mend anything
    if (const std::string who = who_must_act(d.blame); !who.empty() && d.exit_code != kInterrupted) out += "  to act: " + who;
    if (d.safety_stop) out += dot + "safety stop";
    out += "\n";
  }
  // An image that was not opened has said nothing.
  const auto told = [&](const char* label, const std::string& text) { return text.empty() ? std::string() : dot + label + one_line(text); };
  out += "  firmware " + one_line(result.firmware_path) + told("", result.firmware.board) + told("build ", result.firmware.build_id.substr(0, 12)) +
         told("sha256 ", result.firmware_sha256.substr(0, 12)) + "\n";
  out += "  rig " + one_line(result.rig.name) + " " + one_line(result.rig.version) + dot + "plan " +
         one_line(result.plan_name) + dot + "calibration " + calibration_levels(result) + dot + "seed " +
         std::to_string(result.seed) + "\n";
  out += "  " + record_counts(result) + dot + std::to_string(judged_rows(result).size()) + " checks\n";

  const std::vector<JudgedRow> rows = rows_to_look_at(result);
  const std::size_t shown = std::min(rows.size(), static_cast<std::size_t>(std::max(0, view.max_rows)));
  if (shown > 0) {
    std::vector<Row> table{{"verdict", "case", "check", "value(u)", "limit", "ratio"}};
    for (std::size_t i = 0; i < shown; ++i) {
      const Check& c = *rows[i].check;
      table.push_back({std::string(symbol(c.verdict, glyphs)) + " " + std::string(word(c.verdict)),
                       rows[i].in_case == nullptr ? "whole run" : one_line(rows[i].in_case->id),
                       one_line(c.id) + (c.required ? "" : " (not required)"),
                       one_line(value_text(c, glyphs)), one_line(limit_text(c, glyphs)),
                       ratio_text(rows[i].ratio)});
    }
    std::array<std::size_t, 6> widths{};
    for (const Row& row : table)
      for (std::size_t k = 0; k < row.size(); ++k) widths[k] = std::max(widths[k], width_of(row[k]));
    out += "\n";
    for (std::size_t r = 0; r < table.size(); ++r) {
      std::string line;
      for (std::size_t k = 0; k < 6; ++k) {
        std::string cell = table[r][k];
        const std::string padding(widths[k] - width_of(cell), ' ');
        if (k == 0 && r > 0) cell = paint(colour_of(rows[r - 1].check->verdict), cell);
        if (r == 0) cell = paint("2", cell);
        line += "  " + (k == 5 ? padding + cell : cell + padding);
      }
      out += line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
    }
    if (rows.size() > shown) out += "  and " + std::to_string(rows.size() - shown) + " more in result.json\n";
  }
  if (view.notes)
    for (const std::string& note : result.notes) out += "\n  note: " + one_line(note);
  if (view.notes && !result.notes.empty()) out += "\n";
  out += "\n  reproduce: " + one_line(result.command_line) + "\n";
  return out;
}

namespace {

const Registration<ReporterKind> kRegistered{
    {"console", "", "the decision and what to look at, for a terminal",
     [](const RunResult& result) { return render_console(result, {}); }}};

}  // namespace
}  // namespace forcegate
