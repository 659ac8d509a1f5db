#pragma once

#include "hil/gate/case_record.h"

namespace forcegate {

/// In a closed loop a bad build drives the force where the reference cannot follow. It is charged with that when
/// everything that does not depend on it is sound and its output had left the ATI: not a number at any time, or
/// more than 0.4 N away over the last 0.2 s or at one of the last six extrema.
bool firmware_left_the_reference(const CaseRecord& record);

/// Who is asked to act when an instrument fails; its errors say in `where` which one it was ("reference: ...").
Blame blame_of_device(std::string_view where);

}  // namespace forcegate
