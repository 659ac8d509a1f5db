#include "hil/diagnose/raw/folded_hum.h"

#include <algorithm>

#include "hil/diagnose/raw/mains_line.h"

namespace forcegate::diagnose {

std::vector<char> records_of_folded_hum(const Workspace& w, const ResidualChannel& channel) {
  constexpr std::ptrdiff_t kShow = 2;
  std::vector<char> out(channel.record_of.size(), 0);
  for (const double mains_Hz : {50.0, 60.0}) {
    const auto shows_it = [&](const RecordHealth& h) { return h.mains_Hz == mains_Hz && shows_hum(h, w.scales); };
    if (std::ranges::count_if(w.health, shows_it) < kShow) continue;
    for (std::size_t k = 0; k < out.size(); ++k) {
      const double rate_Hz = w.health[channel.record_of[k]].rate_Hz;
      if (rate_Hz > 0.0 && folded_Hz(mains_Hz, rate_Hz) < kSlowestLine_Hz) out[k] = 1;
    }
  }
  return out;
}

}  // namespace forcegate::diagnose
