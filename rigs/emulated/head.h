#pragma once
// A patient's head instead of the fixed table (Lebosse 2011, V-B): its surface moves against the coil. Displacements in
// mm, positive towards the robot, so that F = k (travel - rest + displacement).
//   breathing   1.0 mm at 0.25 Hz, and a slow sway of 1.0 mm in 90 s
//   sudden      about every 60 s the head moves by 1.5 to 3 mm, either way, within 0.3 s, and stays there for 10 to 30 s
//   away        about every 5 min it leaves the coil: 12 mm back within 0.5 s for 4 s, then it returns within 1.5 s
// The magnitudes are ours: the paper gives none. At 1.5 N the wheel has 6 mm left to retreat, which they do not use up. Everything follows from the record's seed.

#include <cstdint>
#include <vector>

#include "hil/base/portable_math.h"
#include "hil/base/rng.h"

namespace forcegate::emulated {

class HeadMotion {
 public:
  /// scale 0: no motion.
  void begin(std::uint64_t seed, double duration_s, double scale) {
    scale_ = scale;
    moves_.clear();
    at_ = 0;
    settled_mm_ = 0.0;
    if (scale <= 0.0) return;
    Rng rng(seed, "head");
    breathing_phase_ = rng.uniform(0.0, kTwoPi);
    double t = 30.0, next_away = 150.0 + rng.uniform(0.0, 100.0);
    while (t < duration_s - 20.0) {
      if (t > next_away) {
        moves_.push_back({t, 0.5, -12.0});
        moves_.push_back({t + 4.5, 1.5, 12.0});
        next_away = t + 240.0 + rng.uniform(0.0, 120.0);
        t += 30.0;
        continue;
      }
      const double jump_mm = (rng.uniform() < 0.5 ? -1.0 : 1.0) * rng.uniform(1.5, 3.0),
                   stay_s = rng.uniform(10.0, 30.0);
      moves_.push_back({t, 0.3, jump_mm});
      moves_.push_back({t + stay_s, 0.8, -jump_mm});
      t += stay_s + rng.uniform(20.0, 60.0);
    }
  }

  /// Times in order.
  double displacement_mm(double t_s) {
    if (scale_ <= 0.0) return 0.0;
    while (at_ < moves_.size() && t_s >= moves_[at_].at_s + moves_[at_].takes_s)
      settled_mm_ += moves_[at_++].by_mm;
    double mm = settled_mm_;
    if (at_ < moves_.size() && t_s > moves_[at_].at_s)
      mm += moves_[at_].by_mm *
            (0.5 - 0.5 * portable::cos(0.5 * kTwoPi * (t_s - moves_[at_].at_s) / moves_[at_].takes_s));
    mm += 1.0 * portable::sin(kTwoPi * 0.25 * t_s + breathing_phase_) +
          1.0 * portable::sin(kTwoPi * t_s / 90.0);
    return scale_ * mm;
  }

 private:
  static constexpr double kTwoPi = 6.28318530717958647693;
  struct Move {
    double at_s, takes_s, by_mm;
  };
  double scale_ = 0.0, breathing_phase_ = 0.0, settled_mm_ = 0.0;
  std::size_t at_ = 0;
  std::vector<Move> moves_;
};

}  // namespace forcegate::emulated
