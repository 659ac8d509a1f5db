#include "hil/trace/decimate.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "hil/base/rng.h"

namespace forcegate {
namespace {

struct Signal {
  std::vector<double> t;
  std::vector<float> force, error;
};

Signal make(int n) {
  Rng rng(4, "m4");
  Signal s;
  for (int i = 0; i < n; ++i) {
    s.t.push_back(i * 1e-3);
    s.force.push_back(static_cast<float>(std::sin(i * 0.003)));
    s.error.push_back(static_cast<float>(rng.normal(0, 0.01)));
  }
  return s;
}

DecimatedRows decimate(const Signal& s, std::size_t columns, std::size_t block) {
  M4Accumulator m4(columns, s.t.front(), s.t.back(), 2, {0, 1});
  for (std::size_t at = 0; at < s.t.size(); at += block) {
    const std::size_t n = std::min(block, s.t.size() - at);
    const float* channels[] = {s.force.data() + at, s.error.data() + at};
    m4.push(std::span(s.t).subspan(at, n), channels);
  }
  return m4.rows();
}

TEST(M4Accumulator, KeepsEveryExtremeOfTheTraceAndEveryGlitchOfTheError) {
  Signal s = make(100000);
  for (const int at : {777, 31415, 99998}) s.error[static_cast<std::size_t>(at)] = 5.0f;
  s.force[5] = std::nanf("");
  const auto rows = decimate(s, 300, 1000);
  EXPECT_LE(rows.t_s.size(), 300u * 6);
  EXPECT_EQ(std::count(rows.value[1].begin(), rows.value[1].end(), 5.0f), 3);
  EXPECT_EQ(*std::max_element(rows.value[0].begin() + 1, rows.value[0].end()),
            *std::max_element(s.force.begin() + 6, s.force.end()));
  EXPECT_TRUE(std::is_sorted(rows.t_s.begin(), rows.t_s.end()));
  EXPECT_EQ(rows.t_s.front(), 0.0f);
  EXPECT_EQ(rows.t_s.back(), static_cast<float>(s.t.back()));
}

TEST(M4Accumulator, DoesNotDependOnTheBlocks) {
  const Signal s = make(5000);
  const auto one = decimate(s, 77, 5000);
  for (const std::size_t block : {1u, 7u, 1000u}) {
    const auto other = decimate(s, 77, block);
    EXPECT_EQ(one.t_s, other.t_s);
    EXPECT_EQ(one.value, other.value);
  }
}

TEST(M4Accumulator, KeepsAllRowsOfAShortRecordAndSurvivesAnEmptyOne) {
  const Signal s = make(4);
  EXPECT_EQ(decimate(s, 100, 4).t_s.size(), 4u);
  EXPECT_TRUE(M4Accumulator(10, 0, 1, 2, {0}).rows().t_s.empty());
}

}  // namespace
}  // namespace forcegate
