#include "hil/diagnose/answer/capacitance_witness.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "hil/base/rng.h"
#include "hil/diagnose/engine.h"

namespace forcegate::diagnose {
namespace {

enum class Moves { nothing, reference, output };

// Eight static records; a zero warms up by `size_N` over the campaign.
Campaign make_campaign(Moves moves, bool with_capacitance, double size_N = 0.25) {
  Campaign c;
  c.name = "made";
  c.bench.reference_resolution_N = 0.025;
  c.bench.voltage_min_V = 0.0;
  c.bench.voltage_max_V = 10.0;
  Rng rng(31, "campaign");
  for (int k = 0; k < 8; ++k) {
    Record r;
    r.name = "r" + std::to_string(k);
    r.kind = k % 2 == 0 ? "ramp" : "staircase";
    r.start_s = 900.0 * k;
    r.dynamic = false;
    r.role = k == 3 || k == 6 ? RecordRole::heldout : RecordRole::fit;
    TimeBase clock;
    std::vector<double> F, U, C;
    for (int i = 0; i < 12000; ++i) {
      const double t = i / 100.0, phase = std::fmod(t / 60.0, 1.0),
                   up = phase < 0.5 ? 2.0 * phase : 2.0 - 2.0 * phase;
      const double force = k % 2 == 0
                               ? 0.2 + 4.2 * up
                               : 0.5 + 0.7 * std::min(std::floor(t / 12.0), std::floor((120.0 - t) / 12.0));
      const double zero_N = size_N * (1.0 - std::exp(-(900.0 * k + t) / 2000.0));
      clock.t_s.push_back(t);
      F.push_back(
          std::round((force + (moves == Moves::reference ? zero_N : 0.0) + 0.006 * rng.normal()) / 0.025) *
          0.025);
      U.push_back(std::clamp(
          0.2 + 2.0 * (force + (moves == Moves::output ? zero_N : 0.0)) + 0.004 * rng.normal(), 0.0, 10.0));
      C.push_back(1e-12 * (200.0 + 9.0 * force - 0.2 * force * force + 0.3 * rng.normal()));
    }
    r.trace.time_bases.push_back(clock);
    r.trace.channels.push_back({"F_ref", "N", "force", 0, F, {}});
    r.trace.channels.push_back({"U", "V", "voltage", 0, U, {}});
    if (with_capacitance) r.trace.channels.push_back({"C", "F", "capacitance", 0, C, {}});
    c.records.push_back(std::move(r));
  }
  return c;
}

Finding drift_found(Moves moves, bool with_capacitance) {
  EngineOptions options;
  options.threads = 1;
  auto out = diagnose_campaign(make_campaign(moves, with_capacitance), options);
  EXPECT_TRUE(out.has_value()) << (out ? "" : out.error().to_text());
  if (out)
    for (const Finding& f : out->findings)
      if (f.effect == "reference_drift") return f;
  ADD_FAILURE() << "no drift was found";
  return {};
}

TEST(CapacitanceWitness, tells_that_the_reference_moves) {
  const Finding f = drift_found(Moves::reference, true);
  EXPECT_EQ(f.side, "reference");
  EXPECT_TRUE(f.side_witnessed) << f.evidence;
  EXPECT_NE(f.evidence.find("the capacitance departs"), std::string::npos) << f.evidence;
}

TEST(CapacitanceWitness, tells_that_the_output_of_the_sensor_moves) {
  const Finding f = drift_found(Moves::output, true);
  EXPECT_EQ(f.side, "sensor");
  EXPECT_TRUE(f.side_witnessed) << f.evidence;
  EXPECT_NE(f.evidence.find("the capacitance stays"), std::string::npos) << f.evidence;
}

TEST(CapacitanceWitness, without_a_capacitance_the_side_is_not_told) {
  const Finding f = drift_found(Moves::reference, false);
  EXPECT_FALSE(f.side_witnessed);
  EXPECT_NE(f.evidence.find("cannot be told"), std::string::npos) << f.evidence;
}

TEST(CapacitanceWitness, too_few_blocks_carry_no_answer) {
  CampaignInput input;
  input.range_N = 5.0;
  EXPECT_EQ(hear_capacitance(input).side, CapacitanceWitness::Side::unknown);
  EXPECT_EQ(hear_capacitance(input).blocks, 0u);
}

// Blocks of 30 s in static records; the capacitance shows `share` of what the output departs by.
CampaignInput seen_by_half(double share, double duration_s) {
  CampaignInput input;
  input.range_N = 5.0;
  for (int k = 0; k < 4; ++k) {
    RecordInput r;
    for (double t = 0.0; t < duration_s; t += 0.5) {
      const double F = 2.5 + 2.0 * std::sin(0.3 * t), zero_N = 0.1 * std::sin(1.0 + k + 0.012 * t);
      r.t_s.push_back(t);
      r.F_N.push_back(F);
      r.U_V.push_back(0.2 + 2.0 * (F + zero_N));
      r.C_F.push_back(1e-12 * (200.0 + 9.0 * (F + share * zero_N)));
      r.ok.push_back(1);
    }
    input.records.push_back(std::move(r));
  }
  return input;
}

TEST(CapacitanceWitness, what_it_shows_by_half_is_told_as_that) {
  Finding between, little, none;
  decide_by_capacitance(seen_by_half(0.5, 300.0), between);
  EXPECT_FALSE(between.side_witnessed);
  EXPECT_NE(between.evidence.find("share of 0.5"), std::string::npos) << between.evidence;
  EXPECT_EQ(between.evidence.find("without a third channel"), std::string::npos) << between.evidence;
  decide_by_capacitance(seen_by_half(0.5, 20.0), little);
  EXPECT_NE(little.evidence.find("too short a time"), std::string::npos) << little.evidence;
  decide_by_capacitance(CampaignInput{}, none);
  EXPECT_NE(none.evidence.find("without a third channel"), std::string::npos) << none.evidence;
}

TEST(CapacitanceWitness, blocks_that_hang_together_count_for_less) {
  const auto uncertainty = [](bool in_order) {
    CampaignInput input = seen_by_half(0.9, 900.0);
    int block = 0;
    for (RecordInput& r : input.records)
      for (int b = 0; b < 30; ++b, ++block)
        for (int i = 0; i < 60; ++i) {
          const double slow = std::sin(0.12 * block), quick = block % 2 == 0 ? 1.0 : -1.0;
          r.C_F[static_cast<std::size_t>(60 * b + i)] += 1e-13 * (in_order ? slow * std::sqrt(2.0) : quick);
        }
    return hear_capacitance(input).u_share;
  };
  EXPECT_GT(uncertainty(true), 1.5 * uncertainty(false));
}

}  // namespace
}  // namespace forcegate::diagnose
