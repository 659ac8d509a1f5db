#pragma once
// MATLAB 5 files through matio: one vector for each channel, named as a CSV column ("F_ref_N"), and "t_s".

#include <filesystem>

#include "hil/base/result.h"
#include "hil/trace/csv.h"
#include "hil/trace/trace.h"

namespace forcegate {

/// Compressed level 5. Several time bases: "t_s" of the first, "t_2_s" ... of the others, and a channel of another
/// time base than the first ends in "_at_2". Provenance becomes the character array "provenance" (JSON). Errors: io.
Result<void> write_mat(const Trace& trace, const std::filesystem::path& path);

/// Real numeric vectors of one common length become columns (others are left out and noted), with the meanings and
/// clocks of read_csv. Errors: io, parse.
Result<TraceFile> read_mat(const std::filesystem::path& path, const CsvOptions& options = {});

}  // namespace forcegate
