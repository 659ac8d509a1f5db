#pragma once
// What campaign.json says of a record against what its samples show.

#include "hil/trace/campaign.h"

namespace forcegate {

/// Compares fs_Hz, excitation_start_s, f_min_Hz (Hz), A_N, m_N (N), dynamic, temp_C (degree Celsius) and humidity_pct of every record with its
/// clock and its force; each contradiction is a note with the declared and the measured value. What cannot be is taken out, so that it is
/// estimated as if nobody had said it:
///   excitation_start_s   not before the end of the record, by its clock and since its first sample; in the midst of cycles, eight turns on end before it
///   f_min_Hz             above 1.5 times the fastest tenth of the half cycles
///   A_N                  above 1.25 times half the span of all samples of the force
///   m_N                  beyond the lowest and highest sample by a tenth of their span
///   temp_C, humidity_pct outside -60 .. 200 and 0 .. 100
/// What is only unlikely stays in force: A_N below the typical half swing / 1.5, m_N further from the middle of the span and of the
/// typical cycle than half the half span, f_min_Hz of a sine below its slowest tenth / 1.5, a cycled record that is said not to be dynamic, and the reverse. fs_Hz more than a
/// fifth beside the clock is noted; the clock counts anyway.
void check_declared_facts(Campaign& campaign);

}  // namespace forcegate
