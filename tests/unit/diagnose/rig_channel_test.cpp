#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>

#include "hil/base/rng.h"
#include "hil/diagnose/engine.h"

namespace forcegate::diagnose {
namespace {

struct Bench {
  double reference_lag_s = 0.0;
  double resolution_N = 0.005;
  std::array<double, 7> turns_Hz = {0.0, 0.4, 0.0, 1.5, 0.0, 3.0, 0.0};  // 0: slowly to and fro
  std::function<double(int)> eccentricity_mm = [](int) { return 6.0; };
  std::function<double(double, double, double)> push = [](double, double, double) { return 0.0; };  // N, seen by the sensor
  double lift_N = 0.0;                                                  // the wheel stands so far back
  std::function<double(double)> zero_N = [](double) { return 0.0; };    // of the reference, in campaign time
  std::function<double(int)> seat_N = [](int) { return 0.0; };          // a force beside the declared preload, by record
  std::function<double(int, double)> bounce_N = [](int, double) { return 0.0; };  // of the wheel on the sensor, by record and time
  bool angle = true;                                                    // recorded
  std::function<double(double)> machine_N = [](double) { return 0.0; };  // added to a commanded force
  double friction_N = 0.0, elastic_N = 0.05;  // of the guide: it reaches its size within some newtons of movement, and stays over rests
  std::function<double(double)> slip_rad = [](double) { return 0.0; };  // of the angle against its command
  double gear_rad = 0.0;  // half the play between the motor, whose angle is recorded, and the wheel
  double drive_late_s = 0.0;  // behind its command
  int rests = 0;  // records after the others: the wheel stands a millimetre off the sensor
};

// A wheel that turns in some records and goes slowly to and fro in the others; the sensor is a straight line.
Campaign turning(const Bench& bench) {
  constexpr double kRate_Hz = 250.0, k = 0.25;
  Campaign c;
  c.name = "wheel";
  c.bench.reference_resolution_N = bench.resolution_N;
  c.bench.spring_N_per_mm = k;
  Rng rng(11, "wheel");
  const auto& hertz = bench.turns_Hz;
  double dragged_N = k, drag = 0.0;  // share of the friction
  for (int n = 0; n < 7 + bench.rests; ++n) {
    Record r;
    const bool rests = n >= 7;
    const double turns_Hz = rests ? 0.0 : hertz[static_cast<std::size_t>(n)];
    r.name = "r" + std::to_string(n);
    r.kind = rests ? "rest" : turns_Hz > 0.0 ? "sine" : "ramp";
    r.dynamic = false;
    r.start_s = 1500.0 * n;
    const double p = rests ? -1.0 : 1.0 + 0.3 * n, e = bench.eccentricity_mm(n);
    r.eccentricity_mm = e;
    r.preload_mm = p;
    TimeBase clock;
    std::vector<double> F_ref, U, theta, command;
    double late = 0.0, wheel = 0.0;
    const auto turned = [&](double t) {
      if (rests) return 0.0;
      return turns_Hz > 0.0 ? 2.0 * std::numbers::pi * turns_Hz * t : 0.5 * std::numbers::pi * (1.0 - std::cos(2.0 * std::numbers::pi * t / 45.0));
    };
    for (int i = 0; i < 22500; ++i) {
      const double t = i / kRate_Hz;
      const double wanted = turned(t);
      const double asked_N = k * (p + e * (1.0 - std::cos(wanted)));
      const double th = wanted + bench.slip_rad(wanted);
      wheel = std::clamp(wheel, th - bench.gear_rad, th + bench.gear_rad);
      const double spring_N = k * (p + e * (1.0 - std::cos(wheel)));
      double F = std::max(0.0, spring_N - bench.lift_N + bench.machine_N(asked_N) + bench.seat_N(n) + bench.bounce_N(n, t));
      drag = std::clamp(drag + (spring_N - dragged_N) / bench.elastic_N, -1.0, 1.0);
      dragged_N = spring_N;
      F += bench.friction_N * drag;
      late = i == 0 ? F
                    : late + (bench.reference_lag_s > 0.0
                                  ? -std::expm1(-1.0 / (kRate_Hz * bench.reference_lag_s))
                                  : 1.0) *
                                 (F - late);
      clock.t_s.push_back(t);
      theta.push_back(std::remainder(th, 2.0 * std::numbers::pi));
      command.push_back(k * (p + e * (1.0 - std::cos(turned(t + bench.drive_late_s)))));
      F_ref.push_back(std::round((late + bench.zero_N(*r.start_s + t) + 0.003 * rng.normal()) /
                                 bench.resolution_N) *
                      bench.resolution_N);
      U.push_back(2.0 * (F + bench.push(F, e, th)) + 0.2 + 0.003 * rng.normal());
    }
    r.trace.time_bases.push_back(clock);
    r.trace.channels.push_back({"F_ref", "N", "force", 0, F_ref, {}});
    r.trace.channels.push_back({"U", "V", "voltage", 0, U, {}});
    if (bench.angle) r.trace.channels.push_back({"theta", "rad", "angle", 0, theta, {}});
    r.trace.channels.push_back({"F_cmd", "N", "force", 0, command, {}});
    c.records.push_back(std::move(r));
  }
  return c;
}

Diagnosis diagnose(const Bench& bench, bool pictures = false) {
  EngineOptions options;
  options.pictures = pictures;
  auto out = diagnose_campaign(turning(bench), options);
  EXPECT_TRUE(out.has_value());
  return out ? *out : Diagnosis{};
}

std::string claims(const Diagnosis& d) {
  std::string out;
  for (const Finding& f : d.findings)
    if (f.probability >= 0.5) out += f.effect + " ";
  return out;
}

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

// At 4 Hz a reference that is 3 ms late looks like a third of the push, at 0.1 Hz like nothing of it.
TEST(RigChannel, ASidewaysPushIsOneBesideALateReference) {
  Bench bench;
  bench.reference_lag_s = 0.003;
  bench.turns_Hz = {0.0, 0.1, 0.0, 0.3, 0.0, 4.0, 0.0};
  bench.push = [](double F, double e, double th) { return 0.05 * F * e / 24.0 * std::sin(th); };
  const Diagnosis d = diagnose(bench);
  EXPECT_EQ(claims(d), "off_axis ");
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
