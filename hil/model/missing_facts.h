#pragma once
// What some records of a campaign tell and others do not: a question that is then not asked, and nobody would know why.

#include "hil/model/record_input.h"

namespace forcegate {

/// Notes on finished records (hil/model/rows.h): drive, temperature, humidity, mounting, geometry of the wheel. What none tells
/// is no note. A drive that is the same (2 %) wherever at least two records tell it is none either.
void note_missing_facts(CampaignInput& campaign);

}  // namespace forcegate
