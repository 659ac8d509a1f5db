#include "hil/diagnose/raw/folded_hum.h"

#include <algorithm>

#include "hil/diagnose/raw/hum_claim.h"
#include "hil/diagnose/raw/mains_line.h"

namespace forcegate::diagnose {

std::vector<char> records_of_folded_hum(const Workspace& w, const ResidualChannel& channel) {
  std::vector<char> out(channel.record_of.size(), 0);
  for (const double mains_Hz : kMains_Hz) {
    if (!is_hum(records_of_hum(w.health, w.scales, {mains_Hz, mains_Hz}))) continue;
    for (std::size_t k = 0; k < out.size(); ++k) {
      const double rate_Hz = w.health[channel.record_of[k]].rate_Hz;
      if (rate_Hz > 0.0 && folded_Hz(mains_Hz, rate_Hz) < kSlowestLine_Hz) out[k] = 1;
    }
  }
  return out;
}

}  // namespace forcegate::diagnose
