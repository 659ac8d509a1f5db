#pragma once
// `forcegate next --run`: plays the segments that `next` chose, appends them to a copy of the campaign, and diagnoses again.

#include <atomic>
#include <optional>

#include "hil/app/diagnose/next.h"
#include "hil/app/recording/recorded_bench.h"

namespace forcegate {

struct NextRunRequest {
  CampaignRequest campaign;
  GivenBench bench;                             ///< rig "replay": segments are picked from `recorded`
  std::vector<std::string> named;               ///< options that ask for a rig or a sensor: "--seed"
  std::vector<std::filesystem::path> recorded;  ///< CSV files
  std::filesystem::path output;  ///< new campaign; empty: beside the old one with "-next" behind its name
};

/// How far a segment parted its rivals; logarithms are natural, of the first rival against the second.
struct SegmentOdds {
  std::string segment, rivals, file;
  double log_before = 0.0;
  double expected = 1.0;            ///< odds of the better rival
  bool stated = true;               ///< all three are odds of probabilities; else of the evidence alone
  std::optional<double> log_after;  ///< nothing: both are found
  std::string leads;                ///< the rival that the new data favour
};

struct NextRunResult {
  std::filesystem::path folder;
  NextExperiment planned;
  std::vector<SegmentOdds> segments;
  std::vector<std::string> skipped;  ///< with the reason
  bool on_stock_sensor = false;      ///< played on the emulated rig, whose sensor need not be that of the campaign
  Diagnosis before, after;
};

/// Nothing of the old campaign is changed or overwritten; records that its description lists in subfolders are copied, those outside of its folder named
/// where they are. Errors: those of the diagnosis and of the rig; usage when what is asked for contradicts what campaign.json says of the rig, or
/// names a bench for a mystery, and when the output holds anything but forces to record and the recordings of this run. Where no segment is planned, nothing is played and no folder made. After an error the new folder is gone but for the forces to record, and for what a rig has played.
Result<NextRunResult> next_run(const NextRunRequest& request, const RecordingProgress& progress = {},
                               const std::atomic<bool>* cancelled = nullptr);

/// Whether a rig that cannot heat has anything to play.
bool is_playable(const NextExperiment& planned);

/// Writes the forces of the planned segments into FOLDER/profiles as columns t_s, F_ref_N, for who records them by hand. The folder may
/// then be the output of next_run. Errors: usage when the folder holds anything else; io.
Result<std::vector<std::filesystem::path>> write_profiles(const NextExperiment& planned, const std::filesystem::path& folder);
/// Where the new campaign goes when nobody says: "m7-next" beside "m7".
std::filesystem::path next_folder(const std::filesystem::path& campaign);

std::string next_run_text(const NextRunResult& result);
std::string next_run_json(const NextRunResult& result);

}  // namespace forcegate
