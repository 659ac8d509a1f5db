#pragma once
// Causes that only some records tell: drive voltage, temperature, humidity.

#include <string>
#include <vector>

#include "hil/diagnose/diagnosis.h"
#include "hil/trace/campaign.h"

namespace forcegate::diagnose {

/// A cause that differs between the records that tell it, with those records alone: a record without it says nothing of what it does.
struct PartlyTold {
  std::string effect, fact;
  std::vector<std::string> silent;  ///< names of the records that are left out
  Campaign told;
};

/// Every cause that enough records tell (hil/model/missing_facts.h) and some do not.
std::vector<PartlyTold> partly_told(const Campaign& campaign);

/// Whether the answer of the records that tell the cause is the better one: it claims its effect plainly, and `whole` claims nothing that
/// acts between records. The answer then says which records it leaves out.
bool take_partly_told(const PartlyTold& of, const Diagnosis& whole, Diagnosis& answer);

}  // namespace forcegate::diagnose
