#include "hil/diagnose/raw/edges.h"

#include <gtest/gtest.h>

#include <cmath>

#include "hil/base/rng.h"

namespace forcegate::diagnose {
namespace {

constexpr double kRate_Hz = 200.0;
constexpr int kEvery = 400;  // samples from step to step

// Steps of a newton, up and down, within so many samples, with a noise of 5 mN.
Record steps(double lasts = 12.0) {
  Rng rng(3, "steps");
  Record out;
  TimeBase clock;
  std::vector<double> F, U;
  for (int i = 0; i < 8000; ++i) {
    clock.t_s.push_back(100.0 + i / kRate_Hz);
    const double moved = std::min(1.0, (i % kEvery) / lasts), share = 0.5 * (1.0 - std::cos(M_PI * moved));
    F.push_back(1.0 + ((i / kEvery) % 2 == 0 ? 1.0 - share : share) + 0.005 * rng.normal());
    U.push_back(2.0 * F.back());
  }
  out.trace.time_bases.push_back(clock);
  out.trace.channels.push_back({"F_ref", "N", "force", 0, F, {}});
  out.trace.channels.push_back({"U", "V", "voltage", 0, U, {}});
  return out;
}

RecordHealth quiet() {
  RecordHealth out;
  out.noise_F_N = 0.005;
  return out;
}

Edges edges_in(const Record& record, const RecordHealth& health, std::span<const std::uint8_t> bad) {
  const Channel* force = record.trace.find("F_ref");
  return edges_of(record, force != nullptr ? force->value : std::vector<double>(), health, bad);
}

TEST(Edges, AreWhereTheForceStepsWithARunUpBeforeEach) {
  const Edges edges = edges_in(steps(), quiet(), {});
  EXPECT_GE(edges.windows.size(), 19u);
  ASSERT_EQ(edges.t_s.size(), edges.sample.size());
  ASSERT_EQ(edges.F_N.size(), edges.U_V.size());
  std::size_t last = 0;
  for (const Edges::Window& w : edges.windows) {
    EXPECT_GE(w.begin, last);
    last = w.end;
    const std::size_t from = edges.sample[w.begin], to = edges.sample[w.end - 1];
    EXPECT_TRUE(from / kEvery + 1 == to / kEvery || from % kEvery < 15) << "a step lies within: " << from;
    ASSERT_GE(w.begin, 50u);
    EXPECT_LE(edges.sample[w.begin - 50], from - 50) << "a quarter of a second before it";
  }
  for (std::size_t k = 1; k < edges.t_s.size(); ++k) EXPECT_GT(edges.t_s[k], edges.t_s[k - 1]);
  EXPECT_NEAR(edges.t_s.front(), edges.sample.front() / kRate_Hz, 1e-9) << "from the start of the record";
  EXPECT_DOUBLE_EQ(edges.noise_F_N, 0.005);
}

// What the force did within one sample nobody saw.
TEST(Edges, FasterThanTheSamplesAreNone) { EXPECT_TRUE(edges_in(steps(1.0), quiet(), {}).empty()); }

TEST(Edges, NoiseAloneHasNone) {
  Record still = steps();
  Rng rng(9, "still");
  for (double& f : still.trace.find("F_ref")->value) f = 1.0 + 0.005 * rng.normal();
  EXPECT_TRUE(edges_in(still, quiet(), {}).empty());
}

TEST(Edges, StandNeitherOverBadSamplesNorOverGapsOrMissingOnes) {
  std::vector<std::uint8_t> bad(8000, 0);
  bad[kEvery + 2] = 1;
  Record record = steps();
  record.trace.find("F_ref")->value[2 * kEvery - 5] = std::nan("");
  record.trace.find("U")->value[3 * kEvery + 1] = std::nan("");
  for (std::size_t i = 4 * kEvery + 1; i < 8000; ++i) record.trace.time_bases.front().t_s[i] += 0.2;
  const Edges edges = edges_in(record, quiet(), bad);
  EXPECT_FALSE(edges.empty());
  for (const Edges::Window& w : edges.windows) EXPECT_GT(edges.sample[w.begin], 4u * kEvery);
}

TEST(Edges, HaveTheForceAsItWasRecorded) {
  Record record = steps();
  std::vector<double> recorded = record.trace.find("F_ref")->value;
  for (double& f : record.trace.find("F_ref")->value) f = 1.5;
  const Edges edges = edges_of(record, recorded, quiet(), {});
  ASSERT_FALSE(edges.empty());
  for (std::size_t k = 0; k < edges.sample.size(); ++k) EXPECT_EQ(edges.F_N[k], recorded[edges.sample[k]]);
}

TEST(Edges, OfTwoClocksAndOfAFewSamplesThereAreNone) {
  Record two = steps();
  two.trace.time_bases.push_back(two.trace.time_bases.front());
  two.trace.find("U")->time_base = 1;
  EXPECT_TRUE(edges_in(two, quiet(), {}).empty());
  Record few = steps();
  few.trace.time_bases.front().t_s.resize(20);
  for (Channel& c : few.trace.channels) c.value.resize(20);
  EXPECT_TRUE(edges_in(few, quiet(), {}).empty());
  EXPECT_TRUE(edges_in(Record{}, quiet(), {}).empty());
}

}  // namespace
}  // namespace forcegate::diagnose
