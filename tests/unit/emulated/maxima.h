#pragma once
// The paper's procedure on a record of the emulated rig: raw maxima and minima in volts and the fitted decay.

#include <vector>

#include "hil/trace/decay_fit.h"
#include "hil/trace/extrema.h"
#include "tests/unit/emulated/bench_run.h"

namespace forcegate::test {

inline double volts(std::uint16_t code) { return static_cast<double>(code) * 10.0 / 65535.0; }

struct Maxima {
  std::vector<double> t_s, maximum_V, minimum_at_s, minimum_V;
  double mean_minimum_V = 0.0;

  /// Swing of the n-th maximum over the mean minimum.
  double swing_V(std::size_t n) const { return maximum_V[n] - mean_minimum_V; }
  double loss() const { return 1.0 - swing_V(maximum_V.size() - 1) / swing_V(0); }
  /// Mean swing of the maxima in [from_s, to_s).
  double swing_V(double from_s, double to_s) const {
    double sum = 0.0;
    int n = 0;
    for (std::size_t i = 0; i < t_s.size(); ++i)
      if (t_s[i] >= from_s && t_s[i] < to_s) {
        sum += maximum_V[i] - mean_minimum_V;
        ++n;
      }
    return sum / n;
  }
};

/// Extrema of the voltage paired with those of the reference force. `prominence_N` of the reference.
inline Maxima find_maxima(const RigBlock& block, double prominence_N, int half_width = 5) {
  ExtremaPairer pairer({.prominence = prominence_N, .followers = 1, .half_width = half_width});
  for (std::size_t i = 0; i < block.size(); ++i) {
    const double u = volts(block.adc[i]);
    pairer.push(block.t_s[i], static_cast<double>(block.force_ref_N[i]), &u);
  }
  pairer.finish();
  Maxima m;
  for (const PairedExtremum& e : pairer.pairs()) {
    if (e.turn == Turn::maximum) {
      m.t_s.push_back(e.t_s);
      m.maximum_V.push_back(e.value[0]);
    } else {
      m.minimum_at_s.push_back(e.t_s);
      m.minimum_V.push_back(e.value[0]);
      m.mean_minimum_V += e.value[0];
    }
  }
  m.mean_minimum_V /= static_cast<double>(m.minimum_V.size());
  return m;
}

inline DecayParameters fit(const Maxima& m, double start_s = 0.0) {
  std::vector<double> t_s;
  for (const double t : m.t_s) t_s.push_back(t - start_s);
  return value_or_abort(fit_decay(t_s, m.maximum_V, m.mean_minimum_V));
}

inline double law_b_per_s(double f_Hz) { return 0.0019 * f_Hz + 0.0056; }
inline double law_ratio(double A_N) { return 1.0 / (1.0 + 1.377 * A_N * A_N); }

/// Profile made of given stretches of given profiles, for loads that no single stimulus has.
class Joined final : public Stimulus {
 public:
  void add(std::unique_ptr<Stimulus> part, double length_s) {
    start_s_.push_back(duration_);
    duration_ += length_s;
    const StimulusFacts f = part->facts();
    facts_.minimum_N = parts_.empty() ? f.minimum_N : std::min(facts_.minimum_N, f.minimum_N);
    facts_.maximum_N = std::max(facts_.maximum_N, f.maximum_N);
    parts_.push_back(std::move(part));
  }
  double force_N(double t_s) const override {
    std::size_t i = parts_.size() - 1;
    while (i > 0 && t_s < start_s_[i]) --i;
    return parts_[i]->force_N(t_s - start_s_[i]);
  }
  double duration_s() const override { return duration_; }
  StimulusFacts facts() const override { return facts_; }

 private:
  std::vector<std::unique_ptr<Stimulus>> parts_;
  std::vector<double> start_s_;
  double duration_ = 0.0;
  StimulusFacts facts_;
};

}  // namespace forcegate::test
