#pragma once
// Rows that were stamped when they were read, several in a row, and not when they were sampled.

#include <optional>
#include <vector>

namespace forcegate {

/// Values of the other columns of a table, by row; empty: nothing is known of them.
using OtherColumns = std::vector<const std::vector<double>*>;

/// Rows that came in bursts through a buffer (a USB converter hands over every 16 ms what it has): most steps of the stamps (ascending, s) are
/// below half their mean, and the rows of a burst go with the time since the one before. A logger that truly samples in bursts leaves the same stamps;
/// its values move on in the pause as in any other time, while those of a buffer move between two bursts as between two rows. `rows` are the
/// rows of `columns` that the stamps belong to (empty: all). declared_rate_Hz (0: not declared) decides where it is within a quarter of
/// either. Columns that only rise or only fall are counters and say nothing.
/// The stamp of each row's last in its burst, for spread_packets (packets.h); nothing where rows were stamped one by one, where
/// a logger samples in bursts, or where the values do not tell.
std::optional<std::vector<double>> stamps_of_bursts(const std::vector<double>& stamps_s, const std::vector<std::size_t>& rows, const OtherColumns& columns,
                                                    double declared_rate_Hz);

}  // namespace forcegate
