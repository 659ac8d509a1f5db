#pragma once
// A contact that opens in every cycle. The force then rests at its lowest, the output shows something else than a load, and just after the contact
// is made it rings. Loops and curves take that for their own.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "hil/model/record_input.h"

namespace forcegate::diagnose {

struct OpenContact {
  std::size_t times = 0;            ///< that the force came to rest at its lowest; 0: not often, or for little of the time
  double share = 0.0;               ///< of the recording
  std::vector<std::uint8_t> rows;   ///< 1: it rests, or left its rest within a quarter of a second

  explicit operator bool() const { return times > 0; }
};

/// Of one recording; its blocks hold the same rows.
OpenContact open_contact(const CampaignInput& input);

}  // namespace forcegate::diagnose
