// A new profile is tested from its own table of parameters, before its author has written a test.

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "hil/base/rng.h"
#include "hil/interface/stimulus.h"

namespace forcegate {
namespace {

// Values inside the declared ranges: often the default or an end, else anywhere between.
double draw(Rng& rng, const StimulusParameter& p) {
  const double low = std::isfinite(p.minimum) ? p.minimum : -1e6,
               high = std::isfinite(p.maximum) ? p.maximum : 1e6;
  switch (rng.below(5)) {
    case 0: return low;
    case 1: return high;
    case 2: return std::isfinite(p.fallback) ? p.fallback : low + 0.1 * (high - low);
    default: return rng.uniform(low, low + (high - low) * std::pow(10.0, -static_cast<double>(rng.below(4))));
  }
}

StimulusSpec draw_spec(Rng& rng, const StimulusKind& kind) {
  StimulusSpec spec;
  spec.name = kind.name;
  spec.seed = rng.next();
  const std::size_t length = 1 + rng.below(5);
  for (const StimulusParameter& p : kind.parameters) {
    if (p.is_text) {
      spec.texts[p.name] = "/no/such/file.csv";
    } else if (p.is_list) {
      for (std::size_t i = 0; i < length; ++i) spec.lists[p.name].push_back(draw(rng, p));
    } else if (std::isnan(p.fallback) || rng.below(2) == 0) {
      spec.numbers[p.name] = draw(rng, p);
    }
  }
  return spec;
}

class StimulusConformance : public ::testing::TestWithParam<std::string> {
 protected:
  const StimulusKind& kind() const { return *Registry<StimulusKind>::instance().find(GetParam()); }
};

TEST_P(StimulusConformance, AnyParametersInRangeGiveABoundedProfileOrAnErrorWithHelp) {
  Rng rng(20260101, GetParam());
  for (int trial = 0; trial < 400; ++trial) {
    const StimulusSpec spec = draw_spec(rng, kind());
    const auto made = make_stimulus(spec);
    if (!made) {
      EXPECT_FALSE(made.error().text.empty());
      EXPECT_FALSE(made.error().hint.empty()) << made.error().text;
      continue;
    }
    const Stimulus& stimulus = **made;
    const StimulusFacts facts = stimulus.facts();
    ASSERT_TRUE(std::isfinite(stimulus.duration_s()));
    ASSERT_GE(stimulus.duration_s(), 0.0);
    ASSERT_LE(facts.minimum_N, facts.maximum_N);
    for (int i = 0; i < 200; ++i) {
      const double t = stimulus.duration_s() * rng.uniform();
      const double force = stimulus.force_N(t);
      ASSERT_TRUE(std::isfinite(force)) << t;
      ASSERT_GE(force, facts.minimum_N - 1e-9) << t;
      ASSERT_LE(force, facts.maximum_N + 1e-9) << t;
      ASSERT_EQ(std::bit_cast<std::uint64_t>(stimulus.force_N(t)), std::bit_cast<std::uint64_t>(force))
          << "not pure";
    }
  }
}

TEST_P(StimulusConformance, TheSameSpecIsTheSameProfile) {
  Rng rng(7, GetParam());
  int made_ones = 0;
  for (int trial = 0; trial < 100; ++trial) {
    const StimulusSpec spec = draw_spec(rng, kind());
    const auto first = make_stimulus(spec), second = make_stimulus(spec);
    ASSERT_EQ(first.has_value(), second.has_value());
    if (!first) continue;
    ++made_ones;
    for (int i = 0; i < 50; ++i) {
      const double t = (*first)->duration_s() * i / 50.0;
      ASSERT_EQ(std::bit_cast<std::uint64_t>((*first)->force_N(t)),
                std::bit_cast<std::uint64_t>((*second)->force_N(t)));
    }
  }
  const bool reads_a_file = std::any_of(kind().parameters.begin(), kind().parameters.end(),
                                        [](const auto& p) { return p.is_text; });
  EXPECT_TRUE(made_ones > 0 || reads_a_file)
      << "no draw inside the declared ranges is accepted: the ranges are wrong";
}

TEST_P(StimulusConformance, UnknownParametersAndValuesOutOfRangeAreRefused) {
  StimulusSpec spec;
  spec.name = GetParam();
  spec.numbers["no_such_parameter"] = 1.0;
  const auto unknown = make_stimulus(spec);
  ASSERT_FALSE(unknown.has_value());
  EXPECT_EQ(unknown.error().code, ErrorCode::usage);
  for (const StimulusParameter& p : kind().parameters) {
    if (p.is_text) continue;
    for (const double wrong :
         {std::nan(""), p.maximum + std::abs(p.maximum) + 1.0, p.minimum - std::abs(p.minimum) - 1.0}) {
      if (std::isinf(wrong)) continue;
      Rng rng(3, p.name);
      StimulusSpec one = draw_spec(rng, kind());
      one.numbers.erase(p.name);
      one.lists.erase(p.name);
      if (p.is_list)
        one.lists[p.name] = {wrong};
      else
        one.numbers[p.name] = wrong;
      EXPECT_FALSE(make_stimulus(one).has_value()) << p.name << " = " << wrong;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Registry, StimulusConformance,
                         ::testing::ValuesIn(Registry<StimulusKind>::instance().names()),
                         [](const auto& kind) { return kind.param; });

}  // namespace
}  // namespace forcegate
