// Zero of a step response: the first command to the motor's velocity controller (III-B), whatever the rate of the rig.

#include <gtest/gtest.h>

#include <cmath>

#include "hil/characterize/session.h"
#include "tests/support/fake_rig.h"
#include "tests/support/value_or_abort.h"

namespace forcegate::test {
namespace {

using namespace characterize;

// Its converter shows volts(time since the wheel was first told to jump).
class JumpingRig final : public testing::FakeRig {
 public:
  explicit JumpingRig(double rate_Hz, const std::function<double(double)>& volts) {
    change_info().rate_Hz = rate_Hz;
    spoil = [this, volts, rate_Hz](std::size_t row, double t_s, RigBlock& block) {
      next_s_ = t_s + 1.0 / rate_Hz;
      block.adc[row] = static_cast<std::uint16_t>(std::lround(volts(t_s - told_s) * 6553.5));
    };
  }
  Result<void> command_velocity(double rad_per_s) override {
    if (std::abs(rad_per_s) > 5.0) told_s = std::min(told_s, next_s_);
    return FakeRig::command_velocity(rad_per_s);
  }
  double told_s = 1e9;

 private:
  double next_s_ = 0.0;
};

SessionSheet measured(JumpingRig& rig) {
  const StudyPlan plan;
  const CompensationMaker none;
  BenchProgress progress;
  Bench bench(rig, {}, progress);
  Session session(bench, plan, "fsr", none, true);
  const ProcedureKind* kind = Registry<ProcedureKind>::instance().find("step_response");
  EXPECT_NE(kind, nullptr);
  const auto done = kind->run(session);
  EXPECT_TRUE(done) << (done ? "" : done.error().text);
  return session.sheet;
}

TEST(StepResponse, CountsFromTheCommandToTheMotor) {
  constexpr double kPole_s = 0.05;
  for (const double rate_Hz : {1000.0, 250.0}) {
    JumpingRig rig(rate_Hz, [](double t_s) { return 2.0 + (t_s < 0.0 ? 0.0 : 3.0 * -std::expm1(-t_s / kPole_s)); });
    const SessionSheet sheet = measured(rig);
    EXPECT_NEAR(rig.told_s, 2.0 - 0.01, 0.0025) << rate_Hz;
    EXPECT_NEAR(sheet.value("step.sensor"), 1e3 * kPole_s * std::log(20.0), 0.5 + 1e3 / rate_Hz) << rate_Hz;
    ASSERT_EQ(sheet.curves.size(), 1u);
    EXPECT_NEAR(sheet.curves[0].zero_s, rig.told_s, 1e-9) << rate_Hz;
  }
}

TEST(StepResponse, IsNotMeasuredWhereNothingSettles) {
  JumpingRig ringing(1000.0, [](double t_s) { return 4.0 + (t_s < 0.0 ? -3.0 : std::sin(40.0 * t_s)); });
  EXPECT_TRUE(std::isnan(measured(ringing).value("step.sensor")));
}

}  // namespace
}  // namespace forcegate::test
