// What the page of a diagnosis says beside its pictures: whose an error is, what a hollow bar is, what is counted.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

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

TEST(DiagnosisHtml, counts_the_parts_of_one_recording_as_parts) {
  Diagnosis d;
  for (const char* name : {"press/1", "press/2"}) d.records.push_back({name, "", false, 1, 1, 1, 1, 1, 0});
  EXPECT_THAT(diagnosis_html(d, {}), HasSubstr("records <b>2</b>")) << "files may be called so";
  d.single = true;
  EXPECT_THAT(diagnosis_html(d, {}), HasSubstr("one recording, parts <b>2</b>"));
  EXPECT_THAT(diagnosis_html(d, {}), HasSubstr("the error of parts that were not fitted"));
}

}  // namespace
}  // namespace forcegate
