#pragma once
// One record in millivolts under a header that says volts, or in millinewtons: its output per newton is that of another instrument. Or its sign.

#include <string>
#include <vector>

#include "hil/base/result.h"
#include "hil/model/record_input.h"

namespace forcegate::diagnose {

/// Compares the slopes of U on F of the records whose output follows their force (correlation above 0.7) with their median. More than 300
/// times as much or as little is a wrong unit: an error (parse). More than eight times, which no decay makes, is told in `notes`. A record whose
/// output falls with the force, while that of most others rises, is an error too, where its force moves a fifth as much as theirs. Of two
/// records nobody knows which one is wrong: both are named.
Result<void> check_record_gains(const std::vector<RecordInput>& records, std::vector<std::string>& notes);

}  // namespace forcegate::diagnose
