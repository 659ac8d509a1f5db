#pragma once
// The error of every record before and after, and of the campaign.

#include "hil/diagnose/choose/select.h"
#include "hil/diagnose/diagnosis.h"
#include "hil/diagnose/workspace.h"

namespace forcegate::diagnose {

/// Sets records, error_before and error_after, their plain companions and the floor, of the base and of what is claimed. After the findings: a
/// claim that acts between records is judged where they keep the gain and the zero of all, by the records that others foretell (those that none
/// does are named in a note); a claimed line or bad sample counts before and not after, one that is
/// set aside without a claim in neither.
void add_records(const Workspace& workspace, const Selection& selection, Diagnosis& out);

/// Whether claims within the records leave most of the error of left-out ones, far above the floor and large enough to matter: what all forms
/// of their families soak up does not foretell another record. After add_records.
bool most_stays(const Workspace& workspace, const Diagnosis& diagnosis);

/// Sets steps, by the same measure. After add_records.
void add_steps(const Workspace& workspace, const Selection& selection, Diagnosis& out);

}  // namespace forcegate::diagnose
