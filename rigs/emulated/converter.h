#pragma once

#include <cstdint>

namespace forcegate::emulated {

/// Conditioning output and converter: rails at 0 and v_range, white noise, rounding to 2^bits - 1 steps.
class Converter {
 public:
  struct Parameters {
    int bits = 16;
    double v_range_V = 10.0;
    double noise_V = 0.0015;  ///< standard deviation, amplifier and converter together (ours)
  };

  void begin(const Parameters& p) {
    p_ = p;
    last_code_ = (1 << p.bits) - 1;
    per_volt_ = static_cast<double>(last_code_) / p.v_range_V;
  }

  /// `white` is a standard normal number.
  std::uint16_t convert(double voltage_V, double white) const {
    const double code = (voltage_V + p_.noise_V * white) * per_volt_ + 0.5;
    if (code <= 0.0) return 0;
    if (code >= static_cast<double>(last_code_)) return static_cast<std::uint16_t>(last_code_);
    return static_cast<std::uint16_t>(code);
  }

  int last_code() const { return last_code_; }

 private:
  Parameters p_;
  int last_code_ = 65535;
  double per_volt_ = 6553.5;
};

}  // namespace forcegate::emulated
