#pragma once
// `forcegate recover`: the trace of a recording that was cut off.

#include <filesystem>

#include "hil/trace/journal.h"

namespace forcegate {

struct RecoverRequest {
  std::filesystem::path journal;
  std::filesystem::path output;  ///< empty: the journal's name with .h5
  bool overwrite = false;
};

struct Recovered {
  std::filesystem::path output;
  JournalReport report;
};

/// Makes the HDF5 file of all whole frames. The journal stays as it is. Errors: usage when the output exists, io, parse.
Result<Recovered> recover(const RecoverRequest& request);

}  // namespace forcegate
