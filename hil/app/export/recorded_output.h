#pragma once
// What a firmware's converter would have read in a recording.

#include <vector>

#include "hil/model/record_input.h"
#include "hil/trace/campaign.h"

namespace forcegate {

/// U of the record that `rows` were made of, at the even instants `t_s` of its clock (s since its first sample). Of a record with as many samples
/// or more it is the nearest one, noise and all, which means over rows and values between two samples would hide; of a slower one it runs
/// along a straight line between two. Samples that are missing are bridged. Empty where the campaign has no such record.
/// `read_s`: becomes when each of them was read, which is not `t_s` where the nearest sample stands for it.
std::vector<double> recorded_output(const Campaign& campaign, const RecordInput& rows, const std::vector<double>& t_s, std::vector<double>* read_s = nullptr);

}  // namespace forcegate
