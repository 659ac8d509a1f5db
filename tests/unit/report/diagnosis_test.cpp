#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "hil/report/diagnosis_figures.h"
#include "hil/report/diagnosis_html.h"
#include "hil/report/figures/plots.h"
#include "hil/report/overlay_figure.h"
#include "hil/report/record_pictures.h"
#include "tests/support/sample_diagnosis.h"

namespace forcegate {
namespace {

using testing::HasSubstr;
using testing::Not;
using Answer = decltype(Diagnosis::verdict);

std::size_t count(const std::string& text, const std::string& what) {
  std::size_t n = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++n;
  return n;
}

TEST(DiagnosisPage, names_the_claims_and_only_the_claims_first) {
  EXPECT_EQ(diagnosis_headline(sample::diagnosis()), "Missing: hysteresis (sensor, probability 0.97), dropouts (instrument, probability 0.95)");
}

TEST(DiagnosisPage, says_when_nothing_is_missing_and_when_it_does_not_know) {
  Diagnosis d;
  EXPECT_THAT(diagnosis_headline(d), HasSubstr("Nothing is missing"));
  d.verdict = Answer::unknown;
  d.depends_on = {"temperature", "time"};
  EXPECT_THAT(diagnosis_headline(d), HasSubstr("no listed effect explains; it depends on temperature, time"));
  d.follows = {"the largest force so far"};
  EXPECT_THAT(diagnosis_headline(d), HasSubstr("no listed effect explains; it follows the largest force so far"));
}

TEST(DiagnosisPage, holds_every_picture_of_the_chain) {
  const std::string page = diagnosis_html(sample::diagnosis(), {"0.1.0", "forcegate diagnose C07"});
  for (const char* title :
       {"residual against force, coloured by direction, record C07_r05",
        "spectrum of the residual, record C07_r05", "Residual map before", "Residual map after",
        "Residual against rate", "Ranking of the effects", "Error of every record",
        "Held-out error over the model&#39;s versions", "Measured and modelled output, record C07_r00", "Output as recorded, record C07_r05"})
    EXPECT_THAT(page, HasSubstr("<title>" + std::string(title) + "</title>"));
  for (const char* text :
       {"triangles at three rates", "0.142(6) N", "21.3 mV falls to 6.8 mV", "A_N = 1.8, rate_N_per_s = 0.05",
        "forcegate diagnose C07", "not claimed, probability 0.34"})
    EXPECT_THAT(page, HasSubstr(text));
}

TEST(DiagnosisPage, says_how_many_records_it_draws_and_gives_nothing_a_sign) {
  Diagnosis d = sample::diagnosis();
  ASSERT_GT(d.records.size(), 1u);
  d.overlays.resize(1);
  d.ranking[0].score = -0.04, d.ranking[0].null_score = -0.06;
  const std::string page = diagnosis_html(d, {});
  EXPECT_THAT(page, HasSubstr("Measured and modelled output of 1 of " + std::to_string(d.records.size()) + " records<"));
  EXPECT_THAT(page, AllOf(Not(HasSubstr("\u22120.0<")), HasSubstr("\u22120.1<")));
}

TEST(DiagnosisPage, names_no_error_held_out_where_the_whole_recording_judged) {
  Diagnosis d = sample::diagnosis();
  d.judged_by = JudgedBy::whole;
  const std::string page = diagnosis_html(d, {});
  EXPECT_THAT(page, HasSubstr("Error of the whole recording 21.3 mV falls to 6.8 mV"));
  EXPECT_EQ(count(page, "Held-out error"), 0u);
}

TEST(DiagnosisPage, asks_for_nothing_and_runs_nothing) {
  Diagnosis d = sample::diagnosis();
  const std::string evil = "<script>alert(1)</script>\"'\x1b]]>";
  d.campaign = d.model = d.findings[0].evidence = d.findings[0].effect = d.findings[0].form = evil;
  d.findings[0].parameters[0].name = d.findings[0].confounded_with[0].separates = d.records[0].record = evil;
  d.maps[0].sentence = d.maps[0].coordinate = d.ranking[0].note = d.next_experiment.sentence = evil;
  d.notes = {evil};
  d.findings[0].series[0].title = d.findings[0].series[0].x_name = evil;
  SampleWindow& window = d.findings[2].samples[0];
  window.record = window.quantity = window.unit = window.beside_name = evil;
  const std::string page = diagnosis_html(d, {});
  EXPECT_EQ(count(page, "<script"), 0u);
  EXPECT_EQ(page.find('\x1b'), std::string::npos);
  for (const char* what : {"http:", "https:", " style=", "<iframe"}) EXPECT_THAT(page, Not(HasSubstr(what)));
}

TEST(DiagnosisPage, has_equal_bytes_for_equal_diagnoses) {
  EXPECT_EQ(diagnosis_html(sample::diagnosis(), {}), diagnosis_html(sample::diagnosis(), {}));
}

TEST(DiagnosisPage, survives_an_empty_diagnosis) {
  EXPECT_THAT(diagnosis_html({}, {}), HasSubstr("</html>"));
}

TEST(ResidualMapPicture, hatches_cells_without_enough_blocks) {
  Diagnosis d = sample::diagnosis();
  const std::string hatched = residual_map_figure(d, false).svg(figures::Figure::Target::embedded);
  for (ResidualMap& m : d.maps)
    for (MapCell& c : m.cells) c.blocks = 12;
  const std::string full = residual_map_figure(d, false).svg(figures::Figure::Target::embedded);
  EXPECT_EQ(count(hatched, "class=\"l mu\""), 1u);
  EXPECT_EQ(count(full, "class=\"l mu\""), 0u);
}

std::string drawn(const figures::Figure& figure) { return figure.svg(figures::Figure::Target::embedded); }

TEST(ResidualMapPicture, says_the_range_and_the_unit_of_every_coordinate) {
  const std::string svg = drawn(residual_map_figure(sample::diagnosis(), false));
  for (const char* text : {"Position in the range that stands beside the coordinate / %", "Coordinate, lowest to highest",
                           "force while unloading, 0.51 to 3.9 N", "temperature, 21 to 24 \u00b0C", "time since the last turn, 0.22 to 515 s"})
    EXPECT_THAT(svg, HasSubstr(text));
}

TEST(Pictures, of_a_diagnosis_name_both_axes_of_every_panel) {
  const Diagnosis d = sample::diagnosis();
  std::vector<figures::Figure> all = {diagnosis_waterfall(d), ranking_figure(d), record_error_figure(d), residual_map_figure(d, false),
                                      coordinate_figure(d.maps[0], nullptr, d.unit), evidence_figure(d.findings[0].series[0]),
                                      record_overlay_figure(d.overlays[0]), sample_figure(d.findings[2].samples[0])};
  const std::vector<double> x = {1, 2, 3, 4, 5};
  all.push_back(spectrum_figure({"r", x, x, x, 0.1}, "V"));
  all.push_back(extrema_figure({"r", {x, x, x, x}, {x, x, x, x}}, "V"));
  all.push_back(drift_figure({"r", "line", x, x, x, 0.1}, "V"));
  RecordPictures levels;
  for (const double at : x) levels.levels.push_back({"r", at, at, 0.1, at, 0.1, NAN, NAN});
  all.push_back(levels_figure(levels));
  EXPECT_EQ(all.back().panels().size(), 2u);  // no rig law: no panel of the reference
  for (const figures::Figure& figure : all)
    for (const figures::Panel& panel : figure.panels()) {
      EXPECT_FALSE(panel.x_axis.quantity.empty()) << figure.title;
      EXPECT_FALSE(panel.y_axis.quantity.empty()) << figure.title;
    }
}

TEST(Pictures, of_levels_have_the_unit_of_their_whiskers) {
  RecordPictures levels;
  for (const double at : {1.0, 2.0, 3.0}) levels.levels.push_back({"r", at, 1e-8, 0.03, 0.0, 1.0, NAN, NAN});
  EXPECT_EQ(levels_figure(levels).panels().front().y_axis.unit, "mV");
}

TEST(Pictures, of_samples_mark_what_the_claim_names) {
  Diagnosis d = sample::diagnosis();
  SampleWindow& window = d.findings[2].samples[0];
  const figures::Figure marked = sample_figure(window);
  EXPECT_THAT(drawn(marked), HasSubstr("named"));
  EXPECT_THAT(marked.summary, HasSubstr("29 samples of this cut are named"));
  window.named.clear();
  window.named_t_s.clear();
  EXPECT_THAT(drawn(sample_figure(window)), Not(HasSubstr(">named<")));
}

TEST(Pictures, of_a_record_leave_a_gap_where_the_clock_has_one) {
  EvidenceSeries s{"r", "measured and modelled", "time", "s", "V", {}, {}, {}, {}};
  for (int i = 0; i < 100; ++i) {
    s.x.push_back(i < 50 ? 0.1 * i : 0.1 * i + 30.0);
    s.before.push_back(1.0 + 0.01 * i);
    s.after.push_back(1.0);
  }
  const figures::Figure figure = record_overlay_figure(s);
  std::size_t lines = 0;
  for (const figures::Panel& panel : figure.panels())
    for (const figures::Series& series : panel.series)
      if (const auto* line = std::get_if<figures::LineSeries>(&series)) {
        ++lines;
        EXPECT_EQ(std::ranges::count_if(line->y, [](double y) { return std::isnan(y); }), 1);
      }
  EXPECT_EQ(lines, 3u);  // measured, model, difference
}

TEST(Gaps, break_a_line_where_a_step_is_four_times_the_usual_one) {
  std::vector<double> x = {0, 1, 2, 3, 7.5, 8, 9, 12.9}, y = x;
  figures::break_at_gaps(x, {&y});
  ASSERT_EQ(x.size(), 9u);
  EXPECT_TRUE(std::isnan(y[4]));
  EXPECT_DOUBLE_EQ(y[5], 7.5);
  EXPECT_DOUBLE_EQ(y[8], 12.9);
}

RecordPictures some_pictures() {
  RecordPictures p;
  const std::vector<double> x = {1, 2, 3, 4, 5};
  p.spectra.push_back({"C07_r05", x, x, x, 0.1});
  for (const double at : x) p.levels.push_back({"r", at, at, 0.1, at, 0.1, NAN, NAN});
  p.missing = {"No maxima and minima over time: nothing turns."};
  return p;
}

TEST(SpectrumPicture, tells_a_line_of_the_load_from_one_of_its_own) {
  ResidualSpectrum s{"r", {}, {}, {}, 0.0};
  for (int i = 1; i <= 200; ++i) {
    s.f_Hz.push_back(0.1 * i);
    s.residual.push_back(i == 70 ? 1e-2 : 1e-3 + 0.5 / (i * i));  // what grows to low frequencies is no line
    s.load.push_back(1e-2);
  }
  EXPECT_THAT(spectrum_figure(s, "V").summary, HasSubstr("a line at 7 Hz, where the load has none"));
  s.load[69] = 1.0;
  EXPECT_THAT(spectrum_figure(s, "V").summary, HasSubstr("a line at 7 Hz, where the load has one"));
  s.command.assign(200, 1e-2);  // the steps of the reference are none of the load
  EXPECT_THAT(spectrum_figure(s, "V").summary, HasSubstr("a line at 7 Hz, where the load has none"));
  s.command[69] = 1.0;
  EXPECT_THAT(spectrum_figure(s, "V").summary, HasSubstr("a line at 7 Hz, where the load has one."));
  s.command.clear();
  EXPECT_THAT(spectrum_figure(s, "V").summary, HasSubstr("by its reference"));
  s.noise = 1e-4;
  for (const auto& [left, told] : {std::pair{9e-3, "it is still there"}, {5e-3, "a part of it is left"}, {9e-4, "it is gone"}}) {
    s.after.assign(200, 3e-3);  // neighbours that hide it
    s.after[69] = left;
    EXPECT_THAT(spectrum_figure(s, "V").summary, HasSubstr(told)) << left;
  }
  s.residual[69] = s.residual[68];
  EXPECT_THAT(spectrum_figure(s, "V").summary, HasSubstr("No line stands out"));
}

TEST(SpectrumPicture, shows_before_and_after_in_two_colours_with_a_legend) {
  RecordPictures p = some_pictures();
  p.spectra[0].after = {0.5, 0.4, 0.3, 0.2, 0.1};
  const std::string svg = spectrum_figure(p.spectra[0], "V").svg(figures::Figure::Target::standalone);
  EXPECT_THAT(svg, AllOf(HasSubstr("residual before"), HasSubstr(">after<")));
  p.spectra[0].after.clear();
  EXPECT_THAT(spectrum_figure(p.spectra[0], "V").svg(figures::Figure::Target::standalone), Not(HasSubstr("before")));
}

TEST(ExtremaPicture, shows_what_is_left_before_and_after) {
  ExtremaDecay e{"r", {{0, 10, 20, 30}, {2, 2, 2, 2}, {1.9, 1.8, 1.7, 1.6}, {2, 2, 2, 2}}, {{5, 15, 25, 35}, {1, 1, 1, 1}, {1, 1, 1, 1}, {1, 1, 1, 1}}};
  const std::string svg = extrema_figure(e, "V").svg(figures::Figure::Target::standalone);
  for (const char* label : {"maxima before", "maxima after", "minima before", "minima after"}) EXPECT_THAT(svg, HasSubstr(label));
}

TEST(DiagnosisPage, a_comparison_far_above_its_noise_is_not_green) {
  Diagnosis d = sample::diagnosis();
  EXPECT_THAT(diagnosis_html(d, {"0.1.0", "", true}), HasSubstr("<header class=\"wa\">"));
  d.error_before = d.floor;
  EXPECT_THAT(diagnosis_html(d, {"0.1.0", "", true}), HasSubstr("<header class=\"ok\">"));
}

TEST(DiagnosisPage, draws_spectrum_and_level_or_says_why_not) {
  const std::string page = diagnosis_html(sample::diagnosis(), {"0.1.0", "", false, some_pictures()});
  EXPECT_THAT(page, HasSubstr("<title>Spectrum of the residual, record C07_r05</title>"));
  EXPECT_THAT(page, HasSubstr("No maxima and minima over time: nothing turns."));
  EXPECT_GT(page.find("<title>Level of every record in its order</title>"), page.find("id=\"looks\""));
}

TEST(DiagnosisPage, draws_the_level_of_the_records_beside_a_claim_that_acts_between_them) {
  Diagnosis d = sample::diagnosis();
  d.findings[0].effect = "a new one";
  d.findings[0].between_records = true;
  const std::string page = diagnosis_html(d, {"0.1.0", "", false, some_pictures()});
  EXPECT_EQ(count(page, "<title>Level of every record in its order</title>"), 1u);
  EXPECT_LT(page.find("<title>Level of every record in its order</title>"), page.find("id=\"looks\""));
}

TEST(Waterfall, draws_a_step_hollow_when_its_interval_holds_zero) {
  const auto hollow = [](double u, bool claimed) {
    const std::string svg = figures::waterfall("w", "M0", {{"creep", 2.0, 1.5, u, claimed}}, "M1", "V", NAN)
                                .svg(figures::Figure::Target::embedded);
    return count(svg, "class=\"h ");
  };
  EXPECT_EQ(hollow(0.1, true), 0u);
  EXPECT_EQ(hollow(0.3, true), 1u);
  EXPECT_EQ(hollow(0.1, false), 1u);
}

TEST(Waterfall, of_a_diagnosis_is_one_chain_in_one_measure) {
  Diagnosis d = sample::diagnosis();
  d.findings.resize(1);
  d.findings[0].effect = "thermal";
  d.findings.push_back(d.findings[0]);
  d.findings[1].effect = "delay";
  d.error_before = 0.052;
  d.error_after = 0.008;
  d.steps = {{"", 0.052}, {"delay", 0.037}, {"thermal", 0.008}};
  const std::string svg = diagnosis_waterfall(d).svg(figures::Figure::Target::embedded);
  EXPECT_THAT(svg, HasSubstr("\u221215<"));
  EXPECT_THAT(svg, HasSubstr("\u221229<"));
  EXPECT_EQ(count(svg, "class=\"h "), 0u);
  d.findings.pop_back();  // what is not claimed is hollow
  EXPECT_EQ(count(diagnosis_waterfall(d).svg(figures::Figure::Target::embedded), "class=\"h "), 1u);
}

TEST(Waterfall, of_what_the_rig_does_is_its_own_and_in_newtons) {
  Diagnosis d;
  d.verdict = Answer::known;
  d.error_before = d.error_after = 0.00359;
  d.errors["F"] = {0.070, 0.0129, "N"};
  for (const auto& [effect, before, after] : {std::tuple{"spring_nonlinearity", 0.0243, 0.0129}, {"backlash", 0.070, 0.0243}}) {
    Finding f;
    f.effect = effect, f.side = "rig", f.shown_in = ShownIn::rig, f.unit = "N", f.probability = 0.9, f.error_before = before, f.error_after = after;
    d.findings.push_back(f);
  }
  const std::string page = diagnosis_html(d, {}), svg = rig_waterfall(d).svg(figures::Figure::Target::embedded);
  EXPECT_EQ(count(page, "no effect added"), 0u) << "the output's error is not what was claimed";
  EXPECT_THAT(page, HasSubstr("<title>Error of F_ref against the rig&#39;s law</title>"));
  for (const char* text : {">70<", ">\u221245.7<", ">\u221211.4<", ">12.9<", "RMSE / mN"}) EXPECT_THAT(svg, HasSubstr(text));
  EXPECT_LT(svg.find(">backlash<"), svg.find(">spring_nonlinearity<"));
  d.findings[1].shown_in = ShownIn::output, d.findings[1].unit = "V";  // both channels have a claim
  EXPECT_THAT(diagnosis_html(d, {}), HasSubstr("Error over the versions of the model<"));
}

double number_after(const std::string& text, const std::string& what, std::size_t from) { return std::stod(text.substr(text.find(what, from) + what.size())); }

TEST(Waterfall, keeps_the_number_of_a_long_step_off_the_names_below_the_axis) {
  const std::string svg = drawn(figures::waterfall("w", "start", {{"hysteresis", 0.0736, 0.0023, 0.0, true}}, "now", "V", 0.002));
  const auto y_of = [&](const std::string& text) { return number_after(svg, " y=\"", svg.rfind("<text", svg.find(">" + text + "<"))); };
  EXPECT_GT(std::abs(y_of("hysteresis") - y_of("\u221271.3")), 30.0) << svg;
}

TEST(RankingPicture, says_the_probability_with_two_decimals) {
  Diagnosis d = sample::diagnosis();
  d.ranking.front().probability = 0.5;
  EXPECT_THAT(ranking_figure(d).summary, HasSubstr("probability 0.50"));
}

TEST(ResidualMapPicture, has_the_same_rows_before_and_after) {
  Diagnosis d = sample::diagnosis();
  ResidualMap map = d.maps[0];
  d.maps.clear();
  for (int k = 0; k < 14; ++k) {
    map.coordinate = "c" + std::to_string(k);
    d.maps.push_back(map);
  }
  d.maps_after = d.maps;
  std::ranges::reverse(d.maps_after);
  for (ResidualMap& m : d.maps_after) m.cells[0].mean = 0.0;
  const auto rows = [&](bool after) { return residual_map_figure(d, after).panels().front().y_axis.categories; };
  ASSERT_EQ(rows(false).size(), 12u);
  EXPECT_EQ(rows(false), rows(true));
}

TEST(DiagnosisPage, draws_one_map_and_no_before_where_nothing_entered_the_model) {
  Diagnosis d = sample::diagnosis();
  EXPECT_TRUE(has_after(d));
  d.maps_after = d.maps;
  for (RecordError& r : d.records) r.after = r.before, r.plain_after = r.plain_before;
  EXPECT_FALSE(has_after(d));
  const std::string page = diagnosis_html(d, {});
  EXPECT_THAT(page, AllOf(HasSubstr("<title>Residual map</title>"), HasSubstr("before and after are one"), Not(HasSubstr("Residual map after"))));
  for (const char* label : {">before<", ">after<", ">Before<", ">After<"}) EXPECT_THAT(page, Not(HasSubstr(label)));
}

TEST(DiagnosisPage, lists_the_records_in_the_unit_of_the_headline) {
  const Diagnosis d = sample::diagnosis();
  EXPECT_THAT(diagnosis_html(d, {}), AllOf(HasSubstr("RMS error of each record in mV"), Not(HasSubstr("RMS error of each record in V"))));
}

TEST(EvidencePicture, of_a_load_that_is_held_calls_it_neither_rising_nor_falling) {
  EvidenceSeries s{"r", "residual against time", "time", "s", "V", {}, {}, {}, {}};
  for (int i = 0; i < 40; ++i) s.x.push_back(i), s.before.push_back(0.01 * (i % 3)), s.after.push_back(0.0), s.colour.push_back(0.0);
  EXPECT_THAT(drawn(evidence_figure(s)), AllOf(HasSubstr(">held<"), Not(HasSubstr("rising")), Not(HasSubstr("falling"))));
}

TEST(SpectrumPicture, names_the_noise_in_the_legend_off_the_curves) {
  const std::vector<double> x = {1, 2, 3, 4, 5};
  const figures::Figure figure = spectrum_figure({"r", x, x, x, 0.1}, "V");
  for (const figures::Series& series : figure.panels().front().series)
    EXPECT_FALSE(std::holds_alternative<figures::Rule>(series));
  EXPECT_THAT(drawn(figure), HasSubstr(">noise<"));
}

// A sine of 1 Hz for 900 s, as first, smallest, largest and last of every second.
EvidenceSeries many_cycles() {
  EvidenceSeries s{"r08", "measured and modelled", "time", "s", "V", {}, {}, {}, {}};
  for (int i = 0; i < 4 * 900; ++i) {
    s.x.push_back(0.25 * i);
    s.before.push_back(3.0 + (i % 2 == 0 ? 0.0 : i % 4 == 1 ? 1.0 : -1.0));
    s.after.push_back(s.before.back() - 0.01);
  }
  return s;
}

TEST(RecordPicture, of_more_cycles_than_it_can_part_is_an_envelope_with_a_few_of_them_beside_it) {
  const EvidenceSeries s = many_cycles();
  EvidenceSeries few = s;
  for (std::vector<double>* v : {&few.x, &few.before, &few.after}) v->resize(20);
  const figures::Figure figure = record_overlay_figure(s, &few);
  ASSERT_EQ(figure.panels().size(), 4u);
  const auto* band = std::get_if<figures::BandSeries>(&figure.panels().front().series.front());
  ASSERT_NE(band, nullptr);
  for (std::size_t i = 0; i < band->x.size(); ++i) {
    EXPECT_NEAR(band->low[i], 2.0, 1e-9);
    EXPECT_NEAR(band->high[i], 4.0, 1e-9);
  }
  EXPECT_TRUE(std::holds_alternative<figures::LineSeries>(figure.panels()[1].series.front()));
  EvidenceSeries slow = s;
  for (std::size_t i = 0; i < slow.x.size(); ++i) slow.before[i] = slow.after[i] = std::sin(0.02 * slow.x[i]);
  EXPECT_TRUE(std::holds_alternative<figures::LineSeries>(record_overlay_figure(slow).panels().front().series.front()));
}

TEST(ReadableUnit, picks_the_prefix_that_leaves_few_digits) {
  EXPECT_EQ(figures::readable_unit(0.0123, "V").unit, "mV");
  EXPECT_EQ(figures::readable_unit(3e-6, "V").unit, "\u00b5V");
  EXPECT_EQ(figures::readable_unit(1.5, "N").unit, "N");
  EXPECT_EQ(figures::readable_unit(9e-7, "S").unit, "\u00b5S") << "a film's conductance";
  EXPECT_EQ(figures::readable_unit(0.01, "%").unit, "%");
}

}  // namespace
}  // namespace forcegate
