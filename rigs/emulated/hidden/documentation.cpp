#include "rigs/emulated/hidden/documentation.h"

#include <cmath>
#include <cstdio>

namespace forcegate::hidden {
namespace {

double to_step(double value, double step) { return std::round(value / step) / std::round(1.0 / step); }

}  // namespace

BenchNotes write_down(std::uint64_t seed, const std::string& name, const Conditions& c,
                      const std::vector<RecordData>& records) {
  Rng rng(seed, "documentation");
  const auto told = [&](double value) {
    return rng.uniform() < c.documented ? std::optional<double>(value) : std::nullopt;
  };
  BenchNotes notes;
  notes.sensor = "FlexiForce A201, one specimen";
  notes.spring_N_per_mm = told(0.25);
  notes.reference_resolution_N = told(c.reference_step_N);
  notes.reference_noise_N = rng.uniform() < 0.4 ? told(to_step(c.reference_noise_N, 0.0005)) : std::nullopt;
  if (told(0)) notes.adc_bits = c.adc_bits;
  notes.voltage_range = told(0).has_value();
  notes.force_range = told(0).has_value();
  notes.law = c.log_theta && told(0).has_value();

  // A lab leaves a key out in the whole file, seldom in one record.
  const bool rate = told(0).has_value(), duration = told(0).has_value(), start = rng.uniform() < 0.85,
             rest = told(0).has_value(), excitation = told(0).has_value(), facts = told(0).has_value(),
             dynamic = told(0).has_value(), kind = rng.uniform() < 0.93, geometry = rng.uniform() < 0.6,
             drive = c.vary_drive || rng.uniform() < 0.5, mounting = rng.uniform() < 0.5;
  for (std::size_t i = 0; i < records.size(); ++i) {
    const RecordPlan& p = records[i].plan;
    const RecordTruth& t = records[i].truth;
    RecordNotes r;
    char file[32];
    std::snprintf(file, sizeof file, "_r%02d.csv", static_cast<int>(i + 1));
    r.file = name + file;
    if (kind) r.kind = p.kind;
    if (c.roles_given) r.role = p.heldout ? "heldout" : "fit";
    if (rate) r.rate_Hz = p.rate_Hz;
    if (duration) r.duration_s = to_step(p.duration_s, 0.01);
    if (start) r.start_s = p.start_s;
    if (rest) r.rest_before_s = p.rest_before_s;
    if (excitation && p.kind != "rest") r.excitation_start_s = p.excitation_start_s;
    if (dynamic) r.dynamic = p.dynamic;
    if (facts && p.dynamic) {
      r.f_min_Hz = p.f_min_Hz;
      // a single sine is known from its settings, everything else is read off the reference
      const double low_N = p.kind == "sine" ? p.low_N : t.reached_low_N;
      const double high_N = p.kind == "sine" ? p.high_N : t.reached_high_N;
      r.A_N = to_step(0.5 * (high_N - low_N), 0.01);
      r.m_N = to_step(0.5 * (high_N + low_N), 0.01);
    }
    if (drive) r.drive_V = p.drive_V;
    if (geometry) {
      r.eccentricity_mm = to_step(t.eccentricity_mm, 0.01);
      r.preload_mm = to_step(t.preload_mm, 0.01);
    }
    if (mounting && c.remount) r.mounting = p.mounting;
    notes.records.push_back(std::move(r));
  }
  return notes;
}

}  // namespace forcegate::hidden
