#pragma once
// S8: pieces of rig time that a next experiment may be made of.

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "hil/diagnose/workspace.h"
#include "hil/interface/stimulus.h"

namespace forcegate::diagnose {

/// Force at t between two levels of the campaign's range, N.
using ForceCourse = std::function<double(double t_s, double low_N, double high_N)>;

/// The same force as a profile of stimuli/ takes it; without a name where none of them plays it.
using Parameters = std::function<StimulusSpec(double low_N, double high_N)>;

struct Segment {
  std::string name;
  std::string kind;  ///< of the record, as a campaign's description calls it
  double minutes = 0.0;
  bool dynamic = false;
  double f_min_Hz = 0.0;  ///< lowest frequency of its cycles; 0: not cyclic
  Parameters parameters{};
  ForceCourse force;
  double temperature_C = 0.0;                 ///< ramp over the segment, when the rig can heat
  double jump_s = 0.0, jump_log_ratio = 0.0;  ///< where the frequency of its cycles changes, ln(f2/f1); 0: nowhere
};

/// What `forcegate stimulus` plays it by, between two levels of the campaign; "replay" of a file where no profile is this force.
StimulusSpec stimulus_of(const Workspace& workspace, const Segment& segment);

/// Twenty of them; each holds the base law down in its own way.
const std::vector<Segment>& segments();

/// Whether a record of this name is one that `forcegate next --run` made of the segment: "r10_fast_edges".
bool is_record_of(std::string_view record, const Segment& segment);

/// A record of the segment as the campaign's next one, ten minutes behind the last; its output is the law's.
RecordInput simulate(const Workspace& workspace, const Segment& segment);

}  // namespace forcegate::diagnose
