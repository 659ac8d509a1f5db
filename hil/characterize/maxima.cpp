#include "hil/characterize/maxima.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "hil/gate/statistics.h"

namespace forcegate::characterize {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kNeighbour_s = 30.0;

double mean_of(const std::vector<double>& v, std::size_t from, std::size_t to) {
  double sum = 0.0;
  for (std::size_t i = from; i < to; ++i) sum += v[i];
  return to > from ? sum / static_cast<double>(to - from) : kNan;
}

double wander_of(const Turns& m) {
  double sum = 0.0;
  std::size_t n = 0, before = 0, after = 0;
  for (std::size_t i = 0; i < m.size(); ++i) {
    while (before < m.size() && m.t_s[before] < m.t_s[i] - kNeighbour_s) ++before;
    while (after < m.size() && m.t_s[after] < m.t_s[i] + kNeighbour_s) ++after;
    if (before == 0 || after >= m.size()) continue;
    const double d = m.sensor_V[i] - 0.5 * (m.sensor_V[before] + m.sensor_V[after]);
    sum += d * d;
    ++n;
  }
  return n > 2 ? std::sqrt(sum / static_cast<double>(n)) : kNan;
}

}  // namespace

double Extrema::mean_minimum_V() const { return mean_of(minima.sensor_V, 0, minima.size()); }

double Extrema::swing_V(double minimum_V, double from_s, double to_s) const {
  double sum = 0.0;
  int n = 0;
  for (std::size_t i = 0; i < maxima.size(); ++i)
    if (maxima.t_s[i] >= from_s && maxima.t_s[i] < to_s) sum += maxima.sensor_V[i] - minimum_V, ++n;
  return n > 0 ? sum / n : kNan;
}

double Extrema::loss() const {
  if (maxima.size() < 2) return kNan;
  const double low = mean_minimum_V();
  return 1.0 - (maxima.sensor_V.back() - low) / (maxima.sensor_V.front() - low);
}

ExtremaSink::ExtremaSink(double prominence_N, double volts_per_code, bool closed_loop, int half_width)
    : pairer_({.prominence = prominence_N,
               .followers = closed_loop ? std::size_t{3} : std::size_t{2},
               .half_width = half_width}),
      volts_per_code_(volts_per_code),
      closed_loop_(closed_loop) {}

void ExtremaSink::operator()(const RigBlock& block, std::size_t n, std::span<const float> estimate_N) {
  volts_.resize(std::max(volts_.size(), n));
  for (std::size_t i = 0; i < n; ++i) volts_[i] = static_cast<float>(volts_per_code_ * block.adc[i]);
  const float* followers[3] = {volts_.data(), block.force_ref_N.data(), estimate_N.data()};
  pairer_.push({block.t_s.data(), n}, {block.setpoint_N.data(), n}, {followers, closed_loop_ ? 3u : 2u});
}

Extrema ExtremaSink::finish() {
  pairer_.finish();
  return extrema_of(pairer_.pairs(), closed_loop_);
}

Extrema extrema_of(const std::vector<PairedExtremum>& pairs, bool closed_loop) {
  Extrema out;
  for (const PairedExtremum& p : pairs) {
    Turns& turns = p.turn == Turn::maximum ? out.maxima : out.minima;
    turns.t_s.push_back(p.t_s);
    turns.setpoint_N.push_back(p.guide);
    turns.sensor_V.push_back(p.value[0]);
    turns.ati_N.push_back(p.value[1]);
    if (closed_loop) turns.estimate_N.push_back(p.value[2]);
  }
  return out;
}

DecayRecord describe_decay(const Extrema& e) {
  DecayRecord d;
  d.u_min_V = e.mean_minimum_V();
  d.loss = e.loss();
  d.A_N = 0.5 * (moments(e.maxima.ati_N).mean - moments(e.minima.ati_N).mean);
  const double swing_V = e.maxima.size() > 0 ? e.maxima.sensor_V.front() - d.u_min_V : kNan;
  const std::size_t tenth = e.minima.size() / 10;
  if (tenth > 0)
    d.minima_drift_pct = 100.0 / swing_V *
                         (mean_of(e.minima.sensor_V, e.minima.size() - tenth, e.minima.size()) -
                          mean_of(e.minima.sensor_V, 0, tenth));
  d.wander_pct = 100.0 * wander_of(e.maxima) / swing_V;
  if (const auto fit = fit_decay(e.maxima.t_s, e.maxima.sensor_V, d.u_min_V)) {
    d.fitted = true;
    d.fit = *fit;
  }
  return d;
}

Result<DecayRecord> measure_decay(Bench& bench, std::string set, const StimulusSpec& spec, double prominence,
                                  const BlockSink& also, Extrema* keep) {
  FORCEGATE_TRY(const auto stimulus, make_stimulus(spec));
  const StimulusFacts facts = stimulus->facts();
  ExtremaSink sink(std::max(0.05, prominence * facts.amplitude_N), bench.volts_per_code());
  FORCEGATE_TRY(const PlayedRecord played, bench.play(*stimulus, [&](const RigBlock& b, std::size_t n,
                                                                     std::span<const float> estimate_N) {
    sink(b, n, estimate_N);
    if (also) also(b, n, estimate_N);
  }));
  (void)played;
  Extrema extrema = sink.finish();
  DecayRecord d = describe_decay(extrema);
  d.set = std::move(set);
  d.f_Hz = facts.lowest_frequency_Hz;
  d.m_N = facts.mean_N;
  d.duration_s = stimulus->duration_s();
  if (keep != nullptr) *keep = std::move(extrema);
  return d;
}

}  // namespace forcegate::characterize
