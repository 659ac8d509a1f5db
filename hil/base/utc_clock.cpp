#include "hil/base/utc_clock.h"

#include <ctime>

namespace forcegate {

double utc_seconds() { return static_cast<double>(std::time(nullptr)); }

std::string utc_now() { return utc_text(utc_seconds()); }

std::string utc_text(double seconds) {
  const auto whole = static_cast<std::time_t>(seconds);
  std::tm utc{};
  gmtime_r(&whole, &utc);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc);
  return text;
}

std::string utc_today() { return utc_now().substr(0, 10); }

}  // namespace forcegate
