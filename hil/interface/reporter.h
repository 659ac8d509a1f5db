#pragma once

#include <functional>
#include <string>

#include "hil/base/registry.h"
#include "hil/base/result.h"
#include "hil/interface/run_result.h"

namespace forcegate {

/// Registry entry of a view of a run: a pure function from the result to text.
struct ReporterKind {
  std::string name;       ///< "console", "json", "junit", "markdown", "html"
  std::string file_name;  ///< "result.json"; "" = not written to a file
  std::string doc;
  std::function<std::string(const RunResult&)> render;
};

}  // namespace forcegate
