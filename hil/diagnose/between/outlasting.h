#pragma once
// An effect whose state runs on from record to record (EffectForm::outlasts) is told twice: by the rows within the records, whose gain and
// zero are free, and by these levels. One strength from two witnesses that know nothing of each other is an effect, however little of it
// a gain and a zero of its own leave within a record.

#include <vector>

#include "hil/diagnose/between/record_questions.h"

namespace forcegate::diagnose {

/// Where rows and levels agree on a form that outlasts a record, and the rows like it nearly as well as the family's best form, it is the
/// family's best, `records` is its evidence from the levels, and `records.same_strength` is set.
void prefer_what_both_tell(const ResidualChannel& channel, const RecordLevels& levels, const FamilyQuestion& asked, const std::vector<int>& present, const MixedFit& base,
                           const SelectionRules& rules, FamilyScore& family);

}  // namespace forcegate::diagnose
