#include "hil/app/recording/split.h"

#include <algorithm>
#include <cctype>

#include "hil/base/output_path.h"
#include "hil/base/text.h"
#include "hil/trace/column_map.h"
#include "hil/trace/convert.h"
#include "hil/trace/part_column.h"

namespace forcegate {
namespace {

std::string in_a_file_name(std::string_view part) {
  std::string name(part);
  for (char& c : name)
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '.' && c != '-') c = '_';
  return name;
}

struct Written {
  TraceFile file;
  SplitPart part;
};

Result<std::vector<Written>> parts_of(const SplitRequest& request, const CsvTable& table, const PartColumn& column) {
  std::vector<Written> out;
  const CsvOptions options{request.column_map, request.assumed_rate_Hz};
  for (std::size_t p = 0; p < column.parts.size(); ++p) {
    const std::string name = request.from.stem().string() + "-" + in_a_file_name(column.parts[p]);
    FORCEGATE_TRY(TraceFile file, trace_of_table(rows_of_part(table, column, p), request.from.string(), name, options));
    const TimeBase& base = file.trace.time_bases.front();
    SplitPart part{column.parts[p], request.folder / (name + ".csv"), base.t_s.size(), base.t_s.empty() ? 0.0 : base.t_s.back() - base.t_s.front()};
    const auto same = [&](const Written& w) { return w.part.file == part.file; };
    if (std::ranges::any_of(out, same))
      return fail(ErrorCode::usage, "two values of column \"" + column.header + "\" would give the file " + part.file.string(),
                  request.from.string(), "give them names of letters and digits");
    std::error_code ignored;
    if (!request.overwrite && std::filesystem::exists(part.file, ignored))
      return fail(ErrorCode::usage, "the output exists already", part.file.string(), "add --force to replace it");
    out.push_back({std::move(file), std::move(part)});
  }
  return out;
}

}  // namespace

Result<SplitReport> split(const SplitRequest& request) {
  std::error_code failed;
  if (std::filesystem::exists(request.folder, failed) && !std::filesystem::is_directory(request.folder, failed))
    return fail(ErrorCode::usage, "--split writes several files, and this is no folder", request.folder.string(), "name a folder; it is made where there is none");
  for (const char* ending : {".h5", ".hdf5", ".mat", ".fgj"})
    if (ascii_lower(request.from.extension().string()) == ending)
      return fail(ErrorCode::usage, "--split reads tables of text", request.from.string(),
                  "convert it to CSV first: forcegate convert " + file_quoted(request.from.string()) + " table.csv");
  FORCEGATE_TRY(const CsvTable table, read_csv_table(request.from));
  FORCEGATE_TRY(const PartColumn column, part_column(table, request.column, request.from.string()));
  FORCEGATE_TRY(const std::vector<Written> parts, parts_of(request, table, column));
  for (const Written& w : parts) {
    const Trace* const only[] = {&w.file.trace};
    FORCEGATE_CHECK_OK(check_column_map(request.column_map, w.file.mapped, only, request.from));
  }
  FORCEGATE_CHECK_OK(output_path(request.folder));
  std::filesystem::create_directories(request.folder, failed);
  if (failed) return fail(ErrorCode::io, "the folder cannot be created: " + failed.message(), request.folder.string(), "choose a place you may write to");

  SplitReport report;
  report.take_turns = column.changes >= 2 * column.parts.size();
  const auto in_all = [&](const std::string& note) {
    return std::ranges::all_of(parts, [&](const Written& w) { return std::ranges::find(w.file.notes, note) != w.file.notes.end(); });
  };
  for (const Written& w : parts) {
    FORCEGATE_CHECK_OK(write_trace(w.file.trace, w.part.file));
    report.parts.push_back(w.part);
    for (const std::string& note : w.file.notes) {
      const std::string told = in_all(note) ? note : w.part.part + ": " + note;
      if (std::ranges::find(report.notes, told) == report.notes.end()) report.notes.push_back(told);
    }
  }
  return report;
}

}  // namespace forcegate
