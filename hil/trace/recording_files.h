#pragma once
// Which files of a folder are recordings, by their endings.

#include <filesystem>
#include <vector>

#include "hil/base/result.h"

namespace forcegate {

struct RecordingFiles {
  std::vector<std::filesystem::path> records;  ///< .csv .tsv .h5 .hdf5 .mat, in the order of their names
  std::vector<std::filesystem::path> texts;    ///< .txt .dat .lvm .log .asc: a logger's, or a note
};

/// Hidden files are none. Error (io): the folder cannot be listed.
Result<RecordingFiles> recording_files(const std::filesystem::path& folder);

}  // namespace forcegate
