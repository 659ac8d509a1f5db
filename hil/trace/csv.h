#pragma once
// CSV files to and from traces (docs/campaign.md).

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "hil/base/result.h"
#include "hil/trace/csv_table.h"
#include "hil/trace/trace.h"

namespace forcegate {

struct CsvOptions {
  std::map<std::string, std::string> column_map;  ///< foreign column name -> "F_ref_N" form
  double assumed_rate_Hz = 0.0;                   ///< for files without a clock; 0 = refuse them
};

struct TraceFile {
  Trace trace;
  std::vector<std::string> notes;   ///< what was assumed, converted, dropped; one sentence each
  std::vector<std::string> mapped;  ///< entries of the column map that met a column
  std::map<std::string, std::string> headers;  ///< name of a channel -> header of its column as written
  std::uint64_t header_line = 0;  ///< of a text file; 0 elsewhere
  std::string sensor;             ///< as a line above the rows or the name of the output's column calls it (sensor_name.h); "" where neither does
};

/// What a note says of an instrument's overload, behind the count of its samples.
inline constexpr std::string_view kOverloadsLeftOut = " values of 9.9e37 and more are an instrument's overload";

/// Every column becomes a channel in its canonical unit. A column of counts beside a physical one of the same name
/// ("U_counts", "U_V") becomes that channel's `raw`. Errors: see read_csv_table and make_clock; no clock and no rate.
Result<TraceFile> read_csv(const std::filesystem::path& path, const CsvOptions& options = {});
Result<TraceFile> parse_csv(std::string_view bytes, std::string_view name, const CsvOptions& options = {});

/// Columns with meanings to a trace; shared with the reader of MAT files.
Result<TraceFile> trace_of_table(CsvTable table, const std::string& where, const std::string& name,
                                 const CsvOptions& options);

/// Shortest numbers that read back as the same double; missing samples are empty cells. Written under a temporary
/// name and renamed. Errors: io; config when the channels have several time bases (a CSV has one; HDF5 keeps them).
Result<void> write_csv(const Trace& trace, const std::filesystem::path& path);

}  // namespace forcegate
