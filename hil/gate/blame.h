#pragma once

#include "hil/gate/case_record.h"

namespace forcegate {

/// Distance from the ATI beyond which the output has left it, N.
inline constexpr double kDeparture_N = 0.4;

/// In a closed loop a bad build drives the force where the reference cannot follow. It is charged with that when
/// everything that does not depend on it is sound and its output had left the ATI: not a number at any time, or
/// more than 0.4 N away over the last 0.2 s or at one of the last six extrema.
bool firmware_left_the_reference(const CaseRecord& record);

/// A board that falls silent at one sample of the record and, when it is played again, at the same one: a cable or a supply
/// does not count samples, the firmware does. Never of the first sample, and only where nobody knows that it still runs
/// (ErrorCode::timeout).
bool silent_at_the_same_sample(const CaseRecord& before, const CaseRecord& again);

/// "reference", "board" or "motor" where an error names the instrument that failed; else "".
std::string_view device_of(std::string_view where);

/// Who is asked to act when an instrument fails; its errors say in `where` which one it was ("reference: ...").
Blame blame_of_device(std::string_view where);

}  // namespace forcegate
