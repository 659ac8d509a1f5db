// What the page of a diagnosis says beside its pictures: whose an error is, what a hollow bar is, what is counted.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "hil/report/added_html.h"
#include "hil/report/diagnosis_figures.h"
#include "hil/report/diagnosis_html.h"
#include "hil/report/figures/plots.h"
#include "hil/report/record_pictures.h"

namespace forcegate {
namespace {

using testing::HasSubstr;
using testing::Not;
using Answer = decltype(Diagnosis::verdict);

TEST(SpectrumPicture, tells_the_hum_where_the_rows_fold_it) {
  ResidualSpectrum s{"r", {}, {}, {}, 0.0};
  const double step_Hz = 41.6 / 400.0;
  for (int i = 1; i <= 400; ++i) {
    s.f_Hz.push_back(step_Hz * i);
    s.residual.push_back(std::abs(step_Hz * i - 33.2) < 0.5 * step_Hz ? 3.5e-3 : 1e-3);
    s.load.push_back(1e-2);
  }
  EXPECT_THAT(spectrum_figure(s, "V", true).summary, HasSubstr("is the hum that is claimed: rows of 12 ms fold its 50 Hz there"));
  EXPECT_THAT(spectrum_figure(s, "V").summary, HasSubstr("by more than 4 times"));
}

TEST(Waterfall, says_what_a_hollow_bar_is) {
  const auto summary = [](double u, bool claimed) { return figures::waterfall("w", "M0", {{"creep", 2.0, 1.5, u, claimed}}, "M1", "V", NAN).summary; };
  EXPECT_THAT(summary(0.0, false), HasSubstr("not claimed"));
  EXPECT_THAT(summary(0.0, false), Not(HasSubstr("significant")));
  EXPECT_THAT(summary(0.3, true), HasSubstr("within twice its uncertainty"));
  EXPECT_THAT(summary(0.1, true), Not(HasSubstr("hollow")));
}

TEST(DiagnosisHtml, says_the_error_that_the_console_says_and_whose_it_is) {
  Diagnosis d;
  d.verdict = Answer::unknown;
  d.error_before = 0.0941;
  d.error_after = 0.0055;
  d.steps = {{"", 0.0941}, {"viscous", 0.0055}};
  d.not_separable = {{"viscous", "delay"}};
  EXPECT_THAT(diagnosis_html(d, {}), HasSubstr("Held-out error 94.1 mV falls to 5.5 mV, with viscous or delay, which is not claimed."));
}

TEST(DiagnosisHtml, says_which_of_two_are_not_claimed) {
  Diagnosis d;
  d.verdict = Answer::unknown;
  d.error_before = 0.0274;
  d.error_after = 0.0087;
  d.steps = {{"", 0.0274}, {"creep", 0.0134}, {"delay", 0.0087}};
  EXPECT_THAT(diagnosis_html(d, {}), HasSubstr("falls to 8.7 mV, with creep, delay, which are not claimed"));
}

// What every record has of its own hides how far one law is from them all.
TEST(DiagnosisHtml, says_what_one_law_leaves_where_the_records_differ_without_a_cause) {
  Diagnosis d;
  d.verdict = Answer::unknown;
  d.error_before = d.error_after = d.floor = 0.0031;
  d.plain_before = d.plain_after = 0.169;
  d.follows = {"the record, whose gain scatters by 8 %"};
  for (const char* name : {"cold", "warm"}) d.records.push_back({name, "", false, 1, 1, 1, 1, 1, 0});
  const std::string html = diagnosis_html(d, {});
  EXPECT_THAT(html, HasSubstr("noise floor 3.1 mV; with one gain, offset and decay for all records 169 mV"));
  EXPECT_THAT(html, HasSubstr("nothing that was recorded says why they differ"));
  EXPECT_THAT(html, Not(HasSubstr("No listed effect has this shape")));
  d.plain_before = d.plain_after = 0.0035;
  EXPECT_THAT(diagnosis_html(d, {}), Not(HasSubstr("for all records")));
}

// An error that tripled is no result.
TEST(DiagnosisHtml, says_from_what_to_what_one_law_changes) {
  Diagnosis d;
  d.verdict = Answer::known;
  d.error_before = 0.054;
  d.error_after = d.floor = 0.0031;
  d.plain_before = 0.0762;
  d.plain_after = 0.229;
  EXPECT_THAT(diagnosis_html(d, {}), HasSubstr("with one gain, offset and decay for all records 76.2 mV rises to 229 mV"));
  const AddedEffect added{.effect = "creep", .error_before = d.error_before, .error_after = d.error_after, .floor = d.floor, .unit = "V", .steps = {}, .parameters = {}};
  EXPECT_THAT(added_html(d, added, {}), HasSubstr("for all records 76.2 mV rises to 229 mV"));
  d.plain_after = 0.065;
  EXPECT_THAT(added_html(d, added, {}), HasSubstr("for all records 76.2 mV falls to 65 mV"));
}

TEST(DiagnosisHtml, counts_the_parts_of_one_recording_as_parts) {
  Diagnosis d;
  for (const char* name : {"press/1", "press/2"}) d.records.push_back({name, "", false, 1, 1, 1, 1, 1, 0});
  EXPECT_THAT(diagnosis_html(d, {}), HasSubstr("records <b>2</b>")) << "files may be called so";
  d.single = true;
  EXPECT_THAT(diagnosis_html(d, {}), HasSubstr("one recording, parts <b>2</b>"));
  EXPECT_THAT(diagnosis_html(d, {}), HasSubstr("the error of parts that were not fitted"));
}

TEST(DiagnosisHtml, is_not_green_beside_a_suspicion_or_a_record_far_above_its_noise) {
  Diagnosis d;
  d.floor = d.error_before = d.error_after = 0.002;
  EXPECT_THAT(diagnosis_html(d, {}), HasSubstr("<header class=\"ok\">"));
  d.far_above = {{"r05", 3.7}};
  EXPECT_THAT(diagnosis_html(d, {}), testing::AllOf(HasSubstr("<header class=\"wa\">"), HasSubstr("far above its noise stands r05")));
  Finding f;
  f.effect = "humidity", f.probability = 0.25, f.effect_rms = 0.1;
  d.findings = {f};
  EXPECT_THAT(diagnosis_html(d, {}), HasSubstr("<h1>Nothing is claimed; humidity is suspected"));
}

TEST(DiagnosisHtml, counts_parts_of_records_as_parts) {
  Diagnosis d;
  Finding f;
  f.effect = "motor", f.probability = 0.98, f.records_improved = f.records_excited = 8;
  d.findings = {f};
  EXPECT_THAT(diagnosis_html(d, {}), HasSubstr("<dt>Records</dt><dd>8 of 8"));
  d.findings[0].counts_parts = true;
  EXPECT_THAT(diagnosis_html(d, {}), HasSubstr("<dt>Parts of records</dt><dd>8 of 8"));
}

TEST(DiagnosisHtml, says_of_which_records_the_error_of_a_finding_is) {
  Diagnosis d;
  Finding f;
  f.effect = "thermal", f.probability = 0.76, f.error_before = 0.0359, f.error_after = 0.0229;
  d.findings = {f};
  EXPECT_THAT(diagnosis_html(d, {}), HasSubstr("<dt>Held-out error</dt><dd>35.9 mV"));
  d.findings[0].of_every_record = true;
  EXPECT_THAT(diagnosis_html(d, {}), HasSubstr("<dt>Error of every record, predicted from the others</dt><dd>35.9 mV"));
}

TEST(DiagnosisHtml, names_no_map_that_is_not_there) {
  Diagnosis d;
  d.verdict = Answer::unknown;
  EXPECT_THAT(diagnosis_html(d, {}), testing::AllOf(HasSubstr("No listed effect has this shape."), Not(HasSubstr("maps below"))));
  d.maps.push_back({.coordinate = "force", .group = "force", .unit = "N", .share = 0.1, .cells = {}, .sentence = ""});
  EXPECT_THAT(diagnosis_html(d, {}), HasSubstr("maps below"));
}

TEST(DiagnosisHtml, says_of_rivals_what_would_part_them_and_not_what_the_rest_goes_with) {
  Diagnosis d;
  d.verdict = Answer::unknown;
  d.not_separable = {{"delay", "lag"}};
  d.depends_on = {"time"};
  d.next_experiment.sentence = "none of the short segments that a rig can play parts delay or lag";
  const std::string html = diagnosis_html(d, {});
  EXPECT_THAT(html, HasSubstr("What to measure next</h2>\n<p>none of the short segments"));
  EXPECT_THAT(html, Not(HasSubstr("it depends on")));
}

TEST(ResidualMap, has_sizes_on_its_colour_bar_and_no_colour_where_it_says_nothing) {
  Diagnosis d;
  ResidualMap map{.coordinate = "force", .group = "force", .unit = "N", .share = 0.1, .cells = {}, .sentence = ""};
  for (int i = 0; i < 8; ++i) map.cells.push_back({0.5 * i, i == 2 ? 4.9e-3 : -4.9e-3, 1e-4, 100, i == 5 ? 1 : 9});
  map.cells[5].mean = 4.0e-3;
  d.maps = {map};
  const auto svg = [&] { return residual_map_figure(d, false).svg(figures::Figure::Target::embedded); };
  EXPECT_THAT(svg(), testing::AllOf(HasSubstr(">\u22122"), HasSubstr(">2")));
  const std::string before = svg();
  d.maps[0].cells[5].mean = -4.0e-3;
  EXPECT_EQ(svg(), before);
}

TEST(DiagnosisHtml, draws_what_only_the_rigs_law_shows) {
  Diagnosis d;
  d.maps.push_back({.coordinate = "force", .group = "force", .unit = "N", .share = 0.1, .cells = {}, .sentence = ""});
  EXPECT_THAT(diagnosis_html(d, {}), Not(HasSubstr("What the output cannot show")));
  d.rig_maps.push_back({.coordinate = "angle", .group = "angle", .unit = "rad", .cells = {{-1.0, 0.02, 0.001, 90, 12}, {1.0, -0.02, 0.001, 90, 12}}, .sentence = "+20 mN where angle is about -1 rad"});
  EXPECT_THAT(diagnosis_html(d, {}), testing::AllOf(HasSubstr("What the output cannot show"), HasSubstr("F_ref less the rig&#39;s law against angle"), HasSubstr("+20 mN where angle is about")));
}

}  // namespace
}  // namespace forcegate
