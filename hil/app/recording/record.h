#pragma once
// `forcegate record`: a campaign of one specimen on a rig, from the profiles of a plan.

#include "hil/app/recording/campaign_recorder.h"

namespace forcegate {

struct RecordRequest {
  std::string plan = "campaign";        ///< file, or name of a plan in ci/plans
  std::vector<std::string> only_cases;  ///< names; empty: all
  RecordingBench bench;
  std::filesystem::path output;
  bool go_on = false;  ///< the output holds the first records of this very campaign: record the others
};

struct RecordResult {
  std::filesystem::path folder;
  std::vector<RecordedFile> files;
  std::size_t were_there = 0;  ///< records of the campaign that go_on found
  double rig_minutes = 0.0;  ///< rests not counted
  std::vector<std::string> notes;  ///< rows at another rate than asked
};

/// Refuses a folder that holds a campaign already, but see RecordRequest::go_on. An error tells what is kept and how to go on.
Result<RecordResult> record(const RecordRequest& request, const RecordingProgress& progress = {},
                            const std::atomic<bool>* cancelled = nullptr);
std::string record_json(const RecordResult& result);

}  // namespace forcegate
