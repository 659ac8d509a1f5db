#pragma once
// Cycles between records that nobody recorded, as a lab writes them down: "500 endurance cycles before run 3".

#include <cstddef>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace forcegate {

/// Of one record: "after 500 cycles", "1500 fatigue cycles before this run", "cycles since the last run: 200". Nothing where the text has two such numbers, or
/// cycles of another kind ("20 cycles at 1 Hz").
std::optional<double> cycles_in_words(std::string_view text);

/// Of a campaign: "unrecorded cycles between runs: 200 before run 2; 1500 before run 8", one number a record in the order of the file, 0 where
/// nothing is said. Empty: the text says nothing of the kind, or speaks of a record that there is not.
std::vector<double> cycles_of_runs(std::string_view text, std::size_t records);

/// Whether counts of records in the order of time are those since the first record: they never fall, and three of at least four differ.
bool is_running_count(std::span<const double> counts);

}  // namespace forcegate
