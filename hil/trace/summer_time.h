#pragma once
// What clocks that are set twice a year do to stamps without a zone.

#include <optional>
#include <string>
#include <vector>

namespace forcegate {

/// How to mend stamps that jump back from one row to the next; nothing where it is not by the hour of the end of summer time.
std::optional<std::string> hint_for_hour_back(double back_s, double step_s);

/// Index of the stamp before which one hour, and no more, is missing as at the beginning of summer time: on the hour, at night, and on a Sunday where the
/// date is known. Nothing where it is missing more often, as in a recording of every other hour.
std::optional<std::size_t> hour_ahead(const std::vector<double>& t_s, double step_s);
std::string hint_for_hour_ahead();

}  // namespace forcegate
