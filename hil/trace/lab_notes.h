#pragma once
// What a lab wrote of its records in words of its own: when they were made, and where the sensor was mounted anew.

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace forcegate {

struct LabNotes {
  std::optional<double> stamp_s;  ///< seconds since 1970 of the first text that is a date and a time of day
  std::string mounting;           ///< "2" of "mounting 2", of "mount_id": 2
  bool remounted = false;         ///< "remounted", "new mounting", "remounted": true; a text that says "not" says nothing

  bool empty() const { return !stamp_s && mounting.empty() && !remounted; }
};

/// Out of the members of a record that no key of campaign.json knows: name and value as text.
LabNotes lab_notes(const std::vector<std::pair<std::string, std::string>>& members);

}  // namespace forcegate
