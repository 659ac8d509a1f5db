#pragma once
// The facts of a record once more, from its stored samples instead of a rig and a firmware.

#include "hil/gate/case_record.h"
#include "hil/interface/comparator.h"
#include "hil/trace/trace.h"

namespace forcegate {

/// `stored` gives what samples cannot (rig, firmware, unloaded readings, link counters, safety stop); everything that
/// comes from samples is measured anew. Channels: F_cmd, F_ref, U (counts), theta, status, F_dut, flags, w_cmd (rad/s;
/// optional). The comparator, chosen for the declared algorithm, may be null. Errors (parse): a column is missing.
Result<CaseRecord> measure_again(const CaseJob& job, const CaseRecord& stored, const Trace& trace,
                                 Comparator* comparator);

}  // namespace forcegate
