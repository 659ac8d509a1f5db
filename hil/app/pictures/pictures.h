#pragma once
// The pictures of a diagnosis as files that stand alone (SVG), for documents and papers.

#include <filesystem>
#include <vector>

#include "hil/base/result.h"
#include "hil/diagnose/diagnosis.h"
#include "hil/report/record_pictures.h"

namespace forcegate {

/// Writes into `folder` (made if missing): ranking, waterfall, records, map_before, map_after, for every claim its evidence,
/// <effect>_1.svg and so on, then spectrum_1, extrema_1, levels, drift_1. Returns the files in that order.
/// Errors (usage): a file that is no picture of ours stands in the way, unless `replaces`.
Result<std::vector<std::filesystem::path>> write_pictures(const Diagnosis& diagnosis, const RecordPictures& pictures,
                                                          const std::filesystem::path& folder, bool replaces = false);

}  // namespace forcegate
