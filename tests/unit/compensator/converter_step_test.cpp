// The step of a converter that a campaign declares, or not.

#include <gtest/gtest.h>

#include <cmath>

#include "hil/app/export/compensator_check.h"

namespace forcegate {
namespace {

CompensatorCheck check_on(int bits, double low_V, double high_V, const std::string& unit = "V") {
  Model m;
  m.frame.span_N = 4.0;
  m.law.gain_N_per_V = 0.5;
  m.output_unit = unit;
  Campaign c;
  c.name = "c";
  c.bench.adc_bits = bits;
  c.bench.voltage_min_V = low_V, c.bench.voltage_max_V = high_V;
  Record r;
  r.name = "r";
  r.dynamic = false;
  r.trace.time_bases.emplace_back();
  r.trace.time_bases[0].nominal_rate_Hz = 100.0;
  Channel F{"F_ref", "N", "force", 0, {}, {}}, U{"U", "V", "voltage", 0, {}, {}};
  for (int i = 0; i < 2000; ++i) {
    r.trace.time_bases[0].t_s.push_back(0.01 * i);
    F.value.push_back(2.0 + std::sin(0.01 * i));
    U.value.push_back(2.0 * F.value.back());
  }
  r.trace.channels = {F, U};
  c.records = {r};
  const auto made = make_compensator(m, {});
  EXPECT_TRUE(made);
  const auto check = check_compensator(m, *made, 1000.0, c);
  EXPECT_TRUE(check) << (check ? "" : check.error().to_text());
  return check ? *check : CompensatorCheck{};
}

TEST(ConverterStep, IsThatOfTheDeclaredRangeFromEndToEnd) {
  const CompensatorCheck check = check_on(12, -1.0, 10.0);
  EXPECT_NEAR(check.lsb_N, 0.5 * 11.0 / 4095.0, 1e-12);
  EXPECT_EQ(check.assumed, "");
}

TEST(ConverterStep, SaysWhatIsAssumedAndHowToStateIt) {
  EXPECT_EQ(check_on(0, -1.0, 10.0).assumed,
            "an LSB is here that of 16 bits over 11 V; the campaign does not say how many bits the converter has: write adc_bits into \"bench\" of campaign.json");
  EXPECT_EQ(check_on(12, kMissing, kMissing).assumed,
            "an LSB is here that of 12 bits over 10 V; the campaign does not say what range the converter has: write voltage_range_V into \"bench\" of campaign.json");
  EXPECT_NE(check_on(0, kMissing, kMissing).assumed.find("adc_bits and voltage_range_V"), std::string::npos);
  EXPECT_EQ(check_on(0, kMissing, kMissing, "counts").assumed, "") << "a count is a count";
}

}  // namespace
}  // namespace forcegate
