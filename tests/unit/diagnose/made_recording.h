#pragma once

#include "tests/unit/diagnose/made_campaign.h"

namespace forcegate::diagnose {

/// One recording of some machine: plain columns, no notes.
inline Campaign recording(double rate_Hz, std::size_t n, const std::function<double(double)>& input,
                   const std::function<std::vector<double>(const std::vector<double>& t,
                                                           const std::vector<double>& x)>& machine,
                   double noise) {
  Campaign c;
  c.name = "machine";
  Record r;
  r.name = "machine";
  TimeBase clock;
  std::vector<double> x;
  for (std::size_t i = 0; i < n; ++i) {
    clock.t_s.push_back(static_cast<double>(i) / rate_Hz);
    x.push_back(input(clock.t_s.back()));
  }
  std::vector<double> y = machine(clock.t_s, x);
  Rng rng(41, "machine");
  for (double& v : y) v += noise * rng.normal();
  r.trace.time_bases.push_back(clock);
  r.trace.channels.push_back({"F_ref", "N", "force", 0, x, {}});
  r.trace.channels.push_back({"U", "V", "voltage", 0, y, {}});
  c.records.push_back(std::move(r));
  return c;
}

}  // namespace forcegate::diagnose
