#pragma once
// `forcegate characterize`: the procedures of Lebosse 2011 on a rig, the sensor's data sheet and model file.

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "hil/characterize/population_study.h"

namespace forcegate {

struct CharacterizeRequest {
  std::string plan = "characterize";  ///< file, or name of a plan in ci/plans; of it recordings take the limits, of "" none
  std::string rig = "emulated";
  std::map<std::string, std::string> rig_options;
  std::vector<std::string> sensors{"flexiforce", "fsr"};
  std::vector<std::filesystem::path> recordings;  ///< rig replay: instead of what the plan plays
  std::vector<std::string> specimens;             ///< instead of the plan's
  std::optional<int> sessions;
  std::optional<std::uint64_t> seed;
  std::filesystem::path output;  ///< folder for sheets, JSON, models; empty = none
  std::filesystem::path paper;   ///< folder for paper.md and pictures/paper/*.svg; empty = none
  std::filesystem::path golden;  ///< folder for golden traces; empty = none
  bool overwrite = false;        ///< files of the output folder that this command did not write
  unsigned threads = 0;
  std::string command_line;
};

struct Characterization {
  characterize::StudyPlan plan;
  std::vector<characterize::SensorStudy> studies;
  std::vector<std::filesystem::path> files;  ///< what was written, in order
  double rig_time_s = 0.0;
  std::uint64_t samples = 0;

  /// Of the first session that failed, an exemplar's last; nullptr: none did.
  const Error* first_failure() const;
};

/// Errors: those of the request (usage, also a foreign file in the output folder; config), of the machine (io), cancelled. Rig errors of single sessions are in
/// their sheets; when every session failed, the first one's error is returned.
Result<Characterization> characterize_request(
    const CharacterizeRequest& request, const std::function<void(double, std::string_view)>& progress = {},
    const std::atomic<bool>* cancelled = nullptr);

/// Model file of a sensor (docs/model.md) from a study: values are means, standard errors the spread between what
/// was measured. FSR: static law and one lag, ours (the paper gives no model of it).
Result<std::string> model_of_study(const characterize::SensorStudy& study);

/// Eq. (7) in double precision for force control in a study; the gate's conformance check ties the firmware to it.
characterize::Compensation oracle_compensation(const Calibration& calibration);

/// Calibration for `forcegate gate --cal`.
std::string calibration_text(const characterize::SessionSheet& sheet);

}  // namespace forcegate
