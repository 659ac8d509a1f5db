#pragma once
// A small campaign with simple forces, made without any part of the model.

#include <cmath>
#include <functional>
#include <string>

#include "hil/model/record_input.h"
#include "hil/model/rows.h"

namespace forcegate::test {

inline Record record(const std::string& name, const std::string& kind, double duration_s, double start_s,
                     const std::function<double(double)>& force,
                     const std::function<double(double, double)>& output) {
  Record r;
  r.name = name;
  r.kind = kind;
  r.start_s = start_s;
  TimeBase clock;
  clock.nominal_rate_Hz = 200.0;
  Channel F{"F_ref", "N", "force", 0, {}, {}}, U{"U", "V", "voltage", 0, {}, {}},
      T{"temp", "degC", "temperature", 0, {}, {}}, th{"theta", "rad", "angle", 0, {}, {}};
  const auto n = static_cast<std::size_t>(duration_s * 200.0);
  for (std::size_t i = 0; i < n; ++i) {
    const double t = static_cast<double>(i) / 200.0, f = force(t);
    clock.t_s.push_back(t);
    F.value.push_back(f);
    U.value.push_back(output(t, f));
    T.value.push_back(23.0 + 2.0 * std::sin((start_s + t) / 700.0));
    th.value.push_back(std::fmod(t, 6.28));
  }
  r.trace.time_bases.push_back(clock);
  r.trace.channels = {F, U, T, th};
  return r;
}

inline Campaign campaign(const std::function<double(double, double)>& output) {
  Campaign c;
  c.name = "synthetic";
  const auto triangle = [](double t, double period) {
    const double x = std::fmod(t / period, 1.0);
    return x < 0.5 ? 2.0 * x : 2.0 - 2.0 * x;
  };
  c.records.push_back(record(
      "ramp", "ramp", 120, 0, [&](double t) { return 0.2 + 4.0 * triangle(t, 60); }, output));
  c.records.push_back(record(
      "fast", "ramp", 60, 500, [&](double t) { return 0.2 + 4.0 * triangle(t, 4); }, output));
  c.records.push_back(record(
      "hold", "hold", 200, 1000, [](double t) { return t < 10    ? 0.2
                                                       : t < 110 ? 3.5
                                                                 : 1.0; }, output));
  c.records.push_back(record(
      "stairs", "staircase", 120, 1500,
      [](double t) { return 0.4 + std::min(std::floor(t / 12), std::floor((120 - t) / 12)) * 0.7; }, output));
  return c;
}

}  // namespace forcegate::test
