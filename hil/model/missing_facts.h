#pragma once
// What some records of a campaign tell and others do not: a question that is then not asked, and nobody would know why.

#include <cstddef>

#include "hil/model/record_input.h"

namespace forcegate {

/// Notes on finished records (hil/model/rows.h): drive, temperature, humidity, mounting, geometry of the wheel. What none tells
/// is no note. A drive that is the same (2 %) wherever at least two records tell it is none either.
void note_missing_facts(CampaignInput& campaign);

/// Whether the records that tell a cause can be asked about it alone: at least five, and at least half of all.
constexpr bool enough_tell(std::size_t told, std::size_t all) { return told >= 5 && 2 * told >= all; }

}  // namespace forcegate
