#pragma once
// `forcegate report`: another view of a stored result, without running anything again.

#include <filesystem>
#include <string>
#include <vector>

#include "hil/base/result.h"
#include "hil/interface/run_result.h"

namespace forcegate {

struct ReportRequest {
  std::filesystem::path result;  ///< result.json, or the folder of a run that holds one
  std::string format = "console";
  std::filesystem::path output;  ///< "" = do not write, only give the text back
  bool colour = false;           ///< console only
  bool overwrite = false;        ///< a file at `output` that holds no such view
};

struct ReportAnswer {
  std::string text;
  RunResult result;
};

/// Names of the views, sorted.
std::vector<std::string> report_formats();

/// Reads, renders, writes (temporary file, then renamed). Errors: usage (no such view, with a suggestion; a foreign file at the output),
/// io, parse.
Result<ReportAnswer> render_report(const ReportRequest& request);

}  // namespace forcegate
