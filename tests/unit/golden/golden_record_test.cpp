#include "golden/compare/golden_record.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace forcegate {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

GoldenContent sine(double gain = 1.0, double lag_s = 0.0) {
  GoldenContent c;
  const auto force = [&](double t_s) { return gain * (2.0 + std::sin(3.14159265358979 * (t_s - lag_s))); };
  for (int k = 0; k < 200; ++k)
    c.extrema.push_back({k % 2 == 0, 0.5 + k + lag_s, force(0.5 + k + lag_s), force(0.5 + k + lag_s)});
  for (const double t0_s : {2.0, 100.0, 190.0}) {
    GoldenWindow w{t0_s, 0.05, {}, {}};
    for (int i = 0; i < 101; ++i) {
      w.ati_N.push_back(static_cast<float>(force(t0_s + 0.05 * i)));
      w.dut_N.push_back(w.ati_N.back());
    }
    c.windows.push_back(std::move(w));
  }
  return c;
}

GoldenRecord golden() {
  GoldenRecord g;
  g.plan = "smoke";
  g.case_name = "sine";
  g.specimen = "q50";
  g.seed = 7;
  g.rig = "emulated/1";
  g.algorithm = "lebosse-eq7/1";
  g.provenance = {{"who", "A. Smith"}, {"reason", "first one"}};
  g.ati = {.absolute = 0.02, .time_s = 0.01, .lag_limit_s = 0.01};
  g.firmware = {.relative = 0.02, .time_s = 0.01, .lag_limit_s = 0.01};
  g.content = sine();
  return *parse_golden_record(to_text(g), "golden");
}

GoldenComparison compare(const GoldenRecord& g, const GoldenContent& tested,
                         GoldenCurve curve = GoldenCurve::ati) {
  const auto result = compare_golden(g, tested, curve);
  EXPECT_TRUE(result) << (result ? "" : result.error().to_text());
  return result.value_or(GoldenComparison{});
}

TEST(GoldenRecord, survives_being_written_and_read_and_says_where_it_is_from) {
  const GoldenRecord g = golden();
  EXPECT_EQ(to_text(*parse_golden_record(to_text(g), "again")), to_text(g));
  EXPECT_EQ(g.provenance.at("reason"), "first one");
  EXPECT_EQ(g.extrema_in_all, 200u);
  EXPECT_LE(g.content.extrema.size(), 80u);
  EXPECT_LT(to_text(g).size(), 20000u) << "a person must be able to read it";
}

TEST(GoldenRecord, keeps_maxima_and_minima) {
  const GoldenRecord g = golden();
  std::size_t maxima = 0;
  for (const GoldenExtremum& e : g.content.extrema) maxima += e.maximum;
  EXPECT_GT(maxima, g.content.extrema.size() / 3);
  EXPECT_LT(maxima, 2 * g.content.extrema.size() / 3);
}

TEST(GoldenRecord, the_same_record_is_inside_and_a_slightly_different_one_too) {
  EXPECT_EQ(compare(golden(), sine()).state, TubeState::inside);
  const GoldenComparison close = compare(golden(), sine(1.005));
  EXPECT_EQ(close.state, TubeState::inside) << close.cause;
  EXPECT_GT(close.outside, 0.3) << "the margin shows before it fails";
}

TEST(GoldenRecord, absolute_relative_and_scale_tolerances_each_hold) {
  GoldenRecord g = golden();
  EXPECT_EQ(compare(g, sine(1.03)).state, TubeState::outside);
  EXPECT_EQ(compare(g, sine(1.015), GoldenCurve::firmware).state, TubeState::inside);
  EXPECT_EQ(compare(g, sine(1.03), GoldenCurve::firmware).state, TubeState::outside);
  g.ati = {.scale = 0.05, .time_s = 0.01, .lag_limit_s = 0.01};
  EXPECT_EQ(compare(g, sine(1.03)).state, TubeState::inside);
}

TEST(GoldenRecord, a_lag_is_a_defect_and_not_absorbed) {
  const GoldenComparison late = compare(golden(), sine(1.0, 0.03));
  EXPECT_EQ(late.state, TubeState::outside);
  EXPECT_NEAR(late.lag_s, 0.03, 0.005);
}

TEST(GoldenRecord, in_a_hold_the_lag_is_noise_and_not_limited_but_the_tube_is) {
  GoldenRecord g = golden();
  GoldenContent tested = sine();
  for (std::size_t i = 0; i < 101; ++i) {  // a hold that sinks by 5 mN; the tested one a second later
    g.content.windows[1].ati_N[i] = 3.0F - 5e-5F * static_cast<float>(i);
    tested.windows[1].ati_N[i] = 3.0F - 5e-5F * (static_cast<float>(i) - 20.0F);
  }
  EXPECT_EQ(compare(g, tested).state, TubeState::inside) << compare(g, tested).cause;
  tested.windows[1].ati_N[50] += 0.05F;
  EXPECT_EQ(compare(g, tested).state, TubeState::outside);
}

TEST(GoldenRecord, every_extremum_and_sample_compared_has_its_margin) {
  const GoldenComparison c = compare(golden(), sine(1.005));
  ASSERT_EQ(c.margins.size(), c.n);
  double least_N = 1e9;
  std::size_t windows = 0;
  for (const GoldenMargin& m : c.margins) {
    least_N = std::min(least_N, m.margin_N);
    windows += m.where == "window";
  }
  EXPECT_EQ(windows, 303u);
  EXPECT_NEAR(least_N, c.worst_margin_N, 1e-6);
  EXPECT_NEAR(least_N, 0.02 - 0.005 * 3.0, 2e-3);
  EXPECT_LT(compare(golden(), sine(1.03)).worst_margin_N, 0.0);
}

// The traps in which other comparators call a bad trace good.
TEST(GoldenRecord, seventy_of_a_hundred_and_one_samples_that_are_no_numbers_are_not_compared) {
  GoldenContent tested = sine();
  for (std::size_t i = 0; i < 70; ++i) tested.windows[1].ati_N[i] = kNan;
  const GoldenComparison c = compare(golden(), tested);
  EXPECT_EQ(c.state, TubeState::not_compared);
  EXPECT_NE(c.cause.find("70 of 101"), std::string::npos) << c.cause;
}

TEST(GoldenRecord, a_truncated_window_or_record_is_not_compared) {
  GoldenContent shorter = sine();
  shorter.windows[2].ati_N.resize(60);
  EXPECT_EQ(compare(golden(), shorter).state, TubeState::not_compared);
  GoldenContent fewer = sine();
  fewer.extrema.resize(120);
  EXPECT_EQ(compare(golden(), fewer).state, TubeState::not_compared);
  GoldenContent none = sine();
  none.windows.pop_back();
  EXPECT_EQ(compare(golden(), none).state, TubeState::not_compared);
}

TEST(GoldenRecord, an_extremum_that_is_no_number_is_not_compared) {
  GoldenContent tested = sine();
  tested.extrema[7].ati_N = std::nan("");
  EXPECT_EQ(compare(golden(), tested).state, TubeState::not_compared);
}

TEST(GoldenRecord, a_signal_near_zero_and_a_constant_one_are_held_to_the_tolerance_as_written) {
  for (const double level_N : {0.0, 1e-6, 3.0}) {
    GoldenRecord g = golden();
    for (GoldenExtremum& e : g.content.extrema) e.ati_N = level_N;
    for (GoldenWindow& w : g.content.windows)
      std::fill(w.ati_N.begin(), w.ati_N.end(), static_cast<float>(level_N));
    GoldenContent tested = sine();
    const auto set = [&](double offset_N) {
      for (GoldenExtremum& e : tested.extrema) e.ati_N = level_N + offset_N;
      for (GoldenWindow& w : tested.windows)
        std::fill(w.ati_N.begin(), w.ati_N.end(), static_cast<float>(level_N + offset_N));
    };
    set(0.015);
    EXPECT_EQ(compare(g, tested).state, TubeState::inside) << level_N;
    set(0.03);
    EXPECT_EQ(compare(g, tested).state, TubeState::outside) << level_N;
    g.ati = {.time_s = 0.01, .lag_limit_s = 0.01};
    set(0.0);
    EXPECT_EQ(compare(g, tested).state, TubeState::inside) << "zero tolerance means equality: " << level_N;
    set(1e-3);
    EXPECT_EQ(compare(g, tested).state, TubeState::outside) << "zero tolerance is not replaced: " << level_N;
  }
}

TEST(GoldenRecord, a_damaged_file_is_refused_with_its_line) {
  const std::string text = to_text(golden());
  EXPECT_FALSE(parse_golden_record("", "g"));
  EXPECT_FALSE(parse_golden_record("forcegate golden 2\n", "g"));
  std::string cut = text.substr(0, text.size() - 40);
  const auto truncated = parse_golden_record(cut, "g");
  ASSERT_FALSE(truncated);
  EXPECT_NE(truncated.error().where.find("g:"), std::string::npos);
  std::string nan = text;
  nan.replace(nan.find("max "), 4, "max nan ");
  EXPECT_FALSE(parse_golden_record(nan, "g"));
}

TEST(GoldenRecord, a_damaged_line_of_its_head_never_leaves_a_comparison_out) {
  std::string text = to_text(golden());
  text.erase(text.find("digest "), std::string("digest ").size() + 65);  // as older versions wrote it: the line alone is damaged
  const auto with = [&](const std::string& line, const std::string& instead) {
    std::string other = text;
    const std::size_t at = other.find(line + "\n");
    EXPECT_NE(at, std::string::npos) << line;
    return parse_golden_record(other.replace(at, line.size(), instead), "g");
  };
  const auto refused = [&](const std::string& line, const std::string& instead, const std::string& says, const std::string& where) {
    const auto got = with(line, instead);
    ASSERT_FALSE(got) << instead;
    EXPECT_NE(got.error().text.find(says), std::string::npos) << got.error().to_text();
    EXPECT_EQ(got.error().where, where) << got.error().to_text();
  };
  refused("seed 7", "sed 7", "no line 'sed', the nearest is 'seed'", "g:6");
  refused("seed 7", "foo bar", "no line 'foo'", "g:6");
  refused("seed 7", "seed -3", "whole number", "g:6");
  refused("seed 7", "seed 7.5", "whole number", "g:6");
  refused("seed 7", "seed 7\nseed 8", "'seed' stands here a second time", "g:7");
  refused("algorithm lebosse-eq7/1", "algoritm lebosse-eq7/1", "the nearest is 'algorithm'", "g:8");
  refused("rig emulated/1", "rig ", "without a value", "g:7");
  refused("reason first one", "reason first one\nfoo = 1", "no line 'foo'", "g:10");
  EXPECT_EQ(with("seed 7", "seed 12345678901234567")->seed, 12345678901234567u) << "a seed is no decimal";
  for (const char* line : {"plan", "case", "specimen", "seed", "rig", "algorithm", "tolerance ati", "tolerance firmware", "extrema"}) {
    std::string other = text;
    const std::size_t at = other.find("\n" + std::string(line) + " ");
    other.erase(at, other.find('\n', at + 1) - at);
    const auto got = parse_golden_record(other, "g");
    ASSERT_FALSE(got) << line;
    EXPECT_NE(got.error().text.find(line), std::string::npos) << got.error().to_text();
  }
}

TEST(GoldenRecord, a_force_of_exactly_zero_is_the_lowest_of_the_swing) {
  GoldenRecord g = golden();
  g.firmware = {.scale = 0.1, .time_s = 0.01};
  g.content = {};
  g.every = 1;
  for (const double force : {0.0, 2.0, 1.0, 2.0}) g.content.extrema.push_back({force == 2.0, 1.0 + static_cast<double>(g.content.extrema.size()), force, force});
  g.extrema_in_all = 4;
  GoldenContent tested = g.content;
  tested.extrema[2].dut_N += 0.15;
  EXPECT_EQ(compare(g, tested, GoldenCurve::firmware).state, TubeState::inside) << "a tenth of 2 N";
  for (GoldenExtremum& e : g.content.extrema) e.dut_N -= 5.0;
  for (GoldenExtremum& e : tested.extrema) e.dut_N -= 5.0;
  EXPECT_EQ(compare(g, tested, GoldenCurve::firmware).state, TubeState::inside) << "below zero too";
  tested.extrema[2].dut_N += 0.15;
  EXPECT_EQ(compare(g, tested, GoldenCurve::firmware).state, TubeState::outside);
}

TEST(GoldenRecord, is_read_with_the_line_ends_of_windows) {
  const std::string text = to_text(golden());
  std::string windows;
  for (const char c : text) windows += c == '\n' ? std::string("\r\n") : std::string(1, c);
  const auto read = parse_golden_record(windows, "golden");
  ASSERT_TRUE(read) << read.error().to_text();
  EXPECT_EQ(to_text(*read), text);
}

TEST(GoldenRecord, a_sample_that_is_not_the_one_that_was_blessed_is_damage_and_another_tolerance_is_not) {
  const std::string text = to_text(golden());
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string other = text;
    const std::size_t at = other.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return parse_golden_record(other.replace(at, from.size(), to), "g");
  };
  const auto flipped = with("\nwindow 2.000 0.05 101\n2.", "\nwindow 2.000 0.05 101\n3.");
  ASSERT_FALSE(flipped);
  EXPECT_NE(flipped.error().text.find("damaged"), std::string::npos) << flipped.error().to_text();
  EXPECT_TRUE(flipped.error().where.starts_with("g:")) << flipped.error().where;
  EXPECT_FALSE(with("seed 7", "seed 8"));
  EXPECT_TRUE(with("absolute 0.02", "absolute 0.03"));
  EXPECT_TRUE(with("# Made by", "# made by"));
  std::string windows;
  for (const char c : text) windows += c == '\n' ? "\r\n" : std::string(1, c);
  EXPECT_TRUE(parse_golden_record(windows, "g"));
  // goldens of older versions have none
  const std::size_t at = text.find("digest ");
  ASSERT_NE(at, std::string::npos);
  std::string old = text;
  EXPECT_TRUE(parse_golden_record(old.erase(at, old.find('\n', at) + 1 - at), "g"));
}

}  // namespace
}  // namespace forcegate
