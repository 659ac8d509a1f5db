#pragma once
// A recording: named columns, each with quantity, unit and the time base of the device that stamped it.

#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace forcegate {

/// A hole in a time base: samples [index - 1] and [index] are further apart than the clock allows.
struct Gap {
  std::size_t index = 0;
  double from_s = 0.0, to_s = 0.0;
};

/// Instants of one device's samples, s, in record time.
struct TimeBase {
  std::string device = "rig";
  std::vector<double> t_s;       ///< strictly increasing
  double nominal_rate_Hz = 0.0;  ///< 0 = unknown or non-uniform
  std::vector<Gap> gaps;         ///< stored, never silently interpolated
  bool invented = false;         ///< the file had no clock: t is row number over an assumed rate
};

struct Channel {
  std::string name;      ///< "F_ref", "U", "theta", "temp", "C", "F_cmd", "F_dut", "drive"
  std::string unit;      ///< canonical unit symbol: "N", "V", "rad"
  std::string quantity;  ///< "force"
  std::size_t time_base = 0;
  std::vector<double> value;      ///< NaN = missing
  std::vector<std::int32_t> raw;  ///< device counts beside the physical values, kMissingCount = missing; may be empty
};

/// The counts are a column of their own beside physical values; a channel that is nothing but counts is one column.
inline bool has_counts_beside(const Channel& c) { return !c.raw.empty() && c.quantity != "code" && c.unit != "counts"; }

struct Trace {
  std::string name;
  std::vector<TimeBase> time_bases;
  std::vector<Channel> channels;
  std::map<std::string, std::string>
      provenance;  ///< rig, firmware hash, stimulus, seed, calibration, versions

  const Channel* find(std::string_view channel_name) const;
  Channel* find(std::string_view channel_name);
  /// Number of samples of the first time base.
  std::size_t size() const { return time_bases.empty() ? 0 : time_bases.front().t_s.size(); }
};

inline constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();

}  // namespace forcegate
