#pragma once
// Descriptions of deliberately bad and of equivalent firmware images (rigs/firmware/mutants/README.md), as
// they lie beside the images in the build folder.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "hil/base/result.h"

namespace forcegate {

struct Mutant {
  std::string name;             ///< "gain_pct@2"; the part before @ is its family
  std::string family;           ///< "gain_pct"; equal to the name when it has no levels
  std::optional<double> level;  ///< of a graded family
  std::string unit;
  bool equivalent = false;  ///< a good build made differently
  bool tolerable = false;   ///< a level of a family that is inside the stated error: must be accepted
  std::string breaks, promise, note;
  std::vector<std::string> seen_by;           ///< ids of checks, at least one of which must reject it
  std::vector<std::filesystem::path> images;  ///< those that were built

  bool good() const { return equivalent || tolerable; }
};

/// All mutants described in *.mutant of the folder, families from the smallest defect on. Mutants of which no
/// image was built (no cross compiler) have no images. Errors: usage (no such folder, none in it), config (a
/// description that says too little).
Result<std::vector<Mutant>> read_mutants(const std::filesystem::path& folder);

/// One description; `where` is its file's path. One mutant without levels, else one for each level; images
/// are not looked for.
Result<std::vector<Mutant>> parse_mutant(std::string_view text, const std::string& name,
                                         const std::string& where);

}  // namespace forcegate
