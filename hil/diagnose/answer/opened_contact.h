#pragma once
// What the answer without the rows of an open contact says of the one with them.

#include "hil/diagnose/base/open_contact.h"
#include "hil/diagnose/diagnosis.h"

namespace forcegate::diagnose {

/// Where a quarter of what the law leaves (RMS) goes with the rows in which the contact is open or was just made, what is claimed of any course at
/// low load, loops and curves, must be claimed as well without them: else it is doubted, and contact_loss is named. So it is where structure has no
/// name, two fifths go, and the rest is down to the noise. Named is claimed where two fifths go and the rest shows no effect; else listed.
void judge_by_closed_contact(const OpenContact& open, const Diagnosis& while_closed, Diagnosis& out);

/// Whether the answer may change by it, so that it is worth asking without these rows.
bool asks_for_closed_contact(const Diagnosis& answer);

}  // namespace forcegate::diagnose
