#pragma once
// The bench of Paredes-Madrid et al. 2010, section IV: eight sensors with pucks between them under the same weights, the
// circuit of Fig. 3a, two sources, and a converter that reads the output.
//
// Circuit (exact for one pole of the amplifier A(jf) = GBW/(jf)): V_o/V_s = -R_g Y / (1 + (1 + R_g Y)/A), clipped at the
// rails. Reading: white noise, flicker (one pole, so that low frequencies scatter), rounding to 12 bits.

#include <vector>

#include "hil/interface/weight_bench.h"
#include "rigs/emulated/rc_sensor.h"

namespace forcegate::emulated {

struct DeadWeightOptions {
  double feedback_ohm = 120e3;
  double gain_bandwidth_Hz = 8e6;
  double rail_V = 10.0;
  double rate_Hz = 320e3;
  bool noise = true;
  bool spread = true;  ///< false: every sensor nominal, every loading the same
};

class DeadWeightBench final : public WeightBench {
 public:
  explicit DeadWeightBench(const DeadWeightOptions& options) : options_(options) {}
  WeightBenchInfo info() const override;
  Result<void> begin(const WeightBenchRequest& request) override;
  Result<void> load(double force_N, double hold_s) override;
  Result<void> capture(std::size_t sensor, const WeightBenchSource& source,
                       std::span<std::int16_t> codes) override;
  std::optional<std::complex<double>> true_admittance_S(std::size_t sensor, double f_Hz) const override;

  const RcSensor& sensor(std::size_t i) const { return sensors_[i]; }

 private:
  DeadWeightOptions options_;
  std::vector<RcSensor> sensors_;
  std::vector<double> feedback_ohm_;
  double gain_bandwidth_Hz_ = 0.0, force_scale_ = 1.0;
  Rng noise_{0}, pace_{0};
};

}  // namespace forcegate::emulated
