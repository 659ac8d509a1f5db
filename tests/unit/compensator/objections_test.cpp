// Which records a header makes worse, and what of it no firmware could know.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "hil/app/export/compensator_check.h"
#include "hil/model/base_law.h"
#include "tests/unit/compensator/declare_cycled.h"

namespace forcegate {
namespace {

ReplayedRecord replayed(const std::string& name, double plain_N, double compensated_N, double own_plain_N, double own_compensated_N) {
  ReplayedRecord r;
  r.record = name;
  r.plain_rms_N = plain_N;
  r.compensated_rms_N = compensated_N;
  r.own_plain_rms_N = own_plain_N;
  r.own_compensated_rms_N = own_compensated_N;
  return r;
}

CompensatorCheck check_of(std::vector<ReplayedRecord> records) {
  CompensatorCheck out;
  for (const ReplayedRecord& r : records) {
    out.plain_rms_N += r.plain_rms_N * r.plain_rms_N / static_cast<double>(records.size());
    out.compensated_rms_N += r.compensated_rms_N * r.compensated_rms_N / static_cast<double>(records.size());
  }
  out.plain_rms_N = std::sqrt(out.plain_rms_N);
  out.compensated_rms_N = std::sqrt(out.compensated_rms_N);
  out.records = std::move(records);
  return out;
}

bool says(const CompensatorCheck& check, const std::string& words) {
  const std::vector<std::string> said = objections(check);
  return said.size() == 1 && said[0].find(words) != std::string::npos;
}

TEST(Objections, OneRecordThatIsOffByItselfIsNamedAndTheOthersAreNotCondemnedWithIt) {
  const CompensatorCheck check = check_of({replayed("r1", 0.11, 0.017, 0.1, 0.011), replayed("r2", 0.088, 0.025, 0.077, 0.017), replayed("r3", 0.068, 0.013, 0.021, 0.012),
                                           replayed("odd", 0.178, 0.286, 0.116, 0.111)});
  ASSERT_EQ(objections(check).size(), 1u);
  EXPECT_TRUE(says(check, "by odd alone; the other 3 records 90.3 -> 19 mN")) << objections(check)[0];
  EXPECT_TRUE(says(check, "With a gain and a zero of its own 116 -> 111 mN")) << objections(check)[0];
  EXPECT_FALSE(says(check, "do not build it in"));
}

TEST(Objections, AnErrorThatIsNotSmallerIsToldWithinTheToleranceToo) {
  const auto alike = [](double with_N) { return check_of({replayed("r1", 0.05, with_N, 0.02, 0.02), replayed("r2", 0.05, with_N, 0.02, 0.02)}); };
  for (const double with_N : {0.05, 0.0505}) {
    EXPECT_TRUE(objections(alike(with_N)).empty());
    EXPECT_NE(gains_nothing(alike(with_N)).find("is not smaller with the header than with the law alone: 50 -> "), std::string::npos) << gains_nothing(alike(with_N));
  }
  EXPECT_EQ(gains_nothing(alike(0.0499)), "");
  EXPECT_EQ(objections(alike(0.052)).size(), 1u);
  EXPECT_EQ(gains_nothing(alike(0.052)), "") << "an objection says it";
}

TEST(Objections, WhereMostRecordsAreWorseACalibrationOfEachMayOrMayNotMendIt) {
  const CompensatorCheck differ = check_of({replayed("r1", 0.03, 0.05, 0.02, 0.005), replayed("r2", 0.02, 0.03, 0.02, 0.004), replayed("r3", 0.03, 0.05, 0.02, 0.005)});
  EXPECT_TRUE(says(differ, "(3 of 3 records): do not build it in"));
  EXPECT_TRUE(says(differ, "a calibration before each"));
  EXPECT_FALSE(says(differ, "would not mend it"));
  const CompensatorCheck wrong = check_of({replayed("r1", 0.03, 0.05, 0.02, 0.03), replayed("r2", 0.02, 0.03, 0.02, 0.03), replayed("r3", 0.03, 0.05, 0.02, 0.03)});
  EXPECT_TRUE(says(wrong, "do not build it in"));
  EXPECT_TRUE(says(wrong, "a calibration before each would not mend it"));
}

// One sine loses more of its swing than the law has it. In newtons it is off by much, and had bent the line of the ramps too.
TEST(CompensatorCheck, ARecordOfAnotherDecayDoesNotBendTheLineOfTheOthers) {
  Model m;
  m.frame.span_N = 4.0;
  m.law.gain_N_per_V = 0.5;
  m.law.offset_N = 0.12;
  const double rate_Hz = 200.0;
  Campaign c;
  c.bench.adc_bits = 16;
  c.bench.voltage_max_V = 10.0;
  for (const bool dynamic : {false, false, false, false, true}) {
    Record r;
    r.name = dynamic ? "sine" : "ramp";
    r.dynamic = false;
    if (dynamic) declare_cycled(r);
    TimeBase clock;
    clock.nominal_rate_Hz = rate_Hz;
    Channel F{"F_ref", "N", "force", 0, {}, {}}, U{"U", "V", "voltage", 0, {}, {}};
    for (int i = 0; i < static_cast<int>(rate_Hz * (dynamic ? 400.0 : 60.0)); ++i) {
      const double t = i / rate_Hz, force = dynamic ? (t < 2.0 ? 1.1 : 2.15 - 1.05 * std::cos(std::numbers::pi * (t - 2.0))) : 2.1 - 2.0 * std::cos(0.2 * t);
      const double D = dynamic ? decay_factor(t - 2.0, 2.0 * m.law.decay_rate_per_s(0.5), 0.5 * m.law.depth_ratio(1.05)) : 1.0;
      clock.t_s.push_back(t);
      F.value.push_back(force);
      U.value.push_back(((dynamic ? 1.1 + D * (force - 1.1) : force) - 0.12) / 0.5);
    }
    r.trace.time_bases.push_back(std::move(clock));
    r.trace.channels = {std::move(F), std::move(U)};
    c.records.push_back(std::move(r));
  }
  const auto made = make_compensator(m, {});
  ASSERT_TRUE(made) << made.error().to_text();
  const auto check = check_compensator(m, *made, 1000.0, c);
  ASSERT_TRUE(check) << check.error().to_text();
  ASSERT_EQ(check->records.size(), 5u);
  EXPECT_GT(check->records[4].plain_rms_N, 0.2);
  EXPECT_LT(check->records[0].plain_rms_N, 0.1 * check->records[4].plain_rms_N);
  EXPECT_LT(check->records[0].own_plain_rms_N, 1e-3);
}

}  // namespace
}  // namespace forcegate
