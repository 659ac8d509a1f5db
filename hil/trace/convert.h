#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "hil/base/result.h"
#include "hil/trace/csv.h"

namespace forcegate {

/// Reads a trace by the ending of its name: .csv .txt .tsv .dat, .h5 .hdf5, .mat, .fgj (journal); any other file by how it begins, as text
/// where that tells nothing. Errors: those of the reader.
Result<TraceFile> read_trace(const std::filesystem::path& path, const CsvOptions& options = {});

/// Writes by the ending: .csv, .h5 .hdf5, .mat.
Result<void> write_trace(const Trace& trace, const std::filesystem::path& path);

/// Reads, writes, and returns the notes. A trace with several time bases cannot become a CSV.
Result<std::vector<std::string>> convert_trace(const std::filesystem::path& from,
                                               const std::filesystem::path& to,
                                               const CsvOptions& options = {});

}  // namespace forcegate
