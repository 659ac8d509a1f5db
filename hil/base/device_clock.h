#pragma once
// The clock of a device against the bench's, from exchanges: the device read its clock at d, between the request that
// left at s and the answer that came at r (bench time). Then offset(d) = bench - device lies in [s - d, r - d].
//   m_i = (s_i + r_i)/2 - d_i,  h_i = (r_i - s_i)/2,  weighted straight line  m = offset + skew (d - d0),  w = 1/(h + 1 us)^2
// A slow exchange says little and weighs little.

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <limits>

namespace forcegate {

struct ClockFit {
  std::size_t exchanges = 0;
  double offset_s = 0.0;    ///< bench - device at the newest exchange
  double skew_ppm = 0.0;    ///< positive: the device's clock is slow
  double residual_s = 0.0;  ///< weighted root mean square of the m_i about the line
  double u_s =
      std::numeric_limits<double>::infinity();  ///< standard uncertainty of the offset: narrowest h / sqrt(3)
};

class DeviceClock {
 public:
  void clear() { seen_.clear(), stale_ = true, total_ = 0; }

  void add(double sent_s, double device_s, double received_s) {
    seen_.push_back(
        {device_s, 0.5 * (sent_s + received_s) - device_s, std::fmax(0.0, 0.5 * (received_s - sent_s))});
    if (seen_.size() > kKept) seen_.pop_front();
    ++total_;
    stale_ = true;
  }

  ClockFit fit() const {
    if (stale_) compute();
    return fit_;
  }
  /// Bench time of an instant of the device's clock; the device's own time while nothing is known.
  double bench_s(double device_s) const {
    if (stale_) compute();
    return device_s + fit_.offset_s + 1e-6 * fit_.skew_ppm * (device_s - newest_s_);
  }

 private:
  struct Exchange {
    double device_s, offset_s, half_width_s;
  };
  static constexpr std::size_t kKept = 256;
  static constexpr double kSkewSpan_s = 2.0;  ///< a shorter stretch tells no skew

  void compute() const {
    stale_ = false;
    fit_ = {};
    if (seen_.empty()) return;
    newest_s_ = seen_.back().device_s;
    double w = 0.0, wx = 0.0, wy = 0.0, narrowest = seen_.front().half_width_s;
    for (const Exchange& e : seen_) {
      const double weight = weight_of(e);
      w += weight;
      wx += weight * (e.device_s - newest_s_);
      wy += weight * e.offset_s;
      narrowest = std::fmin(narrowest, e.half_width_s);
    }
    double wxx = 0.0, wxy = 0.0;
    for (const Exchange& e : seen_) {
      const double x = e.device_s - newest_s_ - wx / w;
      wxx += weight_of(e) * x * x;
      wxy += weight_of(e) * x * (e.offset_s - wy / w);
    }
    const bool long_enough = newest_s_ - seen_.front().device_s >= kSkewSpan_s && wxx > 0.0;
    const double slope = long_enough ? wxy / wxx : 0.0;
    fit_.exchanges = total_;
    fit_.skew_ppm = 1e6 * slope;
    fit_.offset_s = wy / w - slope * wx / w;
    fit_.u_s = narrowest / std::sqrt(3.0);
    double square = 0.0;
    for (const Exchange& e : seen_) {
      const double r = e.offset_s - fit_.offset_s - slope * (e.device_s - newest_s_);
      square += weight_of(e) * r * r;
    }
    fit_.residual_s = std::sqrt(square / w);
  }
  static double weight_of(const Exchange& e) {
    return 1.0 / ((e.half_width_s + 1e-6) * (e.half_width_s + 1e-6));
  }

  std::deque<Exchange> seen_;
  std::size_t total_ = 0;
  mutable bool stale_ = true;
  mutable ClockFit fit_;
  mutable double newest_s_ = 0.0;
};

}  // namespace forcegate
