#pragma once
// Sessions of an image on the frames of a pack, one sensor each, in watched children.

#include <map>
#include <string>
#include <vector>

#include "hil/app/play/watched_task.h"
#include "hil/characterize/capacitance/weight_gate.h"
#include "hil/interface/dut.h"

namespace forcegate {

/// Whose frames are played to which image, and how.
struct WeightSession {
  std::string id;  ///< "pack0-sensor3"
  std::string lane;
  std::map<std::string, std::string> lane_options;
  DutSession session;
  const characterize::SensorFrames* frames = nullptr;
  std::size_t frame_samples = 0;
};

struct WeightSessionAnswer {
  DutInfo firmware;
  DutCounters link;
  characterize::FrameAnswers answers;  ///< at the end of each frame
  std::string digest;                  ///< XXH3 over codes, forces and flags
};

/// In the order of the sessions. Errors: of lane and image (firmware, with signal and sample), cancelled.
std::vector<Result<WeightSessionAnswer>> run_weight_sessions(const std::vector<WeightSession>& sessions,
                                                             const WorkerOptions& options,
                                                             const WorkerEvents& events = {});

}  // namespace forcegate
