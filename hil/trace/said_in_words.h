#pragma once
// Facts of records that no key tells and words do: when they were made, how the sensor was mounted, the air around them, the cycles between them.

#include <string>
#include <vector>

#include "hil/trace/campaign_description.h"

namespace forcegate {

/// Puts what is said of all records at once, a number for each, where a record has no words of its own.
void take_lists(const CampaignMembers& members, std::vector<DescribedRecord>& records);

/// Puts what is said in words (DescribedRecord::notes, air) where a record lacks the fact, with a note for each kind: stamps where every record has one,
/// mountings and cycles where no record has the key. A running count of cycles becomes what each record adds to it, noted.
void take_words(std::vector<DescribedRecord>& records, std::vector<std::string>& notes);

}  // namespace forcegate
