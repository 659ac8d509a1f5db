#include "hil/app/export/recorded_rate.h"

#include <fmt/format.h>

#include <cmath>

namespace forcegate {

namespace {

constexpr double kSame = 0.01;

// "99.9982" is the 100 of a clock that runs a little off.
double round_rate(double rate_Hz) {
  const double whole = std::round(rate_Hz);
  return std::abs(rate_Hz - whole) < 1e-3 * whole ? whole : rate_Hz;
}

}  // namespace

double recorded_rate_Hz(const Campaign& campaign) {
  double rate_Hz = 0.0;
  for (const Record& record : campaign.records) {
    const Channel* output = record.trace.find("U");
    if (output == nullptr) continue;
    const double own_Hz = record.trace.time_bases[output->time_base].nominal_rate_Hz;
    if (!(own_Hz > 0.0) || (rate_Hz > 0.0 && is_other_rate(rate_Hz, own_Hz))) return 0.0;
    if (!(rate_Hz > 0.0)) rate_Hz = own_Hz;
  }
  return round_rate(rate_Hz);
}

bool is_other_rate(double header_Hz, double recorded_Hz) { return recorded_Hz > 0.0 && std::abs(recorded_Hz / header_Hz - 1.0) > kSame; }

std::string note_of_rate(double header_Hz, double recorded_Hz) {
  if (!is_other_rate(header_Hz, recorded_Hz)) return {};
  return fmt::format("the header is made for {0:g} samples a second and the records have {1:.6g}: a firmware that samples as they were recorded needs --rate {1:.6g}, "
                     "for at another rate what lags, creeps or filters is undone by wrong times",
                     header_Hz, recorded_Hz);
}

}  // namespace forcegate
