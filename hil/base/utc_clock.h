#pragma once
// The wall clock, for time stamps and expiry dates. Verbs read it and pass the text on; nothing that judges does.

#include <string>

namespace forcegate {

/// "2026-03-01T09:30:00Z", UTC, whole seconds.
std::string utc_now();
/// "2026-03-01", UTC.
std::string utc_today();

}  // namespace forcegate
