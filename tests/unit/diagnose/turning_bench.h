#pragma once
// A wheel on a spring, its reference and a straight sensor, each of which the test may put at fault.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>

#include "hil/base/rng.h"
#include "hil/diagnose/engine.h"

namespace forcegate::diagnose {

struct Bench {
  double reference_lag_s = 0.0;
  double resolution_N = 0.005;
  std::array<double, 7> turns_Hz = {0.0, 0.4, 0.0, 1.5, 0.0, 3.0, 0.0};  // 0: slowly to and fro
  std::function<double(int)> eccentricity_mm = [](int) { return 6.0; };
  std::function<double(int)> preload_mm = [](int record) { return 1.0 + 0.3 * record; };
  std::function<double(double, double, double)> push = [](double, double, double) { return 0.0; };  // N, seen by the sensor
  std::function<double(double)> output_V = [](double U) { return U; };  // of the straight sensor's
  double lift_N = 0.0;                                                  // the wheel stands so far back
  std::function<double(double)> reads_N = [](double F) { return F; };    // the reference, of the force
  std::function<double(double)> zero_N = [](double) { return 0.0; };    // of the reference, in campaign time
  std::function<double(int)> seat_N = [](int) { return 0.0; };          // a force beside the declared preload, by record
  std::function<double(int, double)> bounce_N = [](int, double) { return 0.0; };  // of the wheel on the sensor, by record and time
  bool angle = true;                                                    // recorded
  std::function<double(double)> machine_N = [](double) { return 0.0; };  // added to a commanded force
  double friction_N = 0.0, elastic_N = 0.05;  // of the guide: it reaches its size within some newtons of movement, and stays over rests
  std::function<double(double)> rim_N = [](double) { return 0.0; };     // of a wheel that is not round, by its angle
  std::function<double(double)> slip_rad = [](double) { return 0.0; };  // of the angle against its command
  double gear_rad = 0.0;  // half the play between the motor, whose angle is recorded, and the wheel
  double drive_late_s = 0.0;  // behind its command
  int rests = 0;  // records after the others: the wheel stands a millimetre off the sensor
};

// A wheel that turns in some records and goes slowly to and fro in the others; the sensor is a straight line.
inline Campaign turning(const Bench& bench) {
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
    const double p = rests ? -1.0 : bench.preload_mm(n), e = bench.eccentricity_mm(n);
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
      double F = std::max(0.0, spring_N - bench.lift_N + bench.machine_N(asked_N) + bench.seat_N(n) + bench.bounce_N(n, t) + bench.rim_N(wheel));
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
      F_ref.push_back(std::round((bench.reads_N(late) + bench.zero_N(*r.start_s + t) + 0.003 * rng.normal()) /
                                 bench.resolution_N) *
                      bench.resolution_N);
      U.push_back(bench.output_V(2.0 * (F + bench.push(F, e, th)) + 0.2) + 0.003 * rng.normal());
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

inline Diagnosis diagnose(const Bench& bench, bool pictures = false) {
  EngineOptions options;
  options.pictures = pictures;
  auto out = diagnose_campaign(turning(bench), options);
  EXPECT_TRUE(out.has_value());
  return out ? *out : Diagnosis{};
}

inline std::string claims(const Diagnosis& d) {
  std::string out;
  for (const Finding& f : d.findings)
    if (f.probability >= 0.5) out += f.effect + " ";
  return out;
}

}  // namespace forcegate::diagnose
