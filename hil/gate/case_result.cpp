#include "hil/gate/case_result.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "hil/base/text.h"
#include "hil/gate/statistics.h"
#include "hil/trace/decay_fit.h"

namespace forcegate {
namespace {

ExtremaSeries series(const CaseRecord& record, bool closed, bool maximum) {
  ExtremaSeries s;
  s.name = maximum ? "maxima" : "minima";
  for (const CasePair& p : record.pairs) {
    if (p.maximum != maximum) continue;
    s.t_s.push_back(static_cast<float>(p.t_s));
    s.expected_N.push_back(static_cast<float>(closed ? p.setpoint_N : p.ati_N));
    s.actual_N.push_back(static_cast<float>(closed ? p.ati_N : p.dut_N));
    s.raw_N.push_back(static_cast<float>(p.raw_N));
  }
  return s;
}

// A tenth of the turns on either side may be another: the swing begins slowly, and a reading of the reference may be wrong.
bool keeps_its_height(const std::vector<double>& turns_N, double swing_N) {
  constexpr double kOthers = 0.1, kTolerance = 0.1;  // of the turns; of the swing
  return sample_quantile(turns_N, 1.0 - kOthers) - sample_quantile(turns_N, kOthers) <= kTolerance * swing_N;
}

// Decay of the raw maxima in volts, as the paper fits it (eq. 3). Only where maxima and minima of the ATI stay where they
// are: those of a sum of sines differ by more than the sensor loses.
DecayFit decay(const CaseRecord& record, const Calibration& calibration) {
  std::vector<double> t_s, maxima_V, minima_V, maxima_N, minima_N;
  const double start_s = record.facts.excitation_start_s;
  for (const CasePair& p : record.pairs) {
    if (p.t_s < start_s || !std::isfinite(p.raw_N)) continue;
    const double volts = (p.raw_N - calibration.offset_N) / calibration.gain_N_per_V;
    if (p.maximum) {
      t_s.push_back(p.t_s - start_s);
      maxima_V.push_back(volts);
      if (std::isfinite(p.ati_N)) maxima_N.push_back(p.ati_N);
    } else {
      minima_V.push_back(volts);
      if (std::isfinite(p.ati_N)) minima_N.push_back(p.ati_N);
    }
  }
  DecayFit d;
  if (minima_V.empty() || maxima_V.empty()) return d;
  const double swing_N = moments(maxima_N).mean - moments(minima_N).mean;
  if (!keeps_its_height(maxima_N, swing_N) || !keeps_its_height(minima_N, swing_N)) return d;
  const double u_min_V = moments(minima_V).mean;
  const auto fit = fit_decay(t_s, maxima_V, u_min_V);
  if (!fit) return d;
  return to_decay_fit(*fit, u_min_V, t_s.back());
}

}  // namespace

DecayFit to_decay_fit(const DecayParameters& fit, double u_min_V, double until_s) {
  const double start_V = fit.a_V + fit.c_V;
  const double loss = 1.0 - (fit.a_V * std::exp(-fit.b_per_s * until_s) + fit.c_V) / start_V;
  return {.valid = true,
          .a_V = fit.a_V,
          .b_per_s = fit.b_per_s,
          .c_V = fit.c_V,
          .u_min_V = u_min_V,
          .u_a_V = fit.u_a_V,
          .u_b_per_s = fit.u_b_per_s,
          .u_c_V = fit.u_c_V,
          .rmse_V = fit.rmse_V,
          .loss_pct = 100.0 * loss,
          .n = static_cast<std::uint64_t>(fit.n)};
}

std::string stimulus_in_words(const StimulusSpec& spec) {
  std::string out = spec.name;
  for (const auto& [name, value] : spec.numbers) out += fmt::format(" {}={}", name, shortest(value));
  for (const auto& [name, values] : spec.lists) {
    out += fmt::format(" {}=", name);
    for (std::size_t i = 0; i < values.size(); ++i) out += (i ? "," : "") + shortest(values[i]);
  }
  for (const auto& [name, text] : spec.texts) out += fmt::format(" {}={}", name, text);
  return out;
}

CaseResult to_case_result(const PlanCase& planned, const CaseJob& job, CaseRecord record,
                          const JudgedCase& judged, bool with_curves) {
  const bool closed = planned.loop == LoopMode::closed;
  CaseResult c;
  c.id = job.id;
  c.title = planned.title;
  c.lane = job.lane;
  c.loop = to_string(planned.loop);
  c.stimulus = stimulus_in_words(planned.stimulus);
  c.facts = record.facts;
  c.parameter_source = planned.source;
  c.duration_s = record.duration_s;
  c.samples = record.samples;
  c.specimen = job.specimen;
  c.seed = job.seed;
  c.calibration = job.calibration;
  bool passed = true;
  for (const JudgedCheck& j : judged.checks) {
    c.checks.push_back(j.check);
    passed = passed && (!j.check.required || j.check.verdict == Verdict::pass);
  }
  c.link = record.link;
  c.digest = record.digest;
  c.trace_file = record.trace_file;
  c.lag_s = record.lag_s;
  c.u_lag_s = record.u_lag_s;
  if (record.failure) c.note = record.failure->error.to_text();
  if (!closed && record.facts.dynamic && record.rig.emulated) c.decay = decay(record, job.calibration);
  if (passed && !with_curves) return c;
  c.extrema.push_back(series(record, closed, true));
  c.extrema.push_back(series(record, closed, false));
  c.overview = std::move(record.overview);
  c.window = std::move(record.window);
  c.window_reason = std::move(record.window_reason);
  return c;
}

}  // namespace forcegate
