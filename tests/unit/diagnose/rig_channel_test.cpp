#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/unit/diagnose/turning_bench.h"

namespace forcegate::diagnose {
namespace {

TEST(RigChannel, AReferenceThatReadsAFewMillisecondsLateIsNoBacklash) {
  Bench bench;
  bench.reference_lag_s = 0.004;
  const Diagnosis d = diagnose(bench);
  EXPECT_EQ(claims(d), "");
  EXPECT_EQ(to_string(d.verdict), "none");
}

TEST(RigChannel, AReferenceThatIsHalfAMillisecondLateIsNoPushFromTheSide) {
  Bench bench;
  bench.reference_lag_s = 0.0004;
  bench.turns_Hz.fill(2.0);  // at one speed the two are the same but for their size
  const Diagnosis d = diagnose(bench);
  EXPECT_EQ(claims(d), "");
  EXPECT_EQ(to_string(d.verdict), "none");
}

// From record to record at will, as no smooth course over the campaign does.
double jump_N(int record) {
  constexpr std::array<double, 7> kJump_N = {0.12, -0.15, 0.05, 0.2, -0.1, -0.05, 0.15};
  return kJump_N[static_cast<std::size_t>(record)];
}

TEST(RigChannel, AZeroThatJumpsAtWillIsTheReferencesWhereTheRigShowsTheSame) {
  Bench bench;
  bench.zero_N = [](double t_s) { return jump_N(static_cast<int>(t_s / 1500.0)); };
  const Diagnosis d = diagnose(bench);
  EXPECT_EQ(claims(d), "reference_drift ");
  ASSERT_FALSE(d.findings.empty());
  EXPECT_EQ(d.findings.front().form, "as_rig_shows");
  EXPECT_EQ(d.findings.front().side, "reference");
  ASSERT_EQ(d.findings.front().parameters.size(), 1u);
  EXPECT_NEAR(d.findings.front().parameters.front().value, -1.0, 4.0 * d.findings.front().parameters.front().u + 0.01);
  EXPECT_LT(d.error_after, 0.3 * d.error_before);
}

// The rig was set up anew for each record: the output follows what the reference reads, and nobody is to blame.
// A course that seven records bear out no better than even: the output shows the same, turned over and of the same size.
TEST(RigChannel, AZeroOfNoPlainCourseIsTheReferencesWhereTheOutputShowsTheSame) {
  Bench bench;
  bench.zero_N = [](double t) { return 0.15 * -std::expm1(-t / 2500.0) + 0.05 * std::sin(t / 620.0); };
  const Diagnosis d = diagnose(bench);
  EXPECT_EQ(claims(d), "reference_drift ");
  ASSERT_FALSE(d.findings.empty());
  EXPECT_EQ(d.findings.front().form, "as_rig_shows");
}

TEST(RigChannel, AForceBesideTheDeclaredPreloadIsNoDriftOfTheReference) {
  Bench bench;
  bench.seat_N = jump_N;
  EXPECT_EQ(claims(diagnose(bench)).find("reference_drift"), std::string::npos);
}

TEST(RigChannel, AZeroThatMovesIsSeenBesideALateReference) {
  Bench bench;
  bench.reference_lag_s = 0.003;
  bench.zero_N = [](double t) { return 0.06 * std::log1p(t / 2000.0) - 0.05 * std::cos(t / 2500.0); };
  EXPECT_EQ(claims(diagnose(bench)), "reference_drift ");
}

TEST(RigChannel, AWheelThatLeavesTheSensorIsContactLoss) {
  Bench bench;
  bench.lift_N = 0.6;
  const Diagnosis d = diagnose(bench);
  ASSERT_FALSE(d.findings.empty());
  EXPECT_EQ(d.findings.front().effect, "contact_loss");
}

// Set back in the records in which it turns, by another way in each; slow records go down to the same forces and stay in contact.
TEST(RigChannel, AGapThatIsAnotherInEveryRecordIsContactLoss) {
  Bench bench;
  bench.seat_N = [](int n) { return n % 2 == 1 ? -0.6 - 0.13 * n : 0.0; };
  const Diagnosis d = diagnose(bench);
  EXPECT_EQ(claims(d), "contact_loss ");
  const auto force = d.errors.find("F");
  ASSERT_NE(force, d.errors.end());
  EXPECT_LT(force->second.after, 0.1 * force->second.before);
}

// The wheel bounces where it comes back fast: one record leaves more than all others lose.
TEST(RigChannel, AWheelThatBouncesInItsFastestRecordHasLeftTheSensorInTheOthers) {
  Bench bench;
  bench.lift_N = 0.6;
  bench.bounce_N = [](int n, double t) { return n == 5 ? 0.8 * std::sin(2.0 * std::numbers::pi * 9.3 * t) : 0.0; };
  EXPECT_EQ(claims(diagnose(bench)), "contact_loss ");
}

// The others, each left out in turn, know nothing of a gap, and their error stays what it was.
TEST(RigChannel, AGapInOneRecordAloneIsContactLoss) {
  for (const int of : {1, 3, 5}) {
    Bench bench;
    bench.seat_N = [of](int n) { return n == of ? -0.7 - 0.075 * n : 0.0; };
    EXPECT_EQ(claims(diagnose(bench)), "contact_loss ") << of;
  }
}

// A preload that is larger than declared opens no contact.
TEST(RigChannel, AForceBesideTheDeclaredPreloadOpensNoContact) {
  Bench bench;
  bench.seat_N = [](int n) { return n % 2 == 1 ? 0.4 + 0.05 * n : 0.0; };
  EXPECT_EQ(claims(diagnose(bench)).find("contact_loss"), std::string::npos);
}

TEST(RigChannel, FrictionOfTheGuideIsALoopOnEitherSideOfTheReference) {
  for (const double friction_N : {-0.06, 0.06}) {
    Bench bench;
    bench.friction_N = friction_N;
    const Diagnosis d = diagnose(bench);
    EXPECT_EQ(claims(d), "backlash ") << friction_N;
    ASSERT_FALSE(d.findings.empty());
    EXPECT_LT(d.findings.front().error_after, 0.4 * d.findings.front().error_before) << friction_N;
    ASSERT_FALSE(d.findings.front().parameters.empty());
    EXPECT_EQ(d.findings.front().parameters.front().name, "loop_width_N");
    EXPECT_NEAR(d.findings.front().parameters.front().value, -2.0 * friction_N, 0.02) << "of the way down over the way up";
  }
}

double rms(const std::vector<double>& x) {
  double square = 0.0;
  for (const double v : x) square += v * v;
  return std::sqrt(square / static_cast<double>(x.size()));
}

TEST(RigChannel, AClaimOnTheRigIsShownAgainstTheAngleOnARecordThatNoFitSaw) {
  Bench bench;
  bench.friction_N = 0.06;
  const Diagnosis d = diagnose(bench, true);
  ASSERT_FALSE(d.findings.empty());
  const Finding& backlash = d.findings.front();
  ASSERT_EQ(backlash.effect, "backlash");
  ASSERT_FALSE(backlash.series.empty());
  const EvidenceSeries& s = backlash.series.front();
  EXPECT_EQ(s.x_name, "angle");
  EXPECT_EQ(s.y_unit, "N");
  EXPECT_FALSE(s.record.empty());
  EXPECT_LT(rms(s.after), 0.5 * rms(s.before));
  EXPECT_NEAR(rms(s.before), bench.friction_N, 0.5 * bench.friction_N) << "in newtons, not in shares of the span";
  const auto [low, high] = std::ranges::minmax(s.x);
  EXPECT_GE(low, -180.0);
  EXPECT_LE(high, 180.0);
  EXPECT_GT(high - low, 90.0);
}

TEST(RigChannel, AnUnevenDriveIsShownAgainstItsCommand) {
  Bench bench;
  bench.slip_rad = [](double th) { return 0.03 * std::sin(5.0 * th + 0.4) - 0.03 * std::sin(0.4); };
  const Diagnosis d = diagnose(bench, true);
  ASSERT_FALSE(d.findings.empty());
  ASSERT_EQ(d.findings.front().effect, "motor");
  ASSERT_FALSE(d.findings.front().series.empty());
  EXPECT_EQ(d.findings.front().series.front().x_name, "command");
  EXPECT_LT(rms(d.findings.front().series.front().after), 0.5 * rms(d.findings.front().series.front().before));
}

TEST(RigChannel, AWheelThatTurnsUnevenlyIsTheMotor) {
  Bench bench;
  bench.slip_rad = [](double th) { return 0.03 * std::sin(5.0 * th + 0.4) - 0.03 * std::sin(0.4); };
  EXPECT_EQ(claims(diagnose(bench)), "motor ");
}

TEST(RigChannel, ASlightUnevennessOfSeveralMultiplesIsTheMotorThoughTheReferenceIsCoarse) {
  Bench bench;
  bench.resolution_N = 0.025;
  bench.slip_rad = [](double th) {
    return 0.008 * (std::sin(2.0 * th + 0.7) - std::sin(0.7)) + 0.006 * std::sin(5.0 * th);
  };
  EXPECT_EQ(claims(diagnose(bench)), "motor ");
}

TEST(RigChannel, AMachineWithoutAnAngleShowsThePitchOfItsScrew) {
  Bench bench;
  bench.angle = false;
  bench.machine_N = [](double F) { return 0.02 * std::sin(2.0 * std::numbers::pi * F / 0.55 + 0.7); };
  const Diagnosis d = diagnose(bench);
  EXPECT_EQ(claims(d), "motor ");
  ASSERT_FALSE(d.findings.empty());
  EXPECT_EQ(d.findings.front().form, "pitch");
  EXPECT_EQ(d.findings.front().side, "rig");
}

TEST(RigChannel, ACurveOfAMachineIsItsSpringAndNoPitch) {
  Bench bench;
  bench.angle = false;
  bench.machine_N = [](double F) { return 0.05 * F * (1.0 - F / 5.0) - 0.004 * F * F * F / 5.0; };
  EXPECT_EQ(claims(diagnose(bench)), "spring_nonlinearity ");
}

TEST(RigChannel, TheSidewaysPushOfAnEccentricGrowsWithItsEccentricity) {
  Bench bench;
  bench.eccentricity_mm = [](int record) { return 3.0 + 1.0 * (record % 5); };
  bench.push = [](double F, double e, double th) {
    const double across = e * std::sin(th);
    return 0.15 * F * across / std::sqrt(24.0 * 24.0 - across * across);
  };
  const Diagnosis d = diagnose(bench);
  EXPECT_EQ(claims(d), "off_axis ");
  EXPECT_FALSE(d.residual_unknown);
}

// Some records turn, some go to and fro, where the same push is a function of the force.
TEST(RigChannel, ASidewaysPushThatSaturatesIsOnePushAndNoCurveOfTheSensor) {
  Bench bench;
  bench.push = [](double, double, double th) { return 0.1 * std::tanh(2.0 * std::sin(th)); };
  const Diagnosis mixed = diagnose(bench);
  EXPECT_EQ(claims(mixed), "off_axis ");
  EXPECT_FALSE(mixed.residual_unknown);
  bench.turns_Hz = {0.4, 1.5, 3.0, 0.4, 1.5, 3.0, 0.7};
  const Diagnosis turning_only = diagnose(bench);
  EXPECT_EQ(claims(turning_only), "off_axis ");
  EXPECT_FALSE(turning_only.residual_unknown);
}

// One record turns, in the others the wheel stays on one side; a late reference takes part of the push for its own in the fast one.
TEST(RigChannel, ASidewaysPushThatSaturatesIsOnePushThoughItsStrengthsScatter) {
  Bench bench;
  bench.reference_lag_s = 0.003;
  bench.turns_Hz = {0.0, 0.0, 0.0, 1.5, 0.0, 0.0, 0.0};
  bench.push = [](double, double, double th) { return 0.1 * std::tanh(5.0 * std::sin(th)); };
  EXPECT_EQ(claims(diagnose(bench)), "off_axis ");
}

// From one preload: from several the same force comes from several sides.
TEST(RigChannel, APushOfAWheelThatStaysOnOneSideIsACurveOfTheForce) {
  Bench bench;
  bench.turns_Hz = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
  bench.push = [](double, double, double th) { return 0.3 * std::sin(th); };
  EXPECT_EQ(claims(diagnose(bench)), "off_axis ");
  bench.preload_mm = [](int) { return 1.0; };
  EXPECT_EQ(claims(diagnose(bench)), "static_nonlinearity ");
}

// At 4 Hz a reference that is 3 ms late looks like a third of the push, at 0.1 Hz like nothing of it.
TEST(RigChannel, ASidewaysPushIsOneBesideALateReference) {
  Bench bench;
  bench.reference_lag_s = 0.003;
  bench.turns_Hz = {0.0, 0.1, 0.0, 0.3, 0.0, 4.0, 0.0};
  bench.push = [](double F, double e, double th) { return 0.05 * F * e / 24.0 * std::sin(th); };
  const Diagnosis d = diagnose(bench);
  EXPECT_EQ(claims(d), "off_axis ");
}

// Sensor and reference feel it alike.
TEST(RigChannel, AWheelThatIsNotRoundIsMissingFromTheRigsLawThoughNoEffectIs) {
  Bench bench;
  bench.rim_N = [](double th) { return 0.03 * std::cos(5.0 * th + 1.0); };
  const Diagnosis d = diagnose(bench);
  EXPECT_EQ(claims(d), "");
  EXPECT_EQ(d.verdict, DiagnosisVerdict::unknown);
  ASSERT_FALSE(d.depends_on.empty());
  EXPECT_EQ(d.depends_on.front(), "angle");
  ASSERT_FALSE(d.follows.empty());
  EXPECT_NE(d.follows.front().find("departs from the rig's law by 1"), std::string::npos) << d.follows.front();
  ASSERT_EQ(d.rig_maps.size(), 1u);
  EXPECT_EQ(d.rig_maps.front().coordinate, "angle");
  ASSERT_EQ(d.rig_maps.front().cells.size(), 36u);
  for (const MapCell& c : d.rig_maps.front().cells)
    if (c.blocks >= 3) {
      EXPECT_NEAR(c.mean, bench.rim_N(c.x), 0.015) << c.x;
    }
  bench.rim_N = [](double th) { return 0.004 * std::cos(5.0 * th + 1.0); };
  const Diagnosis round = diagnose(bench);
  EXPECT_TRUE(round.rig_maps.empty());
  EXPECT_EQ(round.verdict, DiagnosisVerdict::none) << "no wheel is round to a thousandth of the span";
}

TEST(RigChannel, AZeroErrorOfTheAngleIsNoFinding) {
  Bench bench;
  bench.slip_rad = [](double) { return 0.02; };
  EXPECT_EQ(claims(diagnose(bench)), "");
}

TEST(RigChannel, AZeroThatWandersWithinItsRecordsIsTheReferencesWhereTheRigShowsTheSame) {
  Bench bench;
  bench.zero_N = [](double t) { return 0.1 * std::sin(t / 9.0) + 0.15 * std::sin(t / 23.0 + 1.0); };
  const Diagnosis d = diagnose(bench);
  EXPECT_EQ(claims(d), "reference_drift ");
  ASSERT_FALSE(d.findings.empty());
  EXPECT_TRUE(d.findings.front().side_witnessed);
}

// Where the zero has fallen so far, a rest reads less than nothing: no force of the spring is in it.
TEST(RigChannel, RestsBelowZeroDoNotHideTheDriftThatTheSpringShows) {
  Bench bench;
  bench.rests = 2;
  bench.zero_N = [](double t) { return 0.05 * std::cos(t / 2500.0) - 0.06 * std::log1p(t / 2000.0) - 0.1; };
  const Diagnosis d = diagnose(bench);
  EXPECT_EQ(claims(d), "reference_drift ");
  ASSERT_FALSE(d.findings.empty());
  EXPECT_TRUE(d.findings.front().side_witnessed);
}

TEST(RigChannel, ADriveThatIsLateIsListedWithItsLatenessAndNotClaimed) {
  const Diagnosis d = diagnose({.drive_late_s = 0.01}), hardly = diagnose({.drive_late_s = 1e-4});
  EXPECT_TRUE(hardly.findings.empty()) << "no reference shows it";
  EXPECT_EQ(d.verdict, DiagnosisVerdict::none);
  const auto motor = std::ranges::find(d.findings, "motor", &Finding::effect);
  ASSERT_TRUE(motor != d.findings.end() && motor->parameters.size() == 1u);
  EXPECT_NEAR(motor->parameters.front().value, 0.010, 0.001);
  EXPECT_LT(motor->error_after, 0.5 * motor->error_before);
}

// Before the wheel it is a play of the angle, widest where the spring moves fastest; a play of the force leaves a bent spring beside it.
TEST(RigChannel, AGearsPlayBetweenMotorAndWheelGoesWithTheAngle) {
  Bench bench;
  bench.gear_rad = 0.03;
  const Diagnosis d = diagnose(bench);
  EXPECT_EQ(claims(d), "backlash ");
  ASSERT_FALSE(d.findings.empty());
  EXPECT_EQ(d.findings.front().form, "of_angle");
  const auto half = std::ranges::find(d.findings.front().parameters, "half_rad", &FoundParameter::name);
  ASSERT_NE(half, d.findings.front().parameters.end());
  EXPECT_NEAR(half->value, 0.03, 0.003);
}

// One play, some records of each manner of moving: their angle is what the play acts on.
TEST(RigChannel, AGearsPlayOfOneWidthIsFoundInThreeRecords) {
  Bench bench;
  Campaign c = turning(bench);
  c.records.resize(4);
  c.records.erase(c.records.begin());
  for (Record& r : c.records) {
    auto& F = r.trace.find("F_ref")->value;
    auto& U = r.trace.find("U")->value;
    double held = F[0];
    for (std::size_t i = 0; i < F.size(); ++i) {
      const double free = F[i];
      held = std::clamp(held, free - 0.1, free + 0.1);
      F[i] = held;
      U[i] += 2.0 * (held - free);
    }
  }
  EngineOptions options;
  options.pictures = false;
  const auto d = diagnose_campaign(std::move(c), options);
  ASSERT_TRUE(d.has_value());
  EXPECT_EQ(claims(*d), "backlash ");
}

}  // namespace
}  // namespace forcegate::diagnose
