#include <algorithm>
#include <cmath>

#include "hil/base/text.h"
#include "hil/report/case_figures.h"
#include "hil/report/figures/bullet.h"
#include "hil/report/figures/text.h"
#include "hil/report/html_checks.h"
#include "hil/report/html_page.h"

namespace forcegate {
namespace {

using figures::display;
using figures::escape;
using figures::Figure;

figures::Role role_of(Verdict v) {
  switch (v) {
    case Verdict::pass: return figures::Role::pass;
    case Verdict::fail: return figures::Role::fail;
    case Verdict::not_run:
    case Verdict::waived: return figures::Role::muted;
    default: return figures::Role::warn;
  }
}

std::string bullet_of(const Check& c, double width_px) {
  if (c.limit.kind != Limit::Kind::upper && c.limit.kind != Limit::Kind::lower) return {};
  // A passed value of less than a hundredth of its limit is no bar that an eye could see.
  if (c.verdict == Verdict::pass && c.limit.kind == Limit::Kind::upper &&
      std::fabs(c.value) + 2.0 * c.u < 0.01 * std::fabs(c.limit.value))
    return {};
  return figures::bullet_svg({c.value, c.expanded_u > 0.0 ? c.expanded_u : 2.0 * c.u, c.limit.value,
                              c.limit.kind == Limit::Kind::lower, role_of(c.verdict),
                              value_text(c, Glyphs::unicode) + ", limit " + limit_text(c, Glyphs::unicode),
                              width_px});
}

std::string verdict_word(Verdict v) {
  return "<span class=\"w " + std::string(html_class(v)) + "\">" + std::string(symbol(v, Glyphs::unicode)) +
         " " + std::string(word(v)) + "</span>";
}

void add_fact(std::string& out, std::string_view name, const std::string& value_html) {
  if (!value_html.empty()) out += "<dt>" + std::string(name) + "</dt><dd>" + value_html + "</dd>";
}

std::string facts(const CaseResult& c) {
  std::string out = "<dl>";
  std::string profile = "<code>" + escape(c.stimulus) + "</code>";
  if (!c.parameter_source.empty()) profile += " (" + escape(c.parameter_source) + ")";
  profile += "<br>m = " + display(c.facts.mean_N, 3) + " N, A = " + display(c.facts.amplitude_N, 3) +
             " N, f = " + display(c.facts.lowest_frequency_Hz, 3) + " Hz, excitation from " +
             display(c.facts.excitation_start_s, 3) + " s";
  add_fact(out, "Profile", profile);
  add_fact(out, "Record",
           display(c.duration_s, 6) + " s, " + std::to_string(c.samples) + " samples, " + escape(c.loop) +
               " loop, lane " + escape(c.lane) + ", specimen " + escape(c.specimen) + ", seed " +
               std::to_string(c.seed));
  add_fact(out, "Calibration",
           std::string(to_string(c.calibration.level)) + " (" + escape(c.calibration.id) +
               "): G = " + display(c.calibration.gain_N_per_V, 5) +
               " N/V, F0 = " + display(c.calibration.offset_N, 4) + " N, b \u00d7 " +
               display(c.calibration.b_scale, 4) + ", q \u00d7 " + display(c.calibration.q_scale, 4));
  add_fact(out, "Lag", figures::typographic_minus(with_uncertainty(1e3 * c.lag_s, 1e3 * c.u_lag_s)) + " ms");
  if (c.decay.valid)
    add_fact(out, "Decay, eq. (3)",
             "a = " + figures::typographic_minus(with_uncertainty(c.decay.a_V, c.decay.u_a_V)) + " V, b = " +
                 figures::typographic_minus(with_uncertainty(c.decay.b_per_s, c.decay.u_b_per_s)) +
                 " 1/s, c = " + figures::typographic_minus(with_uncertainty(c.decay.c_V, c.decay.u_c_V)) +
                 " V, RMSE (8) " + display(c.decay.rmse_V, 2) + " V, raw maxima lose " +
                 display(c.decay.loss_pct, 3) + " %, n = " + std::to_string(c.decay.n));
  const DutCounters& l = c.link;
  add_fact(out, "Link",
           std::to_string(l.samples) + " samples; dropped " + std::to_string(l.frames_dropped) + ", bad " +
               std::to_string(l.frames_bad) + ", lost " + std::to_string(l.indices_lost) + ", overruns " +
               std::to_string(l.overruns) + ", refused " + std::to_string(l.naks) +
               (c.attempts > 1 ? "; attempt " + std::to_string(c.attempts) : ""));
  if (!c.trace_file.empty()) add_fact(out, "Samples", "<code>" + escape(c.trace_file) + "</code>");
  add_fact(out, "XXH3 of all samples", "<code>" + escape(c.digest) + "</code>");
  return out + "</dl>\n";
}

struct ExtremumRow {
  const std::string* series;
  double t_s, expected_N, actual_N, raw_N, error_N;
};

std::string extrema_table(const CaseResult& c) {
  std::vector<ExtremumRow> rows;
  for (const ExtremaSeries& e : c.extrema)
    for (std::size_t i = 0; i < std::min({e.t_s.size(), e.expected_N.size(), e.actual_N.size()}); ++i) {
      const double error = e.actual_N[i] - e.expected_N[i];
      if (std::isfinite(error))
        rows.push_back({&e.name, e.t_s[i], e.expected_N[i], e.actual_N[i],
                        i < e.raw_N.size() ? e.raw_N[i] : NAN, error});
    }
  if (rows.empty()) return {};
  const std::size_t all = rows.size(), shown = std::min<std::size_t>(12, all);
  std::stable_sort(rows.begin(), rows.end(), [](const ExtremumRow& a, const ExtremumRow& b) {
    return std::abs(a.error_N) > std::abs(b.error_N);
  });
  rows.resize(shown);
  const bool closed = c.loop == "closed", levels = levels_of(c) != nullptr;
  const std::string what = levels ? "levels" : "extrema";
  std::string out =
      "<details><summary>Largest errors of " + what +
      "</summary><div class=\"scroll\" tabindex=\"0\" "
      "role=\"group\" aria-label=\"Table of " +
      what + "\"><table><caption>" + std::to_string(shown) + " of " + std::to_string(all) + " " + what +
      ", largest error first; all are in result.json</caption><thead><tr>"
      "<th scope=\"col\">Kind</th><th scope=\"col\" class=\"n\">Time / s</th><th scope=\"col\" class=\"n\">";
  out += closed   ? "Set-point / N</th><th scope=\"col\" class=\"n\">ATI / N"
         : levels ? "Weights / N</th><th scope=\"col\" class=\"n\">Firmware / N"
                  : "ATI / N</th><th scope=\"col\" class=\"n\">Firmware / N";
  out += "</th><th scope=\"col\" class=\"n\">";
  out += levels ? "Conductance model / N" : "Raw sensor / N";
  out +=
      "</th><th scope=\"col\" class=\"n\">Error / N</th><th "
      "scope=\"col\" class=\"n\">Error / % of reading</th></tr></thead><tbody>\n";
  for (const ExtremumRow& r : rows) {
    const auto cell = [](double v, int decimals) {
      return "<td class=\"n\">" +
             (std::isfinite(v) ? figures::typographic_minus(figures::coordinate(v, decimals))
                               : std::string("n/a")) +
             "</td>";
    };
    const double relative = std::abs(r.expected_N) >= 0.5 ? 100.0 * r.error_N / std::abs(r.expected_N) : NAN;
    out += "<tr><td>" +
           std::string(levels                  ? "level"
                       : *r.series == "minima" ? "minimum"
                                               : "maximum") +
           "</td>" + cell(r.t_s, 3) + cell(r.expected_N, 3) + cell(r.actual_N, 3) + cell(r.raw_N, 3) +
           cell(r.error_N, 3) + cell(relative, 1) + "</tr>\n";
  }
  return out + "</tbody></table></div></details>\n";
}

std::string pictures(const CaseResult& c) {
  std::string out;
  const auto add = [&](const Figure& figure, const std::string& caption) {
    if (!figure.panels().empty())
      out += html_figure(figure.svg(Figure::Target::embedded), figure.title, caption);
  };
  const std::string reason = c.window_reason.empty() ? std::string("chosen cycles") : escape(c.window_reason);
  const Figure window = window_figure(c), overview = overview_figure(c), decay = decay_figure(c),
               levels = levels_figure(c), loop = loop_figure(c);
  add(window, "Window: " + reason + ". " + escape(window.summary));
  add(overview, "Whole record, decimated with its peaks kept. " + escape(overview.summary));
  add(decay, "Maxima \u25cf and minima \u25cb. " + escape(decay.summary));
  add(levels, "Every level of every loading. " + escape(levels.summary));
  if (case_verdict(c) !=
      Verdict::pass)  // explains an error; a passed case does without, for the size of the page
    add(loop, "Where in the cycle the error sits, darker = more samples. " + escape(loop.summary));
  if (out.empty())
    return "<p class=\"q\">The result holds no curves of this case" +
           std::string(case_verdict(c) == Verdict::pass ? ": every required check passed" : "") + ".</p>\n";
  return "<div class=\"figs\">\n" + out + "</div>\n";
}

}  // namespace

std::string_view html_class(Verdict verdict) { return figures::role_class(role_of(verdict)); }

std::string_view html_class(DecisionKind kind) {
  return kind == DecisionKind::accept ? "ok" : kind == DecisionKind::reject ? "no" : "wa";
}

std::string html_check_table(const std::vector<JudgedRow>& rows, const std::string& caption, bool with_case) {
  if (rows.empty()) return {};
  std::string out = "<div class=\"scroll\" tabindex=\"0\" role=\"group\" aria-label=\"" + escape(caption) +
                    "\"><table class=\"k\"><caption>" + escape(caption) +
                    "</caption><thead><tr><th scope=\"col\">Verdict</th>";
  if (with_case) out += "<th scope=\"col\">Case</th>";
  out +=
      "<th scope=\"col\">Check</th><th scope=\"col\" class=\"n\">Value(u)</th><th scope=\"col\" "
      "class=\"n\">Limit</th>"
      "<th scope=\"col\">Value \u00b1 U against limit</th></tr></thead><tbody>\n";
  for (const JudgedRow& row : rows) {
    const Check& c = *row.check;
    out += "<tr><td>" + verdict_word(c.verdict) + "</td>";
    if (with_case)
      out += "<td>" + (row.in_case == nullptr ? std::string("whole run") : escape(row.in_case->id)) + "</td>";
    out +=
        "<td class=\"c\">" + escape(c.title) + (c.required ? "" : " <span class=\"q\">(not required)</span>");
    std::string small = escape(c.evidence);
    if (!small.empty() && small.back() != '.') small += '.';
    if (!c.limit.source.empty())
      small += (small.empty() ? "" : " ") + std::string("Limit: ") + escape(c.limit.source) + ".";
    if (c.n > 0) small += " n = " + std::to_string(c.n) + ".";
    if (c.blame != Blame::none) small += " To act: " + who_must_act(c.blame) + ".";
    out += "<small><code>" + escape(c.id) + "</code> " + small + "</small></td><td class=\"n val\">" +
           escape(value_text(c, Glyphs::unicode)) + "</td><td class=\"n lim\">" +
           escape(limit_text(c, Glyphs::unicode)) + "</td><td class=\"bar\">";
    out += bullet_of(c, 190.0) + "</td></tr>\n";
  }
  return out + "</tbody></table></div>\n";
}

namespace {

// A sound rig is one line: its checks fill the page of every record and say nothing new. All are in result.json.
std::string sound_rig_row(const std::vector<const Check*>& checks) {
  std::string list;
  for (const Check* c : checks)
    list += (list.empty() ? "" : "; ") + escape(c->id) + " " + escape(value_text(*c, Glyphs::unicode)) + " " +
            escape(limit_text(*c, Glyphs::unicode));
  return "<tr><td>" + verdict_word(Verdict::pass) + "</td><td class=\"c\" colspan=\"4\">" +
         std::to_string(checks.size()) +
         (checks.size() == 1 ? " check of the rig<small>" : " checks of the rig<small>") + list +
         "</small></td></tr>\n";
}

}  // namespace

std::string html_case(const CaseResult& c, std::size_t number, bool open) {
  const Verdict verdict = case_verdict(c);
  std::vector<JudgedRow> rows;
  std::vector<const Check*> sound_rig;
  const Check* nearest = nullptr;
  double ratio = -1.0;
  for (const Check& check : c.checks) {
    const double r = ratio_to_limit(check);
    if (check.id.starts_with("rig_") && check.verdict == Verdict::pass)
      sound_rig.push_back(&check);
    else
      rows.push_back({&check, &c, r});
    if (std::isfinite(r) && r > ratio) {
      ratio = r;
      nearest = &check;
    }
  }
  std::string filter_text = printable_utf8(c.id + " " + c.title + " " + c.specimen);
  std::transform(filter_text.begin(), filter_text.end(), filter_text.begin(),
                 [](char ch) { return ch >= 'A' && ch <= 'Z' ? static_cast<char>(ch + 32) : ch; });
  std::string out = "<details class=\"case " + std::string(html_class(verdict)) + "\" id=\"case-" +
                    std::to_string(number) + "\" data-v=\"" + std::string(word(verdict)) + "\" data-t=\"" +
                    escape(filter_text) + "\"" + (open ? " open" : "") + "><summary>" +
                    verdict_word(verdict) + "<span class=\"id\">" + escape(c.id) + "</span><span>" +
                    escape(c.title) + "</span>";
  if (nearest != nullptr)
    out += "<span class=\"q\">nearest to its limit: " + escape(nearest->id) + " " +
           escape(value_text(*nearest, Glyphs::unicode)) + " of " +
           escape(limit_text(*nearest, Glyphs::unicode)) + "</span>";
  out += "</summary><div class=\"in\">\n";
  if (!c.note.empty()) out += "<p><b>" + escape(c.note) + "</b></p>\n";
  std::string table = html_check_table(rows, "Checks of this case", false);
  if (const std::size_t end = table.rfind("</tbody>"); end != std::string::npos && !sound_rig.empty())
    table.insert(end, sound_rig_row(sound_rig));
  out += table + pictures(c) + extrema_table(c);
  return out + "<details><summary>Profile, calibration, link, hash</summary>" + facts(c) +
         "</details></div></details>\n";
}

}  // namespace forcegate
