#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "hil/base/rng.h"
#include "hil/diagnose/engine.h"
#include "hil/diagnose/raw/raw_health.h"

namespace forcegate::diagnose {

// Forces of eight records; the output is made by the caller, noise and steps are those of ordinary instruments.
using Sensor = std::function<std::vector<double>(const std::vector<double>& t, const std::vector<double>& F,
                                                 int record)>;

inline Campaign make_campaign(std::uint64_t seed, const Sensor& sensor, double noise_V = 0.004) {
  Campaign c;
  c.name = "made";
  c.bench.reference_resolution_N = 0.025;
  c.bench.voltage_min_V = 0.0;
  c.bench.voltage_max_V = 10.0;
  Rng rng(seed, "campaign");
  const auto triangle = [](double t, double period) {
    const double x = std::fmod(t / period, 1.0);
    return x < 0.5 ? 2.0 * x : 2.0 - 2.0 * x;
  };
  for (int k = 0; k < 8; ++k) {
    Record r;
    r.name = "r" + std::to_string(k);
    r.kind = k % 4 == 1 ? "staircase" : k % 4 == 2 ? "hold" : "ramp";
    r.start_s = 900.0 * k;
    r.dynamic = false;
    r.role = k == 3 || k == 6 ? RecordRole::heldout : RecordRole::fit;
    TimeBase clock;
    std::vector<double> F;
    for (int i = 0; i < 24000; ++i) {
      const double t = i / 200.0;
      clock.t_s.push_back(t);
      double f = 0.0;
      if (k % 4 == 0) f = 0.2 + 4.2 * triangle(t, 60.0);
      if (k % 4 == 1) f = 0.5 + 0.7 * std::min(std::floor(t / 12.0), std::floor((120.0 - t) / 12.0));
      if (k % 4 == 2) f = t < 10.0 ? 0.3 : t < 70.0 ? 3.6 : 1.2;
      if (k % 4 == 3) f = 0.4 + 3.6 * triangle(t, 5.0);
      F.push_back(f);
    }
    const double gain = 1.0 + 0.005 * rng.normal(), offset = 0.01 * rng.normal();
    std::vector<double> U = sensor(clock.t_s, F, k);
    for (double& u : U)
      u = std::clamp(std::round((u * gain + offset + noise_V * rng.normal()) / 10.0 * 4096.0) / 4096.0 * 10.0,
                     0.0, 10.0);
    for (double& f : F) f = std::round((f + 0.006 * rng.normal()) / 0.025) * 0.025;
    r.trace.time_bases.push_back(clock);
    r.trace.channels.push_back({"F_ref", "N", "force", 0, F, {}});
    r.trace.channels.push_back({"U", "V", "voltage", 0, U, {}});
    c.records.push_back(std::move(r));
  }
  return c;
}

inline std::vector<double> straight(const std::vector<double>&, const std::vector<double>& F, int) {
  std::vector<double> U;
  for (double f : F) U.push_back(2.0 * f + 0.2);
  return U;
}

inline Diagnosis answer(Campaign campaign, unsigned threads = 1) {
  EngineOptions options;
  options.threads = threads;
  auto out = diagnose_campaign(std::move(campaign), options);
  EXPECT_TRUE(out.has_value()) << (out ? "" : out.error().to_text());
  return out ? *out : Diagnosis{};
}

/// 0 for what is no finding.
inline double probability(const Diagnosis& d, const std::string& effect) {
  const auto at = std::find_if(d.findings.begin(), d.findings.end(), [&](const Finding& f) { return f.effect == effect; });
  return at == d.findings.end() ? 0.0 : at->probability;
}

/// What a diagnosis says, for the message of a test that fails.
inline std::string told(const Diagnosis& d) {
  std::string out;
  for (const Finding& f : d.findings) out += f.effect + " " + std::to_string(f.probability) + ": " + f.evidence + "\n";
  for (const RefusedEffect& r : d.refused) out += "refused " + r.effect + ": " + std::string(traits_of(r.reason).sentence) + "\n";
  for (const std::string& note : d.notes) out += "\n" + note;
  return out;
}

/// What the raw samples of all records say.
inline std::vector<HealthClaim> claims_of_samples(const Campaign& c) {
  std::vector<RecordHealth> health;
  for (const Record& r : c.records) health.push_back(check_raw_health(r, health_scales(c), c.bench));
  return health_claims(health, health_scales(c), c.bench);
}

}  // namespace forcegate::diagnose
