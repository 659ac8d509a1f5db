#pragma once
// A dead-weight bench: calibrated weights on a pack of sensors, each behind an inverting amplifier that is driven by a
// selectable source and read by a sampled converter (Paredes-Madrid, Emmi, Gonzalez de Santos 2010, section IV, Fig. 3).
// An emulated bench and one of real parts are the same thing to whoever estimates R_s and C_s from what it delivers.

#include <complex>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "hil/base/registry.h"
#include "hil/base/result.h"

namespace forcegate {

struct WeightBenchInfo {
  std::string name;
  std::string version;
  std::size_t sensors = 8;  ///< in the pack, all under the same force
  double force_max_N = 250.0;
  double force_u_rel = 0.0;   ///< standard uncertainty of the weights, relative
  double feedback_ohm = 0.0;  ///< R_g
  double feedback_u_rel = 0.0;
  double gain_bandwidth_Hz = 0.0;  ///< of the amplifier; its closed loop turns the phase
  double gain_bandwidth_u_rel = 0.0;
  double rail_V = 0.0;   ///< the output saturates at +-rail_V
  double rate_Hz = 0.0;  ///< of the converter
  int adc_bits = 12;     ///< signed codes over +-range_V
  double range_V = 10.0;
  bool emulated = false;
  double volts_per_code() const { return 2.0 * range_V / static_cast<double>(1u << adc_bits); }
};

/// One loading of a pack from rest.
struct WeightBenchRequest {
  std::uint64_t seed = 1;     ///< emulated: draws the noises and what does not repeat
  std::uint64_t set = 0;      ///< which pack of sensors lies on the bench
  std::uint64_t loading = 0;  ///< tells the loadings of one pack apart
  double rest_before_s = 7200.0;
};

/// Eq. (1): constant amplitude_V; eq. (2): amplitude_V sin(2 pi f t), t = 0 at the first sample of a capture.
struct WeightBenchSource {
  enum class Kind { dc, sine };
  Kind kind = Kind::dc;
  double amplitude_V = -5.0;
  double f_Hz = 0.0;
};

class WeightBench {
 public:
  virtual ~WeightBench() = default;
  virtual WeightBenchInfo info() const = 0;

  /// Unloads, lets the pack rest, begins a loading. Errors: config.
  virtual Result<void> begin(const WeightBenchRequest& request) = 0;

  /// Puts weights on, or takes them off, until the force is `force_N`; then about `hold_s` pass (a person works here). Errors: usage (beyond the
  /// range, no loading begun).
  virtual Result<void> load(double force_N, double hold_s) = 0;

  /// Connects the source to one sensor, waits until the output is steady, and reads codes.size() samples of the output
  /// at info().rate_Hz. Errors: usage (no such sensor, a sine at or above half the rate).
  virtual Result<void> capture(std::size_t sensor, const WeightBenchSource& source,
                               std::span<std::int16_t> codes) = 0;

  /// Emulated benches only: the sensor's admittance as it is now, S. For the judgement of an estimate, never for one.
  virtual std::optional<std::complex<double>> true_admittance_S(std::size_t sensor, double f_Hz) const {
    (void)sensor, (void)f_Hz;
    return std::nullopt;
  }
};

/// Registry entry.
struct WeightBenchKind {
  std::string name;
  std::string doc;
  std::function<Result<std::unique_ptr<WeightBench>>(const std::map<std::string, std::string>& options)> make;
};

Result<std::unique_ptr<WeightBench>> make_weight_bench(const std::string& name,
                                                       const std::map<std::string, std::string>& options);

}  // namespace forcegate
