#pragma once
// A campaign of the film's law exactly, with a creep in front of it that a law without it takes for decay.

#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "hil/base/rng.h"
#include "hil/trace/campaign.h"

namespace forcegate::diagnose {

inline constexpr double kRate_Hz = 50.0;

inline double triangle(double t, double period_s, double low, double high) {
  const double x = std::fmod(t / period_s, 1.0);
  return low + (high - low) * (1.0 - std::abs(2.0 * x - 1.0));
}

inline double swing(double t, double f_Hz) {
  const double in = std::min(t / 3.0, 1.0);
  return 0.3 + 1.7 * in + in * std::sin(2.0 * std::numbers::pi * f_Hz * t);
}

/// b_scale = q_scale = 1; creep of 1, 10 and 100 s that begins at no load. Of two swings one is fitted.
inline Campaign creeping(std::uint64_t seed) {
  struct Course {
    const char *name, *kind;
    double duration_s, f_Hz;
    bool heldout;
  };
  constexpr std::array<Course, 8> kCourses = {{{"slow", "ramp", 120, 0, false},
                                               {"fast", "ramp", 80, 0, false},
                                               {"stair", "staircase", 135, 0, false},
                                               {"hold", "hold", 300, 0, false},
                                               {"slow_swing", "sine", 200, 0.5, true},
                                               {"swing", "sine", 120, 2.0, false},
                                               {"minor", "ramp", 60, 0, true},
                                               {"again", "ramp", 120, 0, true}}};
  Campaign c;
  c.name = "creeping";
  c.bench.reference_resolution_N = 0.005;
  c.bench.voltage_min_V = 0.0;
  c.bench.voltage_max_V = 10.0;
  Rng rng(seed, "creeping");
  double start_s = 0.0;
  for (const Course& course : kCourses) {
    Record r;
    r.name = course.name;
    r.kind = course.kind;
    r.start_s = start_s;
    r.dynamic = course.f_Hz > 0.0;
    r.role = course.heldout ? RecordRole::heldout : RecordRole::fit;
    if (*r.dynamic) {
      r.f_min_Hz = course.f_Hz;
      r.A_N = 1.0;
      r.m_N = 2.0;
      r.excitation_start_s = 0.0;
    }
    const double gain = 1.0 + 0.01 * rng.normal(), zero_V = 0.005 * rng.normal(), b = 0.0019 * course.f_Hz + 0.0056, q = 1.0 / 2.377;
    TimeBase clock;
    std::vector<double> F, U;
    std::array<double, 3> slow{};
    for (int i = 0; i < static_cast<int>(course.duration_s * kRate_Hz); ++i) {
      const double t = i / kRate_Hz;
      const std::string name = course.name;
      const double f = *r.dynamic         ? swing(t, course.f_Hz)
                       : name == "fast"   ? triangle(t, 8.0, 0.3, 4.0)
                       : name == "minor"  ? triangle(t, 20.0, 1.0, 2.5)
                       : name == "stair"  ? std::min(4.0, 0.3 + std::floor(std::min(t, 135.0 - t) / 15.0))
                       : name == "hold"   ? (t < 5.0 ? 0.3 : t < 120.0 ? 2.5 : t < 200.0 ? 1.0 : t < 260.0 ? 3.5 : 0.5)
                                          : triangle(t, 40.0, 0.3, 4.0);
      double x = f;
      for (std::size_t k = 0; k < slow.size(); ++k) {
        slow[k] += (f - slow[k]) * -std::expm1(-1.0 / (kRate_Hz * std::pow(10.0, static_cast<double>(k))));
        x += 0.04 * slow[k];
      }
      if (*r.dynamic) x = 1.0 + (std::exp(-b * t) + q) / (1.0 + q) * (x - 1.0);
      clock.t_s.push_back(t);
      F.push_back(f + 0.004 * rng.normal());
      U.push_back(gain * (x - 0.05) / 0.5 + zero_V + 0.002 * rng.normal());
    }
    start_s += course.duration_s + 900.0;
    r.trace.time_bases.push_back(clock);
    r.trace.channels.push_back({"F_ref", "N", "force", 0, F, {}});
    r.trace.channels.push_back({"U", "V", "voltage", 0, U, {}});
    c.records.push_back(std::move(r));
  }
  return c;
}

}  // namespace forcegate::diagnose
