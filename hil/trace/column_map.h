#pragma once
// Foreign columns under names of docs/campaign.md: what --map says, whether it met a column, and what to advise where a name is missing.

#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "hil/trace/columns.h"
#include "hil/trace/csv.h"

namespace forcegate {

using ColumnMap = std::map<std::string, std::string>;

/// "NAME=F_ref_N" words of --map, split at the last "=", to a map. A name may be followed by a factor and the reading at zero: "hx711=F_ref_N:1/21543:84211" is
/// (cell - 84211) / 21543 newtons. Errors: usage.
Result<ColumnMap> parse_column_map(std::span<const std::string> words);

/// A mapped column that exists nowhere is a typing mistake, and what is then read is not what was meant: usage, with the columns of `traces`.
Result<void> check_column_map(const ColumnMap& map, std::span<const std::string> mapped, std::span<const Trace* const> traces,
                              const std::filesystem::path& where);

/// What `to` names, without a scale behind it.
ColumnMeaning meaning_of_target(const std::string& to);

/// What a column is that is mapped to `to`, its scale in the unit; notes tell where it is called by another unit than it is read in.
ColumnMeaning mapped_meaning(const std::string& header, const Unit& of_header, const std::string& to, std::vector<std::string>& notes);

/// Maps the channels of a file that holds channels and no columns (HDF5, a journal); its clock stays what it is.
void map_channels(TraceFile& file, const ColumnMap& map);

/// read_trace() of a recording and a map whose words stand one a line, as an option of a rig or a profile holds them; every one must meet a column. Forces are turned over as in
/// compression.h.
Result<TraceFile> read_mapped_trace(const std::filesystem::path& path, std::string_view map, double assumed_rate_Hz = 0.0);

/// The header of a column as its file writes it, else as ours do. `headers`: of channels by name.
std::string written_header(const Channel& channel, const std::map<std::string, std::string>& headers);

/// "--map kgf=F_ref_kgf": what to write where no column is `name` (in `unit`), with the likeliest column.
std::string column_map_advice(const Trace& trace, std::string_view name, std::string_view unit, const std::map<std::string, std::string>& headers = {});

/// What to do where a force or output is missing and every column is something else already; "" where one is left.
std::string no_column_left_advice(const Trace& trace);

}  // namespace forcegate
