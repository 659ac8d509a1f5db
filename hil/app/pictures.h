#pragma once
// The pictures of a diagnosis as files that stand alone (SVG), for documents and papers.

#include <filesystem>
#include <vector>

#include "hil/base/result.h"
#include "hil/diagnose/diagnosis.h"

namespace forcegate {

/// Writes into `folder` (made if missing): ranking, waterfall, records, map_before, map_after, and for every claim its
/// evidence, <effect>_1.svg and so on. Returns the files in that order.
Result<std::vector<std::filesystem::path>> write_pictures(const Diagnosis& diagnosis,
                                                          const std::filesystem::path& folder);

}  // namespace forcegate
