#pragma once
// A contact that opens in every cycle. The force then rests at its lowest, the output shows something else than a load, and just after the contact
// is made it rings. Loops and curves take that for their own.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "hil/model/record_input.h"

namespace forcegate::diagnose {

struct OpenContact {
  std::size_t times = 0;  ///< that the force came to rest at its lowest, over all records in which it does so often; 0: in too few of them
  double share = 0.0;     ///< of these records
  std::vector<std::vector<std::uint8_t>> rows;  ///< by record; 1: it rests, or left its rest a moment ago; empty: the contact does not open there

  explicit operator bool() const { return times > 0; }
};

/// Records in which the force comes to rest within a fiftieth of the range above the lowest, eight times and more, for 15 to 60 % of the time.
/// They must be half of the records, since a rest now and then is of a protocol. A moment: half a second, or a third of the time that the contact
/// is typically made, whichever is shorter, and a quarter of a second at least. Blocks of one recording hold the same rows.
OpenContact open_contact(const CampaignInput& input);

/// Marks these rows as not to be used.
void leave_out_open(const OpenContact& open, CampaignInput& input);

}  // namespace forcegate::diagnose
