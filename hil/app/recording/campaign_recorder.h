#pragma once
// Records force profiles on a rig into a campaign folder (docs/campaign.md): one CSV each and campaign.json, without any
// firmware. What `forcegate record` does, and what `forcegate next --run` appends with.

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "hil/app/files/claimed_folder.h"
#include "hil/base/result.h"
#include "hil/gate/plan.h"

namespace forcegate {

struct ProfileToRecord {
  std::string name;
  StimulusSpec stimulus;
  double rest_before_s = 7200.0;
  std::size_t record = 0;  ///< number of the record in the list whose file is missing; 0: the next one
};

/// Where and on what.
struct RecordingBench {
  std::string rig = "emulated";
  std::map<std::string, std::string> rig_options;
  std::string specimen = "q50";
  std::uint64_t seed = 1, session = 1;
  double rate_Hz = 200.0;  ///< of the files, as asked: see rate_of_rows()
  SafetyLimits safety;
};

struct RecordedFile {
  std::string name, file;
  double duration_s = 0.0;
  std::uint64_t rows = 0;
  double rate_Hz = 0.0, rig_rate_Hz = 0.0;  ///< of the rows, and of the samples that they are means of
};

/// A row is the mean of a whole number of the rig's samples: the rate of rows that is nearest to the asked one, in samples a row.
double rate_of_rows(double rig_rate_Hz, double asked_Hz);

/// "r03_hold.csv"
std::string file_of_record(std::size_t number, const std::string& name);

using RecordingProgress = std::function<void(double fraction, std::string_view now)>;

/// Plays the profiles one after the other and writes them into `folder`, which must hold a campaign already (they are
/// appended to its campaign.json) or none. Record numbers and campaign time go on where the campaign ends;
/// a record that is listed already (ProfileToRecord::record) keeps its place, and on an emulated rig its time. An existing
/// file is never overwritten. Errors: those of the rig; usage when the rig cannot
/// move, or the folder holds recordings and no campaign.json.
Result<std::vector<RecordedFile>> record_profiles(const RecordingBench& bench,
                                                  const std::vector<ProfileToRecord>& profiles,
                                                  const ClaimedFolder& folder,
                                                  const RecordingProgress& progress = {},
                                                  const std::atomic<bool>* cancelled = nullptr);

}  // namespace forcegate
