#pragma once
// What cyclic loading does to a piezoresistive film, as a state that only the force drives. Nobody tells it
// frequency, amplitude or mean of a profile, nor the time since its start.
//
// Mechanism (ours, after the observations of Lebosse 2011, III-C to IV-A3; the paper has no physical model):
//  - Turning points of the force set the envelope [lo, hi]. The contacts that carry the lower envelope stay
//    closed; those closed and opened by every cycle are lost bit by bit. So the output of the force above
//    `lo` shrinks and the minima are held.
//  - Activity `act` in [0, 1]: full while half-cycles are shorter than some 10 s, none for quasi-static
//  loading.
//  - Conditioning: during the first cycles (>= 15 s of activity and 3 traverses of the full swing) the
//  network
//    takes an imprint of amplitude A0 and of the rhythm f0 of full-swing traverses, which is that of the
//    lowest component. Afterwards both stay frozen until 5 min of quiet.
//  - Lost share y of three groups of contacts: y' = act b (y_inf - y) - (1 - act) release y / tau_i, with
//    b = b_scale (0.0019 f0 + 0.0056) and y_inf = 1 / (1 + q), q = q_scale / (1 + 1.377 A0^2) (eq. 5 in ratio
//    form, r = 1 - y). The three recovery times make a stretched recovery that is over in about 2 h.
//  - Release is full at or below `lo` and none at `hi`: a film that stays pressed does not recover.
//  - Expression E: the loss shows while the network is being worked; it vanishes within a minute of released
//    rest, when only a static residue of the gain is left, proportional to y (III-D: +7 %).
//  - Disturbance B: a sudden change of rhythm closes part of the lost contacts again for some 20 s (Fig. 8).
// Rate laws are integrated once per tick (10 ms): the fastest of them has a time constant of 1 s.

#include <cstddef>
#include <cstdint>

namespace forcegate::emulated {

struct LoadingParameters {
  // Eq. (5)
  double rate_offset_per_s = 0.0056;
  double rate_slope_per_s_Hz = 0.0019;
  double ratio_curvature_per_N2 = 1.377;
  double b_scale = 1.0;
  double q_scale = 1.0;
  /// Lost share at infinity when it is not a matter of eq. (5) (FSR); < 0 = use eq. (5). May be given
  /// as a gain instead of a loss by `sign` = -1.
  double fixed_loss = -1.0;
  double sign = 1.0;
  // The rest is ours.
  double residue = 0.12;  ///< relative drop of the static output per unit of y: +7 % of gain when
                          ///< calibrated some minutes after 20 min of cycling
  double bump = 0.4;      ///< largest share of the loss undone by a change of rhythm
  double bump_fade_s = 20.0;
  double slow_half_cycle_s = 20.0;  ///< half-cycles longer than this are quasi-static
  double envelope_s = 300.0;        ///< memory of the envelope while cycling
  double recovery_s[3] = {90.0, 700.0, 2200.0};
  double share[3] = {0.3, 0.4, 0.3};
  double show_s = 3.0, hide_s = 25.0;  ///< expression
};

class LoadingMemory {
 public:
  /// `lost` is the share y left by cycling that ended `rest_before_s` ago.
  void begin(const LoadingParameters& p, double step_s, double force_N, double lost, double rest_before_s);

  /// Samples in order. put(i, output, lo): output force of the film before the static law,
  ///   F - loss (F - lo) - residue F,  and the lower envelope.
  template <class Put>
  void run(std::size_t n, const double* force_N, Put put) {
    // Rising and falling are one search for the largest y = +-F; in locals, because what put() writes might be a member.
    double lo = lo_, hi = hi_, sign = rising_ ? 1.0 : -1.0, far = sign * extreme_;
    std::int64_t index = index_, far_at = extreme_at_;
    const double prominence = prominence_, loss = loss_, residue = residue_;
    for (std::size_t i = 0; i < n; ++i) {
      const double force = force_N[i], y = sign * force;
      ++index;
      lo = force < lo ? force : lo;
      hi = force > hi ? force : hi;
      if (y > far) {
        far = y;
        far_at = index;
      } else if (far - y > prominence) {
        lo_ = lo, hi_ = hi, extreme_ = sign * far, extreme_at_ = far_at, index_ = index;
        turn(force);
        lo = lo_, hi = hi_, sign = -sign, far = sign * extreme_, far_at = extreme_at_;
      }
      put(i, force - loss * (force - lo) - residue * force, lo);
    }
    lo_ = lo, hi_ = hi, extreme_ = sign * far, extreme_at_ = far_at, index_ = index;
  }

  /// Every `dt_s` (10 ms); `force_N` is the latest force.
  void tick(double dt_s, double force_N);

  /// The same for a force that does not move.
  double apply(double force_N) const { return force_N - loss_ * (force_N - lo_) - residue_ * force_N; }

  double lost_share() const { return lost_; }          ///< y
  double expression() const { return expression_; }    ///< E
  double envelope_low_N() const { return lo_; }

 private:
  void turn(double force_N);
  void full_swing_turn(double value_N, std::int64_t at);
  double seconds(std::int64_t samples) const { return static_cast<double>(samples) * step_s_; }

  LoadingParameters p_;
  double step_s_ = 0.001;
  std::int64_t index_ = 0;
  // turning points
  double lo_ = 0, hi_ = 0, extreme_ = 0, prominence_ = 0.05;
  std::int64_t extreme_at_ = 0, last_turn_at_ = 0;
  bool rising_ = true, turned_ = false;
  double half_cycle_s_ = 0;
  double rhythm_fast_ = 0, rhythm_slow_ = 0, habit_ = 0;  // mean log half-cycle, its usual variation
  // full-swing traverses
  double swing_extreme_ = 0;
  std::int64_t swing_extreme_at_ = 0, swing_turn_at_ = 0;
  bool swing_rising_ = true;
  int traverses_ = 0;
  double traverse_s_ = 0, counted_swing_ = 0;
  // slow states
  double group_[3] = {0, 0, 0};
  double lost_ = 0, expression_ = 0, disturbance_ = 0, activity_ = 0;
  double active_s_ = 0, quiet_s_ = 0, amplitude_ = 0, frequency_ = 0;
  bool conditioned_ = false;
  double loss_ = 0, residue_ = 0;
};

}  // namespace forcegate::emulated
