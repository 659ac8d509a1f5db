#pragma once
// What the answer without the rows of an open contact says of the one with them.

#include "hil/diagnose/base/open_contact.h"
#include "hil/diagnose/diagnosis.h"

namespace forcegate::diagnose {

/// Where most of what the law leaves lies in the rows in which the contact is open or was just made, what is claimed of any course at low load, loops
/// and curves, must be claimed as well without them: else it is doubted, and contact_loss is named; so it is where structure has no name, and without these rows nothing is left of it. Named
/// is claimed where the rest of the recording shows no effect, so that all there is lies in these rows; else listed.
void judge_by_closed_contact(const OpenContact& open, const Diagnosis& while_closed, Diagnosis& out);

/// Whether the answer may change by it, so that it is worth asking without these rows.
bool asks_for_closed_contact(const Diagnosis& answer);

}  // namespace forcegate::diagnose
