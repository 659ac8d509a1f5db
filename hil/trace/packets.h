#pragma once
// Rows that share one time stamp: samples that a logger sends in packets, or a clock coarser than the sample rate.

#include <optional>
#include <vector>

namespace forcegate {

/// Strictly increasing instants of rows whose stamps (ascending, s) stand for several of them. The stamp is that of the last row of a packet,
/// or of the first where the numbers of rows go with the following interval better. Where one line through the stamps over the row number misses none of them
/// by more than their usual distance the rows lie evenly on it; else they are spread evenly up to the neighbouring stamp, and beside a gap (an
/// interval of more than 1.5 times the rows' own, and one row) at the period of the others, which is 1 / declared_rate_Hz where that is within a
/// quarter of what the stamps say (0: not declared). Nothing with fewer than four stamps, or where more than 1 % of the rows come twice as
/// densely as the others: such a clock stood still.
std::optional<std::vector<double>> spread_packets(const std::vector<double>& stamps_s, double declared_rate_Hz);

}  // namespace forcegate
