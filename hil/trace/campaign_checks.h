#pragma once
// What cannot be true of a campaign as it was read, whatever its sensor does.

#include "hil/trace/campaign.h"

namespace forcegate {

/// Takes out every record whose force and output repeat those of an earlier one sample by sample: a copy is no second measurement. Noted.
void drop_copies(Campaign& campaign);

/// Notes samples far beyond the declared ranges and a campaign that holds every record out; start times that let one record begin long
/// before another has ended are not used, noted.
void note_contradictions(Campaign& campaign);

}  // namespace forcegate
