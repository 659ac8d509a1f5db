#pragma once
// Air of the laboratory over a campaign: temperature and relative humidity as smooth functions of campaign
// time.

#include <array>

#include "hil/base/rng.h"

namespace forcegate::hidden {

/// T(t) = mean + slow swell + air-conditioning cycle + step heating, degree Celsius; RH(t) likewise in
/// percent.
class Climate {
 public:
  Climate() = default;
  /// `swing_C`: half of the temperature span aimed at over `span_s` seconds of campaign.
  Climate(Rng& rng, double swing_C, double swing_humidity_pct, double span_s);

  double temperature_C(double campaign_s) const;
  double humidity_pct(double campaign_s) const;
  double mean_temperature_C() const { return mean_C_; }
  double mean_humidity_pct() const { return mean_pct_; }

 private:
  struct Wave {
    double amplitude = 0.0, period_s = 1.0, phase_rad = 0.0;
  };
  double sum(const std::array<Wave, 3>& waves, double t_s) const;

  double mean_C_ = 22.0, mean_pct_ = 45.0;
  double heating_C_ = 0.0, heating_at_s_ = 0.0, heating_tau_s_ = 1.0;
  std::array<Wave, 3> temperature_{}, humidity_{};
};

}  // namespace forcegate::hidden
