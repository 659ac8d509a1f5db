#pragma once
// Maxima and minima of one record: sensor volts and ATI newtons, paired with the turning points of the set-point.

#include <vector>

#include "hil/base/result.h"
#include "hil/characterize/bench.h"
#include "hil/trace/decay_fit.h"
#include "hil/trace/extrema.h"

namespace forcegate::characterize {

struct Turns {
  std::vector<double> t_s, setpoint_N, ati_N, sensor_V, estimate_N;  ///< estimate_N empty in open loop
  std::size_t size() const { return t_s.size(); }
};

struct Extrema {
  Turns maxima, minima;

  /// U_min: mean of the minima, V.
  double mean_minimum_V() const;
  /// Mean swing of the maxima above `minimum_V` in [from_s, to_s), V; NaN without one.
  double swing_V(double minimum_V, double from_s, double to_s) const;
  /// Share of the first maximum's swing that the last one has lost, 1.
  double loss() const;
};

/// followers of the pairs: sensor volts, ATI newtons and, in closed loop, the estimate.
Extrema extrema_of(const std::vector<PairedExtremum>& pairs, bool closed_loop = false);

/// Sink that collects them. `prominence_N` of the set-point; a value is the extremum of a moving mean over
/// 2 half_width + 1 samples.
class ExtremaSink {
 public:
  ExtremaSink(double prominence_N, double volts_per_code, bool closed_loop = false, int half_width = 5);
  void operator()(const RigBlock& block, std::size_t n, std::span<const float> estimate_N);
  Extrema finish();

 private:
  ExtremaPairer pairer_;
  double volts_per_code_;
  bool closed_loop_;
  std::vector<float> volts_;
};

/// Decay of the maxima of one dynamic record and what the profile was.
struct DecayRecord {
  std::string set;                 ///< "identification series", "validation", "sweep up", "two sines" ...
  double f_Hz = 0.0, f2_Hz = 0.0;  ///< lowest frequency at the start; second one of a sum
  double A_N = 0.0, m_N = 0.0;     ///< measured amplitude of the settled force, set-point's mean
  double duration_s = 0.0;
  bool fitted = false;
  DecayParameters fit;            ///< eq. (3) by least squares
  double u_min_V = 0.0;           ///< mean of the minima
  double loss = 0.0;              ///< share of the swing lost from the first to the last maximum
  double minima_drift_pct = 0.0;  ///< last tenth of the minima against the first tenth, % of the first swing
  double wander_pct = 0.0;  ///< sd of a maximum about the mean of neighbours 30 s away, % of the first swing
};

/// Plays an open-loop record and fits eq. (3) to its maxima. A decay that cannot be fitted (FSR) is no error:
/// fitted = false. `prominence`: share of the amplitude A that a turning point must have.
Result<DecayRecord> measure_decay(Bench& bench, std::string set, const StimulusSpec& spec,
                                  double prominence = 0.5, const BlockSink& also = {},
                                  Extrema* keep = nullptr);

/// "minimum, first, last": relative wandering and drift for DecayRecord, from collected extrema.
DecayRecord describe_decay(const Extrema& extrema);

}  // namespace forcegate::characterize
