#pragma once
// S7 and S9: what is noise, what is structure without a name, how sure a named effect is.

#include "hil/diagnose/residual_map.h"
#include "hil/diagnose/select.h"

namespace forcegate::diagnose {

struct Structure {
  double rms = 0.0;         ///< RMS of what is smoother than noise, share of the span
  double share = 0.0;       ///< of the residual's mean square
  std::size_t records = 0;  ///< records that show it
  std::size_t of_records = 0;
};

/// Structure left in a residual (rows of every record): mean squares above the known noise that hang together over rows.
Structure structure_of(const ResidualChannel& channel, const std::vector<std::vector<double>>& residual);

/// Groups of coordinates that the residual depends on, at most three; "time" when nothing else explains it.
std::vector<std::string> depends_on(const std::vector<ResidualMap>& maps);

}  // namespace forcegate::diagnose
