#pragma once
// The wall clock, for time stamps and expiry dates. Verbs read it and pass the text on; nothing that judges does.

#include <string>

namespace forcegate {

/// "2026-03-01T09:30:00Z", UTC, whole seconds.
std::string utc_now();
/// Seconds since 1970-01-01.
double utc_seconds();
/// The first form of any such number.
std::string utc_text(double seconds);
/// "2026-03-01", UTC.
std::string utc_today();

}  // namespace forcegate
