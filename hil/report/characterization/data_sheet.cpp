#include "hil/report/characterization/data_sheet.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hil/base/plain_number.h"
#include "hil/base/units.h"
#include "hil/report/characterization/paper_tables.h"
#include "hil/report/figures/text.h"
#include "hil/report/html_page.h"

namespace forcegate {
namespace {

using characterize::SensorStudy;
using characterize::SessionSheet;
using characterize::Spread;
using figures::escape;

struct Section {
  const char *prefix, *title;
};
constexpr Section kSections[] = {
    {"static.", "Static properties"},   {"step.", "Step response"},
    {"harmonic.", "Sinusoidal load"},   {"erratic.", "Erratic maxima"},
    {"jump.", "Jump of the frequency"}, {"cycling.", "Static gain after cycling"},
    {"recovery.", "Recovery at rest"},  {"identified.", "Identified decay"},
    {"control.", "Force control"},      {"tms.", "Robotised TMS"},
    {"recording.", "Recordings"}};

std::string number(double v, const char* style = "n") {
  return fmt::format("<td class=\"{}\">{}</td>", style, escape(figures::display(v, 3)));
}

std::string section_table(const SensorStudy& study, const Section& section) {
  std::string rows;
  for (const Spread& s : study.spreads) {
    if (!s.key.starts_with(section.prefix)) continue;
    const auto of_several = [&](double quantile) { return number(s.n > 1 ? quantile : std::nan("")); };  // one value has none
    rows += "<tr><th scope=\"row\">" + escape(s.title) + "</th><td>" + escape(std::string(unit_in_text(s.unit))) + "</td>" +
            number(s.mean) + number(s.sd_specimens) + (study.of_recordings ? "" : number(s.sd_sessions)) + of_several(s.q05) +
            of_several(s.median) + of_several(s.q95) + fmt::format("<td class=\"n\">{}</td></tr>\n", s.n);
  }
  if (rows.empty()) return {};
  return fmt::format(
             "<section><h2>{0}</h2><div class=\"scroll\" tabindex=\"0\" role=\"group\" aria-label=\"{0}\"><table><thead><tr>"
             "<th scope=\"col\">Quantity</th><th scope=\"col\">Unit</th>"
             "<th scope=\"col\" class=\"n\">Mean</th>{1}<th scope=\"col\" class=\"n\">5 %</th>"
             "<th scope=\"col\" class=\"n\">Median</th><th scope=\"col\" class=\"n\">95 %</th><th scope=\"col\" class=\"n\">n</th></tr></thead><tbody>\n",
             section.title,
             study.of_recordings ? "<th scope=\"col\" class=\"n\">sd of recordings</th>"
                                 : "<th scope=\"col\" class=\"n\">sd of specimens</th><th scope=\"col\" class=\"n\">sd of sessions</th>") +
         rows + "</tbody></table></div></section>\n";
}

std::string with_se(double value, double se, int decimals) {
  return std::isfinite(se) ? fmt::format("({:.{}f} &plusmn; {:.{}f})", value, decimals, se, decimals) : fmt::format("{:.{}f}", value, decimals);
}

std::string laws_section(const SensorStudy& study) {
  if (!study.laws.available) return {};
  const auto& l = study.laws.fitted;
  std::string out = fmt::format(
      "<section><h2>Laws of the decay</h2><p>Umax = Umin + a e<sup>-bt</sup> + c with a = {} A&sup2; + {} A V, b = {} f + {} 1/s, "
      "c/a = 1/(1 + {} A&sup2;); {} records of {}.</p>\n",
      with_se(l.a2_V_per_N2, l.se_a2, 3), with_se(l.a1_V_per_N, l.se_a1, 3), with_se(l.b1_s_per_s, l.se_b1, 5),
      with_se(l.b0_per_s, l.se_b0, 5), with_se(l.k_per_N2, l.se_k, 3), l.records, counted(l.specimens, "specimen"));
  out +=
      "<div class=\"scroll\" tabindex=\"0\" role=\"group\" aria-label=\"Errors of the laws\"><table>"
      "<caption>Errors of the laws, %</caption><thead><tr><th scope=\"col\">Records</th><th scope=\"col\">Specimens</th>"
      "<th scope=\"col\" class=\"n\">a</th><th scope=\"col\" class=\"n\">b</th><th scope=\"col\" class=\"n\">c</th>"
      "<th scope=\"col\" class=\"n\">MRE of the maxima</th><th scope=\"col\" class=\"n\">n</th></tr></thead><tbody>\n";
  for (const auto& s : study.laws.scores)
    out += "<tr><th scope=\"row\">" + escape(s.set) + "</th><td>" + escape(s.group) + "</td>" +
           number(s.mean.a_pct) + number(s.mean.b_pct) + number(s.mean.c_pct) + number(s.mean.mre_pct) +
           fmt::format("<td class=\"n\">{}</td></tr>\n", s.records);
  return out + "</tbody></table></div></section>\n";
}

std::string notes(const SensorStudy& study) {
  std::string out;
  for (const SessionSheet& s : study.sheets)
    for (const std::string& note : s.notes) out += "<li>" + escape(s.specimen + ": " + note) + "</li>\n";
  return out.empty() ? out : "<section><h2>Notes</h2><ul>" + out + "</ul></section>\n";
}

std::string failures(const SensorStudy& study) {
  std::string out;
  for (const SessionSheet& s : study.sheets)
    if (s.failure)
      out += "<li>" + escape(fmt::format("{}, session {}: {}", s.specimen, s.session, s.failure->text)) +
             "</li>\n";
  return out.empty() ? out : "<section><h2>Sessions that failed</h2><ul>" + out + "</ul></section>\n";
}

// Whose curves the pictures show.
std::string drawn(const SensorStudy& study) {
  const SessionSheet& e = study.exemplar;
  const bool is_counted = std::ranges::any_of(study.sheets, [&](const SessionSheet& s) { return s.specimen == e.specimen; });
  return escape(fmt::format(" Drawn: specimen {}, session {}{}.", e.specimen, e.session, is_counted ? "" : ", which is in no table"));
}

std::string bench_time(double seconds) {
  return seconds < 7200.0 ? fmt::format("{:.1f} min", seconds / 60.0)
                          : fmt::format("{:.0f} h", seconds / 3600.0);
}

}  // namespace

std::string data_sheet_html(const SensorStudy& study, const characterize::StudyPlan& plan,
                            const std::string& command) {
  const std::string name = study.sensor == "fsr"          ? "Interlink FSR"
                           : study.sensor == "flexiforce" ? "Tekscan FlexiForce A201"
                                                          : study.sensor;
  std::size_t specimens = 0, sessions = 0;
  std::string last;
  for (const SessionSheet& s : study.sheets) {
    if (s.specimen != last) ++specimens;
    last = s.specimen;
    ++sessions;
  }
  HtmlPage page;
  page.title = "Data sheet: " + name;
  page.body = "<header class=\"ok\"><div><h1>" + escape(name) + "</h1>\n<p class=\"why\">" +
              escape(fmt::format(
                  "{}, {} of bench time{}",
                  study.of_recordings ? counted(sessions, "recording") : counted(specimens, "specimen") + ", " + counted(sessions, "session"), bench_time(study.rig_time_s),
                  plan.name.empty() ? "" : fmt::format("; plan {}, seed {}", plan.name, plan.seed))) +
              "</p></div></header>\n<main>\n";
  page.body += notes(study);
  for (const Section& section : kSections) page.body += section_table(study, section);
  page.body += laws_section(study) + failures(study);
  for (const PaperPicture& p : figures_of_the_paper({study}))
    page.body +=
        html_figure(p.figure.svg(figures::Figure::Target::embedded), p.figure.title,
                    "<b>" + escape(p.place) + "</b> " + figures::typographic_minus(escape(p.caption)) + drawn(study));
  page.body += "<section><h2>Reproduce</h2><pre tabindex=\"0\" aria-label=\"Command\"><code>" +
               escape(command) + "</code></pre></section>\n</main>\n";
  return html_document(page);
}

}  // namespace forcegate
