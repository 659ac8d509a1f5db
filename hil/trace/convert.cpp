#include "hil/trace/convert.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <string_view>

#include "hil/base/read_file.h"
#include "hil/trace/column_map.h"
#include "hil/trace/csv_table.h"
#include "hil/trace/hdf5_io.h"
#include "hil/trace/journal.h"
#include "hil/trace/mat_io.h"

namespace forcegate {
namespace {

constexpr std::string_view kHdf5 = "\x89HDF", kMat = "MATLAB 5.0";
constexpr const char* kKnown = "known endings: .csv, .h5 .hdf5, .mat";

std::string ending_of(const std::filesystem::path& path) {
  std::string ending = path.extension().string();
  for (char& c : ending) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return ending;
}

Result<TraceFile> mapped(Result<TraceFile> file, const CsvOptions& options) {
  if (file) map_channels(*file, options.column_map);
  return file;
}

// What a pipe holds is looked at in the bytes that came: they come once.
Result<TraceFile> read_pipe(const std::filesystem::path& path, const CsvOptions& options) {
  const Result<std::string> bytes = read_file(path);
  if (!bytes) return tl::unexpected(bytes.error());
  const std::string_view begin(*bytes);
  if (begin.starts_with(kHdf5) || begin.starts_with(kMat))
    return fail(ErrorCode::io, "an HDF5 or MAT file cannot be read from a pipe", path.string(), "write it to a file and name that");
  FORCEGATE_TRY(CsvTable table, parse_csv_table(*bytes, path.string()));
  return trace_of_table(std::move(table), path.string(), path.stem().string(), options);
}

Unexpected unknown_ending(const std::filesystem::path& path, const char* what) {
  return fail(ErrorCode::config, std::string(what) + " \"" + ending_of(path) + "\" files", path.string(),
              kKnown);
}

}  // namespace

Result<TraceFile> read_trace(const std::filesystem::path& path, const CsvOptions& options) {
  if (is_pipe(path)) return read_pipe(path, options);
  const std::string ending = ending_of(path);
  if (ending == ".csv" || ending == ".tsv" || ending == ".txt" || ending == ".dat")
    return read_csv(path, options);
  if (ending == ".h5" || ending == ".hdf5") return mapped(read_hdf5(path), options);
  if (ending == ".mat") return read_mat(path, options);
  if (ending == ".fgj") return mapped(read_journal_trace(path), options);
  // no ending, or one of a logger (.lvm, .log, .asc): what it is stands at its beginning, and the reader of text refuses what is none
  std::array<char, 10> bytes{};
  std::ifstream(path, std::ios::binary).read(bytes.data(), bytes.size());
  const std::string_view begin(bytes.data(), bytes.size());
  if (begin.starts_with(kHdf5)) return mapped(read_hdf5(path), options);
  if (begin.starts_with(kMat)) return read_mat(path, options);
  return read_csv(path, options);
}

Result<void> write_trace(const Trace& trace, const std::filesystem::path& path) {
  const std::string ending = ending_of(path);
  if (ending == ".csv") return write_csv(trace, path);
  if (ending == ".h5" || ending == ".hdf5") return write_hdf5(trace, path);
  if (ending == ".mat") return write_mat(trace, path);
  return unknown_ending(path, "Forcegate cannot write");
}

Result<std::vector<std::string>> convert_trace(const std::filesystem::path& from,
                                               const std::filesystem::path& to, const CsvOptions& options) {
  const std::string ending = ending_of(to);
  if (ending != ".csv" && ending != ".h5" && ending != ".hdf5" && ending != ".mat")
    return unknown_ending(to, "Forcegate cannot write");  // before minutes of reading
  FORCEGATE_TRY(TraceFile file, read_trace(from, options));
  FORCEGATE_CHECK_OK(write_trace(file.trace, to));
  return std::move(file.notes);
}

}  // namespace forcegate
