#include "hil/report/diagnosis_html.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "hil/base/plain_number.h"
#include "hil/base/text.h"
#include "hil/report/diagnosis_figures.h"
#include "hil/report/diagnosis_parts.h"
#include "hil/report/finding_side.h"
#include "hil/report/figures/text.h"
#include "hil/report/html_page.h"
#include "hil/report/overlay_figure.h"

namespace forcegate {
namespace {

using namespace parts;
using figures::display;
using figures::escape;

using Answer = decltype(Diagnosis::verdict);
constexpr std::size_t kMostOverlays = 12, kMostMaps = 6;

// What the same search finds where there is nothing to find: chance when the residual is noise, leftovers when it is not.
std::string chance_sentence(const Diagnosis& d) {
  if (d.ranking.empty()) return {};
  if (d.expected_false < 0.5)
    return "With the signs of what is left turned over by chance, " + display(d.expected_false, 2) +
           " effects pass the threshold: chance alone claims hardly anything here.";
  return "What is left is no noise: with its signs turned over by chance, " + display(d.expected_false, 2) +
         (display(d.expected_false, 2) == "1" ? " effect still passes" : " effects still pass") +
         " the threshold. What ranks without a claim may be a leftover of something else.";
}

std::string header(const Diagnosis& d, const DiagnosisPage& page, bool has_looks) {
  const bool comparison = page.comparison;
  const bool fits = comparison ? is_noise(d.error_before, d.floor) : d.verdict == Answer::none && beside_none(d).empty();
  const std::string colour = fits ? "ok" : comparison || d.verdict != Answer::unknown ? "wa" : "no";
  std::string out = "<header class=\"" + (page.lead ? page.lead->colour : colour) + "\"><div><h1>" +
                    escape(page.lead    ? page.lead->headline
                           : comparison ? "How far " + d.model + " is from " + d.campaign
                                        : diagnosis_headline(d)) +
                    "</h1>\n<p class=\"why\">";
  const bool rig = d.errors.contains("F");
  const double before = rig ? d.errors.at("F").before : d.error_before,
               after = rig ? d.errors.at("F").after : d.error_after;
  const std::string unit = rig ? d.errors.at("F").unit : d.unit;
  const auto [shown_before, shown_after, shown_floor] = in_one_unit(before, comparison ? before : after, rig ? 0.0 : d.floor, unit);
  out += page.lead ? escape(page.lead->why) : error_title(d.judged_by) + " " + escape(shown_before);
  if (!comparison && !page.lead && shown_before != shown_after)
    out += (after < before ? " falls to " : " rises to ") + escape(shown_after) + (rig ? "" : escape(unclaimed_share(d)));
  if (d.floor > 0.0 && !rig) out += "; noise floor " + escape(shown_floor);
  if (!rig) out += escape(one_law_sentence(d));
  out += ".</p>\n<ul class=\"facts\">";
  const auto fact = [&](std::string_view name, const std::string& html) {
    if (!html.empty()) out += "<li>" + std::string(name) + " <b>" + html + "</b></li>";
  };
  fact("campaign", escape(d.campaign));
  fact("model", escape(d.model));
  if (d.single)
    fact("one recording, parts", std::to_string(d.records.size()));
  else if (!d.records.empty())
    fact("records", std::to_string(d.records.size()));
  if (d.force_range_N > 0.0) fact("force range", display(d.force_range_N, 3) + " N");
  if (d.residual_unknown) fact("besides,", "structure remains that no listed effect explains");
  // beside rivals that fit, what the rest of the residual goes with is no part of the answer
  if (!d.depends_on.empty() && d.not_separable.empty()) fact(d.residual_unknown ? "that structure depends on" : "it depends on", escape(join(d.depends_on, ", ")));
  if (!d.follows.empty()) fact("it follows", escape(join(d.follows, " and ")));
  out += "</ul><nav aria-label=\"Sections\">";
  const auto section = [&](bool there, std::string_view id, std::string_view name) {
    if (there) out += "<a href=\"#" + std::string(id) + "\">" + std::string(name) + "</a>";
  };
  if (page.lead) section(true, page.lead->id, page.lead->name);
  section(!comparison && !page.lead, "missing", "What is missing");
  section(!d.maps.empty(), "where", "Where it fails");
  section(has_looks, "looks", "Spectrum, turning points and level");
  section(!d.ranking.empty(), "ranking", "Ranking");
  section(!d.records.empty(), "records", "Records");
  section(!d.next_experiment.sentence.empty(), "next", "What to measure next");
  return out + "</nav></div></header>\n";
}

// `more`: the level of the records beside the first claim that acts between them.
std::string finding(const Finding& f, JudgedBy judged_by, bool one_recording, bool open, const std::string& more) {
  const bool claim = f.claimed();
  std::string out =
      "<details class=\"case " + std::string(claim ? "wa" : "mu") + "\"" + (open ? " open" : "") +
      "><summary><span class=\"id\">" + escape(f.effect) + "</span><span>" + escape(shown_side(f)) + "</span><span class=\"w " + (claim ? "wa" : "mu") +
      "\">" + (f.in_model ? "in the model already" : fmt::format("{}, probability {}", claim ? "claimed" : "not claimed", probability_text(f.probability))) +
      "</span></summary><div class=\"in\">\n<p>" + escape(f.evidence) + "</p>\n<dl>";
  const auto fact = [&](std::string_view name, const std::string& html) {
    if (!html.empty()) out += "<dt>" + std::string(name) + "</dt><dd>" + html + "</dd>";
  };
  // a fault that is seen in the raw samples is no term of the model: the fall of the error is not its doing. A rival was not taken in
  if (!f.of_samples() && f.error_before > 0.0) {
    fact(f.of_every_record ? "Error of every record, predicted from the others" : error_title(judged_by),
         escape(in_one_unit(f.error_before, f.error_after, f.unit).first + " \u2192 " + in_one_unit(f.error_before, f.error_after, f.unit).second));
    if (f.effect_rms > 0.0) fact("Effect", escape(in_unit(f.effect_rms, f.unit)) + " RMS");
  }
  fact("Form", escape(f.form));
  if (f.records_excited > 0)
    fact(one_recording ? "Parts" : f.counts_parts ? "Parts of records" : "Records", std::to_string(f.records_improved) + " of " + std::to_string(f.records_excited) +
                        " that excite it are better with it");
  for (const FoundParameter& p : f.parameters)
    fact(escape(p.name), escape(figures::typographic_minus(with_uncertainty(p.value, p.u)) +
                                (p.unit.empty() || p.unit == "1" ? "" : " " + p.unit)));
  out += "</dl>\n";
  if (!f.confounded_with.empty()) {
    out += table_start("Look-alikes: on these records they fit about equally well",
                       {"Effect", "Likeness |cos|", "What separates them"});
    for (const LookAlike& l : f.confounded_with)
      out += "<tr>" + cell(escape(l.effect)) + cell(l.cosine != 0.0 ? fmt::format("{:.2f}", std::abs(l.cosine)) : "\u2013") +
             cell(escape(l.separates)) + "</tr>\n";
    out += kTableEnd;
  }
  out += more + evidence(f, judged_by);
  return out + "</div></details>\n";
}

bool is_claimed_between_records(const Finding& f) { return f.claimed() && f.between_records; }

bool differs_without_cause(const Diagnosis& d) {
  return d.verdict == Answer::unknown && d.not_separable.empty() && !d.follows.empty() && differs_between_records(d);
}

// Gain and zero of every record stand beside what they show.
bool levels_are_the_answer(const Diagnosis& d) { return differs_without_cause(d) || std::ranges::any_of(d.findings, is_claimed_between_records); }

std::string missing(const Diagnosis& d, const RecordPictures& pictures) {
  std::string out = "<section id=\"missing\"><h2>What is missing</h2>\n";
  if (d.findings.empty()) {
    out += differs_without_cause(d) ? ""
           : d.verdict == Answer::unknown
               ? "<p>No listed effect has this shape." + std::string(d.maps.empty() ? "" : " The maps below show where the error lives.") + "</p>\n"
               : "<p>No listed effect lowers the error of " + std::string(d.single ? "parts" : "records") +
                     " that were not fitted. " + (d.far_above.empty() ? "What is left is noise for these inputs; it" : "What is left is noise, but " + escape(beside_none(d)) + ". It") + " says nothing about inputs that were not played.</p>\n";
  }
  std::size_t opened = 0;
  bool drawn = false;
  for (const Finding& f : d.findings) {
    const bool here = !drawn && is_claimed_between_records(f);
    drawn |= here;
    out += finding(f, d.judged_by, d.single, f.claimed() && opened++ < 3, here ? between_records(pictures) : "");
  }
  if (differs_without_cause(d))
    out += "<p>Each record is described to its noise by a gain and zero of its own, and nothing that was recorded says why they differ.</p>\n" + between_records(pictures);
  const bool rig = shows_rig(d);
  const bool moves = !d.not_separable.empty() ||
                     std::ranges::any_of(d.findings, [&](const Finding& f) { return f.claimed() && !is_of_rig(d, f); });
  if (rig) out += "<h3>Error over the versions of the rig's law</h3>\n" + picture(rig_waterfall(d));
  if (moves) out += "<h3>Error over the versions of the model</h3>\n" + picture(diagnosis_waterfall(d));
  return out + "</section>\n";
}

std::string where(const Diagnosis& d) {
  constexpr std::string_view kWhiskers = "Whiskers are U, k = 2.";
  if (d.maps.empty()) return {};
  std::string out = "<section id=\"where\"><h2>Where it fails</h2>\n";
  if (shows_rig(d)) out += "<p>The output at the recorded force, whatever the rig did.</p>\n";
  out += "<ul>";
  std::size_t said = 0;
  for (const ResidualMap& m : d.maps)
    if (m.share > 0.0 && said++ < 5)
      out += "<li>" + figures::typographic_minus(escape(m.sentence)) + " (share of the residual's variance " +
             display(100.0 * m.share, 2) + " %)</li>";
  if (said == 0) out += "<li>No coordinate predicts the residual on rows that it was not made from.</li>";
  const bool changed = has_after(d);
  out += "</ul>\n<div class=\"figs\">" +
         picture(residual_map_figure(d, false), changed                ? "Before."
                                                : d.maps_after.empty() ? ""
                                                                       : "Nothing entered the model: before and after are one.");
  if (changed) out += picture(residual_map_figure(d, true), "After, same colours.");
  out += "</div>\n<div class=\"figs s\">";
  std::size_t drawn = 0;
  for (const ResidualMap& m : d.maps) {
    if (drawn++ == kMostMaps) break;
    const auto after = std::find_if(d.maps_after.begin(), d.maps_after.end(),
                                    [&](const ResidualMap& a) { return a.coordinate == m.coordinate; });
    out += picture(coordinate_figure(m, !changed || after == d.maps_after.end() ? nullptr : &*after, d.unit),
                   kWhiskers);
  }
  out += "</div>\n";
  if (!d.rig_maps.empty()) out += "<h3>What the output cannot show</h3>\n<p>Sensor and reference feel this alike: only the rig's own law shows it.</p>\n<div class=\"figs\">";
  for (const ResidualMap& m : d.rig_maps) out += picture(rig_coordinate_figure(m), kWhiskers);
  return out + (d.rig_maps.empty() ? "" : "</div>\n") + "</section>\n";
}

// What the residual looks like along time and over the records; a line where the records cannot show it.
std::string looks(const Diagnosis& d, const RecordPictures& p) {
  std::string out;
  for (const ResidualSpectrum& s : p.spectra) out += picture(spectrum_figure(s, p.unit, claims_hum(d)), "Record " + s.record + ".");
  for (const ExtremaDecay& e : p.extrema) out += picture(extrema_figure(e, p.unit), "Record " + e.record + ".");
  if (!out.empty()) out = "<div class=\"figs\">" + out + "</div>\n";
  if (!levels_are_the_answer(d)) out += between_records(p);
  for (const std::string& why : p.missing) out += "<p>" + escape(why) + "</p>\n";
  if (out.empty()) return out;
  return "<section id=\"looks\"><h2>Spectrum, turning points and level</h2>\n" + out + "</section>\n";
}

std::string whole_percent(double share) {
  return fmt::format("{:.0f}", std::round(100.0 * share) + 0.0);  // never "-0"
}

// What is rounded to nothing has no sign.
std::string tenths(double value) { return figures::typographic_minus(fmt::format("{:.1f}", std::round(10.0 * value) / 10.0 + 0.0)); }

std::string ranking(const Diagnosis& d) {
  if (d.ranking.empty()) return {};
  std::string out = "<section id=\"ranking\"><h2>Ranking</h2>\n<p>" + escape(chance_sentence(d)) + "</p>\n" +
                    picture(ranking_figure(d)) +
                    table_start("Every effect that these records can excite",
                                {"Effect", "Side", "#Probability", "#Log evidence", "#Chance level (95 %)",
                                 "#Alone / %", "#Only it / %", "Note"});
  for (const RankedEffect& r : d.ranking)
    out += "<tr>" + cell(escape(r.effect) + (r.form.empty() ? "" : "<small>" + escape(r.form) + "</small>")) +
           cell(escape(r.side)) + cell(probability_text(r.probability), true) +
           cell(tenths(r.score), true) + cell(tenths(r.null_score), true) +
           cell(whole_percent(r.alone), true) + cell(whole_percent(r.unique), true) + cell(escape(r.note)) + "</tr>\n";
  return out + std::string(kTableEnd) + "</section>\n";
}

std::string records(const Diagnosis& d) {
  if (d.records.empty()) return {};
  const bool no_input = !(d.force_range_N > 0.0);
  const bool any_heldout = std::ranges::any_of(d.records, &RecordError::heldout);
  const std::string role = any_heldout                      ? "fitted"
                           : d.judged_by == JudgedBy::whole ? "fitted as a whole"
                           : d.records.size() > 1           ? "left out in turn"
                           : no_input                       ? "in tenths"
                                                            : "in blocks";
  const PrintedUnit unit = printed_unit(d.unit);
  const auto shown = [&](double error, int digits) { return cell(display(unit.factor * error, digits), true); };
  const bool changed = std::ranges::any_of(d.records, [](const RecordError& r) { return r.before != r.after || r.plain_before != r.plain_after; });
  const std::string caption = "RMS error of each record in " + unit.name +
                              (no_input   ? " on tenths of it that were left out"
                               : d.levels ? " (the decay of the record may follow the data, gain and offset are those of all)"
                                          : " (gain, offset and decay of the record may follow the data)");
  std::string out = "<section id=\"records\"><h2>Records</h2>\n" + picture(record_error_figure(d)) +
                    (changed ? table_start(caption, {"Record", "Kind", "Role", "#Before", "#After", "#Plain before", "#Plain after", "#Noise", "#Explainable / %"})
                             : table_start(caption, {"Record", "Kind", "Role", "#Error", "#Plain", "#Noise", "#Explainable / %"}));
  for (const RecordError& r : d.records)
    out += "<tr>" + cell(escape(r.record)) + cell(escape(r.kind)) + cell(r.heldout ? "held out" : role) + shown(r.before, 3) +
           (changed ? shown(r.after, 3) : "") + shown(r.plain_before, 3) + (changed ? shown(r.plain_after, 3) : "") + shown(r.floor, 2) +
           cell(display(std::round(100.0 * r.explainable), 3), true) + "</tr>\n";
  out += kTableEnd;
  if (!d.overlays.empty()) {
    std::set<std::string> records;
    for (const EvidenceSeries& series : d.overlays) records.insert(series.record);
    const bool some = records.size() < d.records.size() || records.size() > kMostOverlays;
    out += "<details><summary>Measured and modelled output of " + (some ? fmt::format("{} of {} records", std::min(records.size(), kMostOverlays), d.records.size()) : "the records") +
           "</summary><div class=\"figs\">";
    std::size_t drawn = 0;
    for (std::size_t i = 0; i < d.overlays.size() && drawn++ < kMostOverlays; ++i) {
      const EvidenceSeries& whole = d.overlays[i];
      const bool followed = i + 1 < d.overlays.size() && d.overlays[i + 1].record == whole.record;
      out += picture(record_overlay_figure(whole, followed ? &d.overlays[++i] : nullptr), "Record " + whole.record + ".");
    }
    out += "</div></details>\n";
  }
  if (no_input) return out + "</section>\n";
  const Repeatability& s = d.repeatability;
  out += "<p class=\"q\">Spread from record to record: gain " + display(100.0 * s.gain, 2) + " %, offset " +
         escape(in_unit(s.offset_V, d.unit)) +
         (std::isfinite(s.log_b) ? ", decay rate " + display(100.0 * s.log_b, 2) + " %, decay depth " + display(100.0 * s.log_q, 2) + " %" : "") + ".</p>\n";
  return out + "</section>\n";
}

std::string next(const Diagnosis& d) {
  if (d.next_experiment.sentence.empty()) return {};
  if (d.next_experiment.segments.empty()) return "<section id=\"next\"><h2>What to measure next</h2>\n<p>" + escape(d.next_experiment.sentence) + "</p></section>\n";
  std::string out =
      "<section id=\"next\"><h2>What to measure next</h2>\n<p>" + escape(d.next_experiment.sentence) +
      "</p>\n" +
      table_start("Segments for the rig, " + display(d.next_experiment.minutes, 3) +
                      " min in all; a later one starts from what those above it leave",
                  {"Segment", "Stimulus", "#Minutes", "Separates", "Likeness before \u2192 after",
                   "Odds before \u2192 after"});
  for (const ExperimentSegment& s : d.next_experiment.segments) {
    std::string words = s.stimulus + ": " + parameters_text(s, static_cast<std::size_t>(&s - d.next_experiment.segments.data()) + 1, " = ", ", ");
    if (s.heats) words += fmt::format(" while it warms up by {:g} degC", s.rise_degC);
    out += "<tr>" + cell(escape(s.name)) + cell(escape(words)) +
           cell(display(s.minutes, 3), true) + cell(escape(s.separates)) +
           cell(fmt::format("{:.2f} \u2192 {:.2f}", s.cosine_before, s.cosine_after)) +
           cell(escape(odds_text(s.odds_before) + " \u2192 " + odds_text(s.odds_after))) + "</tr>\n";
  }
  return out + std::string(kTableEnd) +
         "<p><code>forcegate next</code> with the campaign writes these forces as files (<code>-o FOLDER</code>) or plays them (<code>--run</code>).</p></section>\n";
}

// A comparison has none; its samples that were set aside count before alone.
Diagnosis without_after(Diagnosis d) {
  for (RecordError& r : d.records) r.after = r.before, r.plain_after = r.plain_before;
  return d;
}

}  // namespace

std::string diagnosis_headline(const Diagnosis& d) {
  if (d.verdict == Answer::none && !suspicions_beside_none(d).empty()) return "Nothing is claimed; " + beside_none(d);
  if (d.verdict == Answer::none) return "Nothing is missing that these records can show" + (d.far_above.empty() ? std::string() : "; but " + beside_none(d));
  if (d.verdict == Answer::unknown && !d.not_separable.empty())
    return "Something is missing; these records cannot tell which: " + join(d.not_separable.front(), " or ");
  if (const Finding* open = open_name(d); open != nullptr)
    return "Something is missing; " + open->effect + " would explain it and is not claimed" + (d.follows.empty() ? std::string() : "; it follows " + join(d.follows, " and "));
  if (d.verdict == Answer::unknown)
    return "Something is missing that no listed effect explains" +
           (!d.follows.empty()      ? "; it follows " + join(d.follows, " and ")
            : d.depends_on.empty() ? std::string()
                                   : "; it depends on " + join(d.depends_on, ", "));
  std::string out = "Missing: ", separator;
  for (const Finding& f : d.findings) {
    if (!f.claimed()) continue;
    out +=
        separator + f.effect + " (" + shown_side(f) + ", probability " + probability_text(f.probability) + ")";
    separator = ", ";
  }
  return out;
}

std::string diagnosis_html(const Diagnosis& shown, const DiagnosisPage& page) {
  const Diagnosis d = page.comparison ? without_after(shown) : shown;
  HtmlPage html;
  html.title = page.lead ? page.lead->headline : (page.comparison ? "Comparison with " : "Diagnosis of ") + d.campaign;
  const std::string of_residual = looks(d, page.pictures);
  html.body = header(d, page, !of_residual.empty()) + "<main>\n" +
              (page.lead ? page.lead->section : page.comparison ? "" : missing(d, page.pictures)) + where(d) +
              of_residual + ranking(d) +
              records(d) + next(d);
  const std::vector<RefusedEffect> refused = refused_beside_findings(d);
  if (!d.notes.empty() || !refused.empty()) {
    html.body += "<section><h2>Notes</h2><ul>";
    for (const std::string& note : d.notes) html.body += "<li>" + escape(note) + "</li>";
    for (const RefusedEffect& r : refused) html.body += "<li>" + escape("not taken: " + r.effect + ": " + std::string(diagnose::traits_of(r.reason).sentence)) + "</li>";
    html.body += "</ul></section>\n";
  }
  if (!page.command_line.empty())
    html.body += "<section><h2>Reproduce</h2><pre tabindex=\"0\" aria-label=\"Command\"><code>" +
                 escape(page.command_line) + "</code></pre></section>\n";
  html.body += "<footer>Forcegate " + escape(page.tool_version) +
               ". Residual = measured \u2212 model. Errors are RMS over " +
               (d.judged_by == JudgedBy::whole ? "the whole recording, which the model was fitted to." : "held-out records, each record weighing the same.") +
               " Values are value(standard uncertainty), k = 1.</footer></main>\n";
  return html_document(html);
}

}  // namespace forcegate
