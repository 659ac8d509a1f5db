// "markdown": the job summary. Below 60 000 bytes whatever the run holds: rows are dropped, and that is said.

#include <fmt/format.h>

#include "hil/base/text.h"
#include "hil/interface/reporter.h"
#include "hil/report/figures/text.h"
#include "hil/report/judged.h"

namespace forcegate {
namespace {

constexpr std::size_t kMaxBytes = 60000, kMaxTableBytes = 24000, kMaxText = 400;

// No text of a device may make a table cell, a link, a tag or a mention.
std::string plain(std::string_view text) {
  std::string out;
  for (const char c : figures::shorten(printable_utf8(text), kMaxText)) {
    if (c == '\n' || c == '\t' || c == '\r')
      out += ' ';
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (c == '&')
      out += "&amp;";
    else if (c == '@')
      out += "&#64;";
    else if (std::string_view("|`*_[]\\#~!").find(c) != std::string_view::npos)
      (out += '\\') += c;
    else
      out += c;
  }
  return out;
}

// A code span longer than any run of backticks inside.
std::string code(std::string_view text) {
  std::string clean = printable_utf8(text), fence = "`";
  for (char& c : clean)
    if (c == '\n' || c == '\t') c = ' ';
  while (clean.find(fence) != std::string::npos) fence += '`';
  return fence.size() == 1 ? "`" + clean + "`" : fence + " " + clean + " " + fence;
}

std::string table_row(const JudgedRow& row) {
  const Check& c = *row.check;
  return "| " + std::string(symbol(c.verdict, Glyphs::unicode)) + " " + std::string(word(c.verdict)) + " | " +
         (row.in_case == nullptr ? "whole run" : plain(row.in_case->id)) + " | " + plain(c.title) +
         (c.required ? "" : " (not required)") + " | " + plain(value_text(c, Glyphs::unicode)) + " | " +
         plain(limit_text(c, Glyphs::unicode)) + " | " + ratio_text(row.ratio) + " |\n";
}

std::string table(const std::vector<JudgedRow>& rows) {
  std::string out = "| verdict | case | check | value(u) | limit | ratio |\n|---|---|---|---|---|---|\n";
  std::size_t written = 0;
  for (const JudgedRow& row : rows) {
    const std::string line = table_row(row);
    if (out.size() + line.size() > kMaxTableBytes) break;
    out += line;
    ++written;
  }
  if (written < rows.size()) out += fmt::format("\n{} more rows in result.json.\n", rows.size() - written);
  return out;
}

std::string render(const RunResult& result) {
  const Decision& d = result.decision;
  std::string out = "## " + std::string(symbol(d.kind, Glyphs::unicode)) + " " +
                    std::string(to_string(d.kind)) + ": " + plain(d.reason) + "\n\n";
  if (d.kind != DecisionKind::accept)
    if (const std::string who = who_must_act(d.blame); !who.empty())
      out += "To act: **" + who + "**" + (d.safety_stop ? " (safety stop)" : "") + "\n\n";
  out += record_counts(result) + ", " + std::to_string(judged_rows(result).size()) + " checks. Firmware " +
         code(result.firmware_path) + " on " + plain(result.firmware.board) + ", rig " +
         plain(result.rig.name) + " " + plain(result.rig.version) + ", plan " + plain(result.plan_name) +
         ", calibration " + calibration_levels(result) + ".\n\n";

  const std::vector<JudgedRow> rows = rows_to_look_at(result);
  if (!rows.empty()) out += "### To look at\n\n" + table(rows) + "\n";
  if (!result.checks.empty()) {
    std::vector<JudgedRow> whole;
    for (const Check& c : result.checks) whole.push_back({&c, nullptr, ratio_to_limit(c)});
    out += "### Whole run\n\n" + table(whole) + "\n";
  }
  std::string tail = "### Reproduce\n\n" + code(figures::shorten(result.command_line, 2000)) + "\n\n";
  tail += "firmware " + code(result.firmware_sha256) + ", plan " + code(result.plan_sha256) + ", seed " +
          std::to_string(result.seed) + ", forcegate " + plain(result.tool_version) + "\n\n";
  tail += "Values are value(standard uncertainty), k = 1. Rule: " + plain(result.decision_rule) + "\n";
  for (const std::string& note : result.notes) {
    const std::string line = "\n- " + plain(note);
    if (out.size() + tail.size() + line.size() + 2 > kMaxBytes) break;
    tail += line;
  }
  return out + tail + (result.notes.empty() ? "" : "\n");
}

const Registration<ReporterKind> kRegistered{
    {"markdown", "summary.md", "job summary below 60 kB: decision, rows to look at, how to repeat", render}};

}  // namespace
}  // namespace forcegate
