#pragma once
// What was played on the sensor of a campaign beyond its own records: a later record finds a film that has felt it.

#include <filesystem>
#include <vector>

#include "hil/base/result.h"
#include "rigs/emulated/hidden/campaign_maker.h"

namespace forcegate::hidden {

inline constexpr const char* kPlayedFile = "played_forces.json";

/// In the order of playing; none where there is no such file. Errors: io, parse.
Result<std::vector<AskedForce>> read_played(const std::filesystem::path& folder);
Result<void> write_played(const std::vector<AskedForce>& played, const std::filesystem::path& folder);

}  // namespace forcegate::hidden
