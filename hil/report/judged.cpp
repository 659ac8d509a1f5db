#include "hil/report/judged.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "hil/base/text.h"
#include "hil/report/figures/text.h"

namespace forcegate {
namespace {

int severity(Verdict v) {
  switch (v) {
    case Verdict::fail: return 6;
    case Verdict::rig_error: return 5;
    case Verdict::inconclusive: return 4;
    case Verdict::not_run: return 3;
    case Verdict::waived: return 2;
    case Verdict::marginal: return 1;
    case Verdict::pass: return 0;
  }
  return 3;
}

std::string with_unit(std::string number, const std::string& unit) {
  return unit.empty() || unit == "1" ? number : number + " " + figures::shorten(unit, 16);
}

std::string as_ascii(std::string text) {
  for (std::size_t at; (at = text.find("\u2212")) != std::string::npos;) text.replace(at, 3, "-");
  for (std::size_t at; (at = text.find("\u221e")) != std::string::npos;) text.replace(at, 3, "inf");
  return text;
}

}  // namespace

double ratio_to_limit(const Check& check) {
  const double none = std::numeric_limits<double>::quiet_NaN();
  if (!std::isfinite(check.value) || !(check.limit.value >= 0.0)) return none;
  // no multiple of nothing, and beyond any all the same
  if (check.limit.value == 0.0) return check.limit.kind == Limit::Kind::upper && check.value > 0.0 ? std::numeric_limits<double>::infinity() : none;
  if (check.limit.kind == Limit::Kind::upper) return check.value / check.limit.value;
  if (check.limit.kind == Limit::Kind::lower && check.value > 0.0) return check.limit.value / check.value;
  return none;
}

std::vector<JudgedRow> judged_rows(const RunResult& result) {
  std::vector<JudgedRow> rows;
  for (const Check& c : result.checks) rows.push_back({&c, nullptr, ratio_to_limit(c)});
  for (const CaseResult& r : result.cases)
    for (const Check& c : r.checks) rows.push_back({&c, &r, ratio_to_limit(c)});
  return rows;
}

std::vector<JudgedRow> rows_to_look_at(const RunResult& result) {
  std::vector<JudgedRow> rows = judged_rows(result);
  std::erase_if(rows, [](const JudgedRow& r) {
    return r.check->verdict == Verdict::pass || (r.check->verdict == Verdict::not_run && !r.check->required);
  });
  const auto order = [](const JudgedRow& r) { return std::isnan(r.ratio) ? -1.0 : r.ratio; };
  std::stable_sort(rows.begin(), rows.end(), [&](const JudgedRow& a, const JudgedRow& b) {
    if (a.check->required != b.check->required) return a.check->required;
    if (severity(a.check->verdict) != severity(b.check->verdict))
      return severity(a.check->verdict) > severity(b.check->verdict);
    return order(a) > order(b);
  });
  return rows;
}

Verdict case_verdict(const CaseResult& result) {
  bool any = false;
  Verdict worst = Verdict::pass;
  for (const Check& c : result.checks) {
    if (!c.required) continue;
    any = true;
    if (severity(c.verdict) > severity(worst)) worst = c.verdict;
  }
  return any ? worst : Verdict::not_run;
}

std::map<Verdict, int> count_cases(const RunResult& result) {
  std::map<Verdict, int> counts;
  for (const CaseResult& c : result.cases) ++counts[case_verdict(c)];
  return counts;
}

std::string record_counts(const RunResult& result) {
  std::string out = std::to_string(result.cases.size()) + (result.cases.size() == 1 ? " record" : " records");
  std::string separator = ": ";
  for (const auto& [verdict, n] : count_cases(result)) {
    out += separator + std::to_string(n) + " " + std::string(word(verdict));
    separator = ", ";
  }
  return out;
}

std::string_view symbol(Verdict verdict, Glyphs glyphs) {
  const bool ascii = glyphs == Glyphs::ascii;
  switch (verdict) {
    case Verdict::pass: return ascii ? "ok" : "\u2713";
    case Verdict::marginal: return ascii ? "~" : "\u2248";
    case Verdict::fail: return ascii ? "X" : "\u2717";
    case Verdict::inconclusive: return "?";
    case Verdict::rig_error: return "!";
    case Verdict::not_run: return ascii ? "-" : "\u2205";
    case Verdict::waived: return "w";
  }
  return "?";
}

std::string_view symbol(DecisionKind kind, Glyphs glyphs) {
  switch (kind) {
    case DecisionKind::accept: return symbol(Verdict::pass, glyphs);
    case DecisionKind::reject: return symbol(Verdict::fail, glyphs);
    case DecisionKind::no_decision: return "?";
  }
  return "?";
}

std::string_view word(Verdict verdict) {
  switch (verdict) {
    case Verdict::rig_error: return "rig error";
    case Verdict::not_run: return "not run";
    default: return to_string(verdict);
  }
}

std::string value_text(const Check& check, Glyphs glyphs) {
  std::string text;
  if (std::isnan(check.value)) return "not measured";
  if (check.u > 0.0 && std::isfinite(check.u) && std::isfinite(check.value))
    text = with_unit(figures::typographic_minus(with_uncertainty(check.value, check.u)), check.unit);
  else if (check.u == 0.0)
    text = with_unit(figures::display(check.value, 6), check.unit);
  else
    text = with_unit(figures::display(check.value, 4), check.unit) + " (u n/a)";
  return glyphs == Glyphs::ascii ? as_ascii(text) : text;
}

std::string limit_text(const Check& check, Glyphs glyphs) {
  const bool ascii = glyphs == Glyphs::ascii;
  std::string text;
  switch (check.limit.kind) {
    case Limit::Kind::none: return "none";
    case Limit::Kind::upper: text = ascii ? "<= " : "\u2264 "; break;
    case Limit::Kind::lower: text = ascii ? ">= " : "\u2265 "; break;
    case Limit::Kind::equal: text = "= "; break;
  }
  text += with_unit(figures::display(check.limit.value, 6), check.unit);
  return ascii ? as_ascii(text) : text;
}

std::string ratio_text(double ratio) {
  if (!std::isfinite(ratio)) return "";
  return ratio < 1e6 ? fmt::format("{:.{}f}", ratio, ratio < 100.0 ? 2 : 0) : fmt::format("{:.2g}", ratio);
}

std::string calibration_levels(const RunResult& result) {
  std::set<CalibrationLevel> levels;
  for (const CaseResult& c : result.cases) levels.insert(c.calibration.level);
  std::string out;
  for (const CalibrationLevel level : levels) {
    if (!out.empty()) out += ", ";
    out += to_string(level);
  }
  return out.empty() ? "none" : out;
}

double coverage_k(const RunResult& result) {
  double k = std::numeric_limits<double>::quiet_NaN();
  for (const JudgedRow& row : judged_rows(result))
    if (const Check& c = *row.check; c.u > 0.0 && c.expanded_u > 0.0) k = std::fmin(k, c.expanded_u / c.u);
  return k;
}

bool accepts_marginal(const RunResult& result) {
  return result.decision.kind == DecisionKind::accept || result.decision_rule.starts_with("simple");
}

std::string who_must_act(Blame blame) {
  switch (blame) {
    case Blame::none: return "";
    case Blame::firmware: return "the firmware";
    case Blame::sensor: return "the sensor";
    case Blame::rig: return "the rig";
    case Blame::reference: return "the ATI reference";
    case Blame::link: return "the link to the board";
    case Blame::calibration: return "the calibration";
    case Blame::user: return "the plan, a bench file or the command line";
    case Blame::harness: return "Forcegate itself";
    case Blame::recording: return "the recording";
  }
  return "";
}

}  // namespace forcegate
