#include "hil/app/recording/convert.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hil/trace/convert.h"

namespace forcegate {

Result<ConvertReport> convert(const ConvertRequest& request) {
  std::error_code ignored;
  if (std::filesystem::equivalent(request.from, request.to, ignored))
    return fail(ErrorCode::usage, "input and output are the same file", request.to.string(),
                "choose another name");
  if (std::filesystem::is_directory(request.to, ignored))
    return fail(ErrorCode::usage, "the output is a folder", request.to.string(), "name a file in it: " + (request.to / request.from.filename()).replace_extension(request.to.has_extension() ? request.to.extension() : ".csv").string());
  if (!request.overwrite && std::filesystem::exists(request.to, ignored))
    return fail(ErrorCode::usage, "the output exists already", request.to.string(),
                "add --force to replace it");
  FORCEGATE_TRY(const TraceFile file,
                read_trace(request.from, CsvOptions{request.column_map, request.assumed_rate_Hz}));
  const Trace* const only[] = {&file.trace};
  FORCEGATE_CHECK_OK(check_column_map(request.column_map, file.mapped, only, request.from));
  FORCEGATE_CHECK_OK(write_trace(file.trace, request.to));

  ConvertReport report;
  report.notes = file.notes;
  report.provenance = file.trace.provenance;
  for (const TimeBase& base : file.trace.time_bases)
    if (!base.t_s.empty())
      report.duration_s = std::max(report.duration_s, base.t_s.back() - base.t_s.front());
  for (const Channel& channel : file.trace.channels) {
    const TimeBase& base = file.trace.time_bases.at(channel.time_base);
    const auto missing =
        std::count_if(channel.value.begin(), channel.value.end(), [](double v) { return std::isnan(v); });
    report.channels.push_back({channel.name, channel.unit, base.device, channel.value.size(),
                               static_cast<std::size_t>(missing), base.gaps.size()});
  }
  return report;
}

}  // namespace forcegate
