#pragma once
// `forcegate characterize --record`: recordings in the place of a rig.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "hil/app/characterize/characterize.h"
#include "hil/characterize/bench.h"

namespace forcegate {

/// The name of its file, with those of the folders above it as far as another recording has the same.
std::string name_of_recording(const std::filesystem::path& path, const std::vector<std::filesystem::path>& all);

/// One sheet a recording; a copy counts once. Errors: those of the rig and of characterize_recording, with the path.
Result<characterize::SensorStudy> study_recordings(const CharacterizeRequest& request, const characterize::StudyPlan& plan, characterize::BenchProgress& progress);

/// Of exactly one recording with the static law and one with b and c/a: a sheet of both, level identified. Nothing
/// else tells which cyclic recording and which slow one are of one sensor.
std::optional<characterize::SessionSheet> sheet_of_both(const characterize::SensorStudy& study);

}  // namespace forcegate
