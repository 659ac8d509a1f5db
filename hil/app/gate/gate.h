#pragma once
// `forcegate gate`: play a plan with a firmware image and decide.

#include <atomic>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "hil/base/result.h"
#include "hil/gate/plan.h"
#include "hil/interface/run_result.h"

namespace forcegate {

/// Calibrations by specimen and session that outlive one run, for several builds on one rig under one plan and seed.
struct CalibrationCache {
  std::map<std::pair<std::string, std::uint64_t>, Calibration> known;
};

struct GateRequest {
  std::filesystem::path firmware;
  std::string plan = "smoke";  ///< file, or name of a plan in ci/plans
  std::string lane;            ///< "": the one that accepts the image
  std::map<std::string, std::string> lane_options;
  std::string rig = "emulated";
  std::map<std::string, std::string> rig_options;  ///< replay: "record" = path
  std::optional<CalibrationLevel> level;           ///< overrides the plan
  std::filesystem::path
      limits_file;              ///< instead of the plan's, and of those its open-loop cases give themselves
  bool without_limits = false;  ///< measure only: limits are being derived
  bool makes_limits = false;    ///< they come of it: the plan's file of them need not be there yet
  std::filesystem::path calibration_file;  ///< used instead of a calibration on the rig
  std::optional<std::uint64_t> seed;
  /// Build to be no worse than: its image, played on the same rig in turn with the candidate, or the result of
  /// its run under the same plan and seed. Empty: nothing is compared.
  std::filesystem::path accepted;
  std::map<std::string, double> faults;
  std::vector<std::string> only_cases;  ///< names; empty = all
  std::vector<std::string> panel;       ///< overrides the plan's; empty = the plan's
  std::filesystem::path
      goldens;  ///< every case is held against the golden traces of this folder; empty: the plan decides
  std::filesystem::path waivers;  ///< file of waivers; empty = none
  std::string today;              ///< ISO date against which they expire; needed with waivers
  unsigned threads = 0;
  double hang_cpu_s = 10.0;                  ///< see WorkerOptions
  CalibrationCache* calibrations = nullptr;  ///< read and filled
  bool single_look = false;                  ///< no further sessions of what is undecided
  bool keep = false;                         ///< samples of every record, not only of those in doubt
  std::filesystem::path output;              ///< folder of the result; empty = none is written
  std::string command_line;                  ///< that repeats the run
  std::string started_at;                    ///< ISO 8601; the only wall-clock text of the result
};

/// fraction of the rig time of the whole run in [0, 1] and what is being done now.
using GateProgress = std::function<void(double fraction, std::string_view now)>;

/// Errors are those of the request (exit 2) and of the machine; everything that happens after the first
/// record is in the decision. A written folder appears whole or not at all; result.json is the last file in
/// it. Where it cannot be written, RunResult::not_written says why, and the samples that there is room for are kept.
Result<RunResult> gate(const GateRequest& request, const GateProgress& progress = {},
                       const std::atomic<bool>* cancelled = nullptr);

}  // namespace forcegate
