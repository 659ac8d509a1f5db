#pragma once
// Time stamps as loggers write them.

#include <optional>
#include <string>
#include <string_view>

namespace forcegate {

/// Seconds since 1970-01-01 00:00 of "2026-11-21T10:00:00.123", with slashes, with a blank for the T, with Z or +01:00 behind, after a blank too;
/// of "21.11.2026 10:00:00,123"; seconds since midnight of "10:00:00.123" and "9:05:00 PM"; those of a duration of MATLAB, "0.01 sec", "1.5 min", "2 hr", "1 day". Fractions after a point or a comma, of a duration after a point. Nothing
/// for any other text: a date with slashes and the year at its end does not say which number is the month.
std::optional<double> seconds_of_stamp(std::string_view text);

/// Whether a stamp ends in Z or +01:00.
bool has_zone(std::string_view stamp);

/// The first form, to milliseconds; "10:00:00.123" of seconds since midnight.
std::string stamp_of_seconds(double seconds);

/// Seconds since 1970-01-01 00:00 of the beginning of "2026-11-21", "2026/11/21", "21.11.2026"; nothing for any other text.
std::optional<double> seconds_of_date(std::string_view text);

}  // namespace forcegate
