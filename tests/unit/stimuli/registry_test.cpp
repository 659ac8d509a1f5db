// Properties that every profile of the registry must have at parameters that make sense; bounds, purity and refusals at any others are those
// of tests/conformance/stimulus_test.cpp.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "hil/interface/stimulus.h"

namespace forcegate {
namespace {

StimulusSpec sample(const std::string& name, int variant) {
  StimulusSpec s;
  s.name = name;
  s.seed = static_cast<std::uint64_t>(variant) + 1;
  if (name == "sine") s.numbers = {{"f_Hz", 0.7 + variant}, {"A_N", 1.5}, {"m_N", 2.7}, {"duration_s", 40}};
  if (name == "multisine") {
    s.numbers = {{"m_N", 2.5}, {"duration_s", 60}};
    s.lists = {{"f_Hz", {1, 0.5, 0.1, 0.05}}, {"A_N", {0.1, 0.2, 0.3, 0.4 + 0.1 * variant}}};
  }
  if (name == "chirp")
    s.numbers = {{"f_start_Hz", variant ? 3.0 : 0.0},
                 {"f_end_Hz", variant ? 0.0 : 3.0},
                 {"A_N", 1.2},
                 {"m_N", 2.4},
                 {"duration_s", 60}};
  if (name == "prbs") s.numbers = {{"A_N", 1.6}, {"m_N", 2.6}, {"duration_s", 40}};
  if (name == "staircase") s.lists = {{"levels_N", {0.5, 1, 2, 3, 4}}};
  if (name == "ramp") s.numbers = {{"sweep_s", 10}};
  if (name == "rest") s.numbers = {{"level_N", 1.5}, {"duration_s", 10}};
  if (name == "jump") {
    s.numbers = {{"A_N", 1.5}, {"m_N", 2.7}};
    s.lists = {{"f_Hz", {0.5, 2, 3}}, {"stretch_s", {10, 7.3, 5}}};
  }
  if (variant == 1) s.numbers["ramp_s"] = 2.5;
  return s;
}

class EveryStimulus : public ::testing::TestWithParam<std::string> {
 protected:
  void for_each(const std::function<void(const Stimulus&)>& body) {
    for (int variant = 0; variant < 2; ++variant) {
      if (GetParam() == "replay") continue;  // reads a file: has its own test
      const auto made = make_stimulus(sample(GetParam(), variant));
      ASSERT_TRUE(made.has_value()) << "sample() of this file has no good one: " << made.error().to_text();
      body(**made);
    }
  }
};

TEST_P(EveryStimulus, reaches_the_bounds_it_declares) {
  for_each([](const Stimulus& s) {
    const StimulusFacts f = s.facts();
    double low = std::numeric_limits<double>::infinity(), high = -low;
    const int n = 200000;
    for (int i = 0; i <= n; ++i) {
      const double force = s.force_N(s.duration_s() * i / n);
      low = std::min(low, force);
      high = std::max(high, force);
    }
    EXPECT_NEAR(low, f.minimum_N, 0.01);
    EXPECT_NEAR(high, f.maximum_N, 0.01);
    EXPECT_GE(f.minimum_N, 0.0);
  });
}

TEST_P(EveryStimulus, fill_agrees_with_single_calls_and_does_not_depend_on_the_block) {
  for_each([](const Stimulus& s) {
    const auto n = static_cast<std::size_t>(std::min(s.duration_s(), 30.0) * 1000.0);
    std::vector<double> whole(n), pieces(n);
    s.fill(0.0, 0.001, n, whole.data());
    std::size_t at = 0, width = 1;
    while (at < n) {
      const std::size_t m = std::min(width, n - at);
      s.fill(static_cast<double>(at) * 0.001, 0.001, m, pieces.data() + at);
      at += m;
      width = width % 97 + 3;
    }
    for (std::size_t i = 0; i < n; ++i) {
      ASSERT_NEAR(whole[i], s.force_N(static_cast<double>(i) * 0.001), 1e-9) << i;
      ASSERT_NEAR(whole[i], pieces[i], 1e-9) << i;
    }
  });
}

TEST_P(EveryStimulus, changes_smoothly_enough_for_a_motor_except_a_step) {
  if (GetParam() == "step") GTEST_SKIP() << "a step is a step";
  for_each([](const Stimulus& s) {
    double before = s.force_N(0.0);
    for (double t = 0.001; t <= s.duration_s(); t += 0.001) {
      const double now = s.force_N(t);
      ASSERT_LT(std::abs(now - before), 0.15) << t;  // 150 N/s
      before = now;
    }
  });
}

TEST_P(EveryStimulus, with_a_ramp_begins_at_zero_and_without_one_at_its_lowest_force_if_cyclic) {
  if (GetParam() == "replay") GTEST_SKIP() << "reads a file";
  const auto plain = make_stimulus(sample(GetParam(), 0)), ramped = make_stimulus(sample(GetParam(), 1));
  ASSERT_TRUE(plain && ramped) << "sample() of this file has no good one";
  EXPECT_EQ((*ramped)->force_N(0.0), 0.0);
  if ((*plain)->facts().dynamic) {
    EXPECT_NEAR((*plain)->force_N(0.0), (*plain)->facts().minimum_N, 1e-9);
    EXPECT_GE((*ramped)->facts().excitation_start_s, 2.5);
  }
}

TEST_P(EveryStimulus, documents_itself) {
  const StimulusKind* kind = Registry<StimulusKind>::instance().find(GetParam());
  ASSERT_NE(kind, nullptr);
  EXPECT_FALSE(kind->doc.empty());
  for (const StimulusParameter& p : kind->parameters) {
    EXPECT_FALSE(p.doc.empty()) << p.name;
    EXPECT_LT(p.minimum, p.maximum + (p.is_text ? 1 : 0)) << p.name;
  }
}

INSTANTIATE_TEST_SUITE_P(Registry, EveryStimulus,
                         ::testing::ValuesIn(Registry<StimulusKind>::instance().names()),
                         [](const auto& kind) { return kind.param; });

TEST(Stimuli, a_number_in_quotes_is_told_as_that) {
  StimulusSpec s = sample("sine", 0);
  s.numbers.erase("f_Hz");
  s.texts["f_Hz"] = "0.5";
  const auto made = make_stimulus(s);
  ASSERT_FALSE(made.has_value());
  EXPECT_NE(made.error().to_text().find("f_Hz is text"), std::string::npos) << made.error().to_text();
}

TEST(Stimuli, pulling_on_the_sensor_is_refused) {
  for (const char* name : {"sine", "multisine", "chirp", "prbs", "jump"}) {
    StimulusSpec s = sample(name, 0);
    s.numbers["m_N"] = 0.3;
    const auto made = make_stimulus(s);
    ASSERT_FALSE(made.has_value()) << name;
    EXPECT_EQ(made.error().code, ErrorCode::usage);
  }
}

TEST(Stimuli, a_record_that_ends_inside_its_loading_ramp_is_refused) {
  for (const StimulusKind& kind : Registry<StimulusKind>::instance().all()) {
    const auto has = [&](const char* name) {
      return std::any_of(kind.parameters.begin(), kind.parameters.end(), [&](const StimulusParameter& p) { return p.name == name; });
    };
    if (!has("ramp_s") || !has("duration_s")) continue;
    for (const double duration_s : {1.0, 5.0, 10.0}) {
      StimulusSpec s = sample(kind.name, 0);
      s.numbers["ramp_s"] = 10.0, s.numbers["duration_s"] = duration_s;
      const auto made = make_stimulus(s);
      ASSERT_FALSE(made.has_value()) << kind.name << " " << duration_s;
      EXPECT_NE(made.error().text.find("inside its loading ramp of 10 s"), std::string::npos) << made.error().to_text();
    }
  }
}

TEST(Stimuli, a_profile_that_ends_before_what_it_is_for_is_refused) {
  StimulusSpec step;
  step.name = "step";
  step.numbers = {{"at_s", 7.0}, {"duration_s", 10.0}};
  EXPECT_TRUE(make_stimulus(step).has_value());
  step.numbers["ramp_s"] = 3.0;
  const auto late = make_stimulus(step);
  ASSERT_FALSE(late.has_value());
  EXPECT_NE(late.error().text.find("would step at 10 s"), std::string::npos) << late.error().to_text();
  StimulusSpec sum = sample("multisine", 0);
  sum.numbers["fade_s"] = 59.0;
  EXPECT_TRUE(make_stimulus(sum).has_value());
  sum.numbers["fade_s"] = 60.0;
  const auto faded = make_stimulus(sum);
  ASSERT_FALSE(faded.has_value());
  EXPECT_NE(faded.error().text.find("full size at 60 s"), std::string::npos) << faded.error().to_text();
}

TEST(Stimuli, sine_begins_at_its_minimum_and_peaks_after_half_a_period) {
  const auto s = make_stimulus(sample("sine", 0));
  EXPECT_NEAR((*s)->force_N(0.5 / 0.7), 4.2, 1e-12);
}

TEST(Stimuli, multisine_is_the_sum_of_equation_6_once_faded_in) {
  const auto s = make_stimulus(sample("multisine", 0));
  const double f[] = {1, 0.5, 0.1, 0.05}, A[] = {0.1, 0.2, 0.3, 0.4};
  for (double t = 2.0; t < 60.0; t += 0.37) {
    double force = 2.5;
    for (int i = 0; i < 4; ++i) force += A[i] * std::sin(2 * std::acos(-1.0) * f[i] * t);
    EXPECT_NEAR((*s)->force_N(t), force, 1e-12);
  }
  EXPECT_EQ((*s)->facts().lowest_frequency_Hz, 0.05);
  EXPECT_LT((*s)->facts().amplitude_N, 1.0);  // half of the real peak to peak, not the sum of the amplitudes
  EXPECT_GT((*s)->facts().amplitude_N, 0.8);
}

TEST(Stimuli, chirp_sweeps_from_the_first_to_the_last_frequency) {
  const auto s = make_stimulus(sample("chirp", 1));  // 3 -> 0 Hz in 57.5 s
  int crossings = 0;
  double before = (*s)->force_N(2.5) - 2.4;
  for (double t = 2.5; t < 60.0; t += 0.001) {
    const double now = (*s)->force_N(t) - 2.4;
    crossings += (before < 0) != (now < 0);
    before = now;
  }
  EXPECT_NEAR(crossings, 2 * 0.5 * 3.0 * 57.5, 2);
  EXPECT_EQ((*s)->facts().lowest_frequency_Hz, 3.0);
}

TEST(Stimuli, prbs_changes_with_the_seed_and_is_balanced) {
  const auto a = make_stimulus(sample("prbs", 0)), b = make_stimulus([] {
                                                     auto s = sample("prbs", 0);
                                                     s.seed = 99;
                                                     return s;
                                                   }());
  int different = 0, high = 0;
  for (int k = 0; k < 399; ++k) {
    const double t = 0.1 * k + 0.08;
    different += (*a)->force_N(t) != (*b)->force_N(t);
    high += (*a)->force_N(t) > 2.6;
  }
  EXPECT_GT(different, 100);
  EXPECT_NEAR(high, 200, 45);
}

TEST(Stimuli, staircase_goes_up_and_down_and_holds_every_level) {
  const auto s = make_stimulus(sample("staircase", 0));
  EXPECT_EQ((*s)->duration_s(), 90.0);
  const double expected[] = {0.5, 1, 2, 3, 4, 3, 2, 1, 0.5};
  for (int k = 0; k < 9; ++k) EXPECT_EQ((*s)->force_N(10.0 * k + 5.0), expected[k]);
}

TEST(Stimuli, jump_keeps_the_phase_at_a_change_of_frequency) {
  const auto s = make_stimulus(sample("jump", 0));
  EXPECT_NEAR((*s)->force_N(10.0 - 1e-9), (*s)->force_N(10.0 + 1e-9), 1e-6);
  EXPECT_NEAR((*s)->force_N(17.3 - 1e-9), (*s)->force_N(17.3 + 1e-9), 1e-6);
  EXPECT_NEAR((*s)->force_N(10.25), 4.2, 1e-9);  // half a period of 2 Hz after the change at a minimum
}

TEST(Stimuli, lists_that_do_not_fit_together_are_refused) {
  auto s = sample("multisine", 0);
  s.lists["A_N"].pop_back();
  EXPECT_FALSE(make_stimulus(s).has_value());
  s = sample("jump", 0);
  s.lists["stretch_s"] = {1, 2};
  EXPECT_FALSE(make_stimulus(s).has_value());
  s.lists["stretch_s"] = {4};
  EXPECT_EQ((*make_stimulus(s))->duration_s(), 12.0);
}

}  // namespace
}  // namespace forcegate
