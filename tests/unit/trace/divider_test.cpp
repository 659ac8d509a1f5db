// A sensor in a divider: its conductance out of volts or counts.

#include "hil/trace/divider.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace forcegate {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

Campaign campaign_of(std::vector<double> U, const std::string& unit, const std::string& quantity) {
  Campaign out;
  Record record;
  record.name = "r01";
  Channel channel;
  channel.name = "U";
  channel.unit = unit;
  channel.quantity = quantity;
  channel.value = std::move(U);
  record.trace.channels.push_back(std::move(channel));
  out.records.push_back(std::move(record));
  return out;
}

TEST(Divider, ReadsOhmsSupplyAndPlace) {
  const auto above = parse_divider("10k:5");
  ASSERT_TRUE(above);
  EXPECT_EQ(above->R_ohm, 10e3);
  EXPECT_EQ(above->supply, 5.0);
  EXPECT_FALSE(above->sensor_below);
  const auto below = parse_divider("4.7k:3.3:below");
  ASSERT_TRUE(below);
  EXPECT_DOUBLE_EQ(below->R_ohm, 4700.0);
  EXPECT_TRUE(below->sensor_below);
  EXPECT_EQ(parse_divider("1M:1024:above")->R_ohm, 1e6);
  for (const char* wrong : {"", "10k", "10k:", ":5", "k:5", "-1:5", "0:5", "10k:0", "10k:nan", "10k:5:beside", "10k:5:below:1", "1e999:5", "10K:5"}) {
    const auto refused = parse_divider(wrong);
    ASSERT_FALSE(refused) << wrong;
    EXPECT_THAT(refused.error().hint, HasSubstr("10k:5")) << wrong;
  }
}

// G = 1/R where the output is at half the supply, whichever of the two is above.
TEST(Divider, UndoesTheCircuit) {
  const double R = 10e3, V = 5.0;
  for (const bool below : {false, true}) {
    std::vector<double> G{2e-6, 1e-5, 1e-4, 5e-4}, U;
    for (const double g : G) U.push_back(below ? V / (1.0 + R * g) : V * R * g / (1.0 + R * g));
    Campaign c = campaign_of(U, "V", "voltage");
    ASSERT_TRUE(read_divider(c, {R, V, below}));
    const Channel& out = *c.records[0].trace.find("U");
    for (std::size_t i = 0; i < G.size(); ++i) EXPECT_NEAR(out.value[i], G[i], 1e-12 * G[i] + 1e-18) << below;
    EXPECT_EQ(out.unit, "S");
    EXPECT_EQ(out.quantity, "conductance");
    EXPECT_THAT(c.notes, ElementsAre(HasSubstr(below ? "below 10000 ohm at 5 V" : "above 10000 ohm at 5 V")));
  }
}

TEST(Divider, CountsNeedNoVolts) {
  Campaign c = campaign_of({512.0}, "counts", "code");
  c.records[0].trace.channels[0].raw = {512};
  ASSERT_TRUE(read_divider(c, {10e3, 1024.0, false}));
  EXPECT_DOUBLE_EQ(c.records[0].trace.channels[0].value[0], 1e-4);
  EXPECT_TRUE(c.records[0].trace.channels[0].raw.empty());
}

TEST(Divider, WhatHasNoConductanceIsMissingAndCounted) {
  std::vector<double> U(40, 1.0);
  U[3] = 5.0;
  U[4] = 5.001;
  U[5] = -0.001;
  U[6] = 0.0;
  Campaign c = campaign_of(U, "V", "voltage");
  ASSERT_TRUE(read_divider(c, {10e3, 5.0, false}));
  const std::vector<double>& G = c.records[0].trace.channels[0].value;
  EXPECT_TRUE(std::isnan(G[3]) && std::isnan(G[4]));
  EXPECT_NEAR(G[5], -0.001 / (10e3 * 5.001), 1e-12) << "noise about no output is a reading";
  EXPECT_EQ(G[6], 0.0);
  EXPECT_THAT(c.notes, ElementsAre(HasSubstr("2 samples at an end of the supply are missing")));
}

TEST(Divider, TheConverterInVoltsIsNoneOfTheConductance) {
  Campaign c = campaign_of({1.0, 2.0, 3.0}, "V", "voltage");
  c.bench.voltage_min_V = 0.0, c.bench.voltage_max_V = 5.0, c.bench.adc_bits = 12;
  ASSERT_TRUE(read_divider(c, {10e3, 5.0, false}));
  EXPECT_FALSE(std::isfinite(c.bench.voltage_max_V));
  EXPECT_EQ(c.bench.adc_bits, 0);
}

TEST(Divider, AWrongSupplyOrAnotherOutputIsAnError) {
  Campaign counts = campaign_of({100.0, 200.0, 300.0}, "counts", "code");
  const auto volts = read_divider(counts, {10e3, 5.0, false});
  ASSERT_FALSE(volts);
  EXPECT_THAT(volts.error().text, HasSubstr("3 of 3 samples"));
  EXPECT_THAT(volts.error().hint, HasSubstr("1024 for 10 bits"));
  Campaign siemens = campaign_of({1e-5}, "S", "conductance");
  EXPECT_THAT(read_divider(siemens, {10e3, 5.0, false}).error().text, HasSubstr("this one is in S"));
}

}  // namespace
}  // namespace forcegate
