#pragma once
// A file that a logger went on writing after a pause of minutes: several records in one.

#include <string>
#include <vector>

#include "hil/trace/campaign.h"

namespace forcegate {

/// The records between the pauses of this one, in their order, named NAME_1, NAME_2 ..., each with the pause before it as rest_before_s and the clock of the
/// file; empty: it is one record. A pause is a minute and fifty steps at least, in which the load was taken off or changed: one that is as large behind it (5 % of the
/// span) stood through it, and the record goes on. Less than 64 samples between two pauses are no record: left out and noted. At least three records.
std::vector<Record> records_between_pauses(const Record& record, std::vector<std::string>& notes);

}  // namespace forcegate
