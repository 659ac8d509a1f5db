#pragma once
// A piezoresistive film in its measuring circuit: force in, volts out. FlexiForce A201 and FSR are the same
// chain with other numbers (see population.h):
//   play hysteresis -> curvature -> loading memory -> creep -> F = G U + F0 (eq. 1) -> lag.

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "hil/base/portable_math.h"
#include "hil/base/rng.h"
#include "rigs/emulated/loading_memory.h"

namespace forcegate::emulated {

struct FilmParameters {
  // Static law (1), one draw per session
  double gain_N_per_V = 0.5;
  double offset_N = 0.15;
  // Imperfections of the static law (Table I of the paper is missing in our copy: ours)
  double curvature = 0.006;  ///< largest departure from the line over the range, share of full_scale_N
  double full_scale_N = 5.0;
  double play_half_width_N = 0.25;  ///< rate-independent hysteresis: one play operator ...
  double play_share = 0.05;         ///< ... that carries this share of the force
  double creep_share = 0.025;       ///< growth of the output under a load at rest
  double creep_s = 250.0;
  // First-order lag
  double lag_s = 0.003;
  // Wandering of the swing (FSR, Fig. 7): relative standard deviation and correlation time
  double wander = 0.0;
  double wander_s = 20.0;
  LoadingParameters loading;
};

class Film {
 public:
  /// The film has carried `force_N` for a moment; `lost` and `rest_before_s` as in LoadingMemory::begin.
  void begin(const FilmParameters& p, double step_s, double force_N, double lost, double rest_before_s,
             std::uint64_t seed) {
    p_ = p;
    play_ = force_N;
    creep_ = wander_ = 0.0;
    rng_ = Rng(seed, "film_wander");
    follow_ = 1.0 - portable::exp(-step_s / p.lag_s);
    per_gain_ = 1.0 / p.gain_N_per_V;
    bend_ = 4.0 * p.curvature / p.full_scale_N;
    film_N_ = static_force_N(force_N);
    memory_.begin(p.loading, step_s, film_N_, lost, rest_before_s);
    voltage_ = target_V(film_N_);
  }

  /// Samples in order: volts before the converter's rails and noise. tick() is called between two runs.
  void run(std::size_t n, const double* force_N, double* voltage_V) {
    double film[kBatch], voltage = voltage_;
    const double creep_N = creep_, wander = wander_, offset_N = p_.offset_N, per_gain = per_gain_,
                 follow = follow_;
    for (std::size_t done = 0; done < n; done += kBatch) {
      const std::size_t m = n - done < kBatch ? n - done : kBatch;
      double* const out_V = voltage_V + done;
      for (std::size_t i = 0; i < m; ++i) film[i] = static_force_N(force_N[done + i]);
      memory_.run(m, film, [&](std::size_t i, double kept_N, double low_N) {
        const double wander_N = wander * (film[i] - low_N);
        voltage += follow * ((kept_N + creep_N + wander_N - offset_N) * per_gain - voltage);
        out_V[i] = voltage;
      });
      film_N_ = film[m - 1];
    }
    voltage_ = voltage;
  }

  /// Every 10 ms.
  void tick(double dt_s) {
    memory_.tick(dt_s, film_N_);
    // Cycling shakes creep out: with it the minima would not stay where the paper sees them.
    const double driving_N = film_N_ * (1.0 - memory_.expression());
    creep_ += dt_s / p_.creep_s * (p_.creep_share * driving_N - creep_);
    if (p_.wander > 0.0) {
      const double decay = dt_s / p_.wander_s;
      wander_ += -decay * wander_ + p_.wander * __builtin_sqrt(2.0 * decay) * rng_.normal();
    }
  }

  const LoadingMemory& memory() const { return memory_; }

 private:
  static constexpr std::size_t kBatch = 16;

  /// Force that the contacts carry: hysteresis and curvature. The loading memory works on this one, for what
  /// is lost loses its hysteresis too.
  double static_force_N(double force_N) {
    const double r = p_.play_half_width_N;
    play_ = play_ < force_N - r ? force_N - r : (play_ > force_N + r ? force_N + r : play_);
    return force_N + p_.play_share * (play_ - force_N) + bend_ * force_N * (p_.full_scale_N - force_N);
  }

  double target_V(double film_N) const {
    const double wander_N = wander_ * (film_N - memory_.envelope_low_N());
    return (memory_.apply(film_N) + creep_ + wander_N - p_.offset_N) * per_gain_;
  }

  FilmParameters p_;
  LoadingMemory memory_;
  double film_N_ = 0, play_ = 0, creep_ = 0, wander_ = 0, follow_ = 1, per_gain_ = 2, bend_ = 0, voltage_ = 0;
  Rng rng_{0};
};

}  // namespace forcegate::emulated
