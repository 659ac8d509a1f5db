#pragma once
// S8: pieces of rig time that a next experiment may be made of.

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "hil/diagnose/workspace.h"

namespace forcegate::diagnose {

/// Force at t between two levels of the campaign's range, N.
using ForceCourse = std::function<double(double t_s, double low_N, double high_N)>;

struct Segment {
  std::string name, stimulus;
  double minutes = 0.0;
  bool dynamic = false;
  std::map<std::string, double> numbers{};
  ForceCourse force;
  double temperature_C = 0.0;                 ///< ramp over the segment, when the rig can heat
  double jump_s = 0.0, jump_log_ratio = 0.0;  ///< where the frequency of its cycles changes, ln(f2/f1); 0: nowhere
};

/// `numbers` as played: "F_top_N" is the largest force, which goes with the campaign's range.
std::map<std::string, double> numbers_of(const Segment& segment, const RecordInput& played);

/// Twenty of them; each holds the base law down in its own way.
const std::vector<Segment>& segments();

/// A record of the segment as the campaign's next one, ten minutes behind the last; its output is the law's.
RecordInput simulate(const Workspace& workspace, const Segment& segment);

}  // namespace forcegate::diagnose
