#include "hil/app/stored/report.h"

#include "hil/app/files/own_file.h"
#include "hil/app/files/write_file.h"
#include "hil/app/gate/bundle.h"
#include "hil/base/text.h"
#include "hil/interface/reporter.h"
#include "hil/report/console.h"

namespace forcegate {

namespace {

// What the first lines of every view hold, and hardly anybody else's.
std::string_view mark_of(const std::string& format) {
  if (format == "html") return kMarkOfPage;
  if (format == "json") return "\"tool_version\"";
  if (format == "junit") return "<testsuites name=\"forcegate";
  if (format == "markdown") return ". Firmware `";
  if (format == "github") return " title=forcegate";
  return "\n  firmware ";
}

}  // namespace

std::vector<std::string> report_formats() { return Registry<ReporterKind>::instance().names(); }

Result<ReportAnswer> render_report(const ReportRequest& request) {
  const ReporterKind* kind = Registry<ReporterKind>::instance().find(request.format);
  if (kind == nullptr) {
    const std::vector<std::string> names = report_formats();
    const std::string near = nearest_name(request.format, names);
    return fail(ErrorCode::usage, "there is no report format '" + printable_utf8(request.format) + "'", {},
                near.empty() ? "choose one of: " + join(names, ", ") : "did you mean '" + near + "'?");
  }
  if (!request.overwrite) FORCEGATE_CHECK_OK(check_own_file(request.output, mark_of(kind->name)));
  FORCEGATE_TRY(RunResult result, read_run(request.result));
  const bool painted = request.colour && kind->name == "console" && request.output.empty();
  ReportAnswer answer{painted ? render_console(result, {.colour = true}) : kind->render(result), {}};
  answer.result = std::move(result);
  if (!request.output.empty()) FORCEGATE_CHECK_OK(write_file_atomically(request.output, answer.text));
  return answer;
}

}  // namespace forcegate
