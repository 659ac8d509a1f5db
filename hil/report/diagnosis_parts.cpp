#include "hil/report/diagnosis_parts.h"

#include <algorithm>
#include <cctype>
#include <cmath>

#include "hil/base/plain_number.h"
#include "hil/report/diagnosis_figures.h"
#include "hil/report/figures/plots.h"
#include "hil/report/figures/text.h"
#include "hil/report/html_page.h"

namespace forcegate::parts {

using figures::display;
using figures::escape;
using figures::Figure;

std::string in_unit(double value, const std::string& unit) {
  const figures::Scaled scale = figures::readable_unit(value, unit);
  return display(value * scale.factor, 3) + " " + scale.unit;
}

std::pair<std::string, std::string> in_one_unit(double a, double b, const std::string& unit) {
  constexpr double kMost = 1e4;
  const double small = std::min(std::fabs(a), std::fabs(b)), large = std::max(std::fabs(a), std::fabs(b));
  figures::Scaled scale = figures::readable_unit(small, unit);
  if (!(small > 0.0) || large * scale.factor >= kMost) scale = figures::readable_unit(large, unit);
  const auto text = [&](double value) { return display(value * scale.factor, 3) + " " + scale.unit; };
  return {text(a), text(b)};
}

ErrorTexts in_one_unit(double before, double after, double floor, const std::string& unit) {
  constexpr double kLeast = 0.01, kMost = 1e4;
  const auto [first, second] = in_one_unit(before, after, unit);
  const std::string shown = first.substr(first.rfind(' ') + 1), own = in_unit(floor, unit);
  if (!(floor > 0.0) || own.ends_with(" " + shown)) return {first, second, own};
  const PrintedUnit text = printed_unit(unit);
  const auto fits = [&](double value) { return value == 0.0 || (std::fabs(value) * text.factor >= kLeast && std::fabs(value) * text.factor < kMost); };
  if (!fits(before) || !fits(after) || !fits(floor)) return {first, second, own};
  const auto in_text = [&](double value) { return display(value * text.factor, 3) + " " + text.name; };
  return {in_text(before), in_text(after), in_text(floor)};
}

std::string one_law_sentence(const Diagnosis& d) {
  constexpr double kRises = 1.02;
  const bool rises = d.plain_before > 0.0 && d.plain_after > kRises * d.plain_before;
  if (!differs_between_records(d) && !rises) return {};
  const figures::Scaled scale = figures::readable_unit(d.plain_before > 0.0 ? d.plain_before : d.plain_after, d.unit);
  const auto number = [&](double error) { return display(error * scale.factor, 3); };
  const std::string after = number(d.plain_after) + " " + scale.unit, verb = d.plain_after > d.plain_before ? " rises to " : " falls to ";
  const bool changes = d.plain_before > 0.0 && number(d.plain_before) != number(d.plain_after);
  const std::string change = changes ? number(d.plain_before) + " " + scale.unit + verb + after : after;
  return "; with one gain, offset and decay for all records " + change;
}

std::string picture(const Figure& figure, std::string_view more) {
  if (figure.panels().empty()) return {};
  std::string summary = figure.summary;
  if (!more.empty() && !summary.empty())  // it begins a sentence
    summary[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(summary[0])));
  std::string caption = figures::typographic_minus(escape(summary));
  if (!more.empty()) caption = escape(more) + (caption.empty() ? "" : " " + caption);
  return html_figure(figure.svg(Figure::Target::embedded), figure.title, caption);
}

std::string table_start(const std::string& caption, std::initializer_list<std::string_view> heads) {
  std::string out = "<div class=\"scroll\" tabindex=\"0\" role=\"group\" aria-label=\"" + escape(caption) +
                    "\"><table><caption>" + escape(caption) + "</caption><thead><tr>";
  for (const std::string_view head : heads)
    out += head.starts_with('#') ? "<th scope=\"col\" class=\"n\">" + std::string(head.substr(1)) + "</th>"
                                 : "<th scope=\"col\">" + std::string(head) + "</th>";
  return out + "</tr></thead><tbody>\n";
}

std::string cell(const std::string& html, bool number) {
  return std::string(number ? "<td class=\"n\">" : "<td>") + html + "</td>";
}

std::string between_records(const RecordPictures& p) {
  std::string out;
  if (!p.levels.empty()) out += picture(levels_figure(p));
  for (const DriftCourse& c : p.drift) out += picture(drift_figure(c, p.unit));
  return out;
}

std::string evidence(const Finding& f, JudgedBy judged_by) {
  constexpr std::size_t kMostPictures = 4;
  std::string out;
  for (std::size_t i = 0; i < std::min(kMostPictures, f.series.size()); ++i) {
    const EvidenceSeries& s = f.series[i];
    const std::string of = s.record.empty() ? "" : "Record " + s.record + (judged_by == JudgedBy::whole ? "." : ", which neither fit has seen.");
    out += picture(evidence_figure(s), of);
  }
  for (const SampleWindow& w : f.samples) out += picture(sample_figure(w), "Record " + w.record + ".");
  return out;
}

}  // namespace forcegate::parts
