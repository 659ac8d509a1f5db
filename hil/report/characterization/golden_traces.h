#pragma once
// Golden traces of the paper's procedures on the exemplar, as text that a reviewer can read in a diff: extrema of every
// record (at most 40 of each kind) and the waveform of the step. A file is a CSV whose leading comment lines are, without
// their "# ", a TOML table with provenance and tolerance:
//
//   # format = 1
//   # name = "flexiforce_series_04"
//   # unit = "V"
//   # absolute = 0.01
//   # relative = 0.002
//   # plan = "characterize"  ...
//   row,t_s,maximum,minimum

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "hil/base/result.h"
#include "hil/characterize/population_study.h"

namespace forcegate {

struct GoldenTrace {
  std::string name, unit;
  double absolute = 0.0, relative = 0.0;  ///< tube around each column but the time
  std::map<std::string, std::string> provenance;
  characterize::Curve curve;  ///< first column "t_s"
};

/// Traces of the exemplar of a study, in the order in which they were played.
std::vector<GoldenTrace> golden_traces(const characterize::SensorStudy& study,
                                       const characterize::StudyPlan& plan);

std::string golden_text(const GoldenTrace& trace);

/// Errors (parse, config) name file and line.
Result<GoldenTrace> parse_golden(std::string_view text, const std::string& name);

}  // namespace forcegate
