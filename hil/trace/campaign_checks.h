#pragma once
// What cannot be true of a campaign as it was read, whatever its sensor does.

#include "hil/trace/campaign.h"

namespace forcegate {

/// What keeps a record from being compared with a model; empty for most.
struct Unfit {
  std::string too_short, no_column;
};
Unfit unfit(const Trace& trace);

/// Takes out every record whose force and output repeat those of an earlier one sample by sample: a copy is no second measurement. Noted.
void drop_copies(Campaign& campaign);

/// Takes out a voltage range that readings in counts go far beyond, noted. Notes samples far beyond the declared ranges and a campaign that holds every record out; start times that let one record begin long
/// before another has ended are not used, noted. A rest_before_s longer than from the end of the record before (none of rest) to start_s, by more than a minute and a
/// tenth, is noted; both stay. So do a noise or resolution of the reference larger than the force spans in all records that move, and a range 200 times
/// as wide as what they span: noted.
void note_contradictions(Campaign& campaign);

/// A rate that was given (Hz; 0: none) where the clock of a file has another one, by more than a twentieth: noted, the clock counts.
void note_unused_rate(Campaign& campaign, double given_Hz);

/// The outputs of one campaign are one quantity: a record in siemens beside others in volts is told by no law. Error (parse): the record, its unit and
/// that of most others (of the first, where as many have each). Records without an output are not asked.
Result<void> check_outputs_alike(const Campaign& campaign);

/// A column called supply, and not drive, is the sensor's drive where somebody set it: the medians of records differ by more than a twentieth and by
/// more than it moves within any of them. It is then renamed, else left unused; both noted. Not asked where a record has a drive.
void take_varied_supply(Campaign& campaign);

}  // namespace forcegate
