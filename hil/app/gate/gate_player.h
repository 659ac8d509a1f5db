#pragma once
// Makes the records of a run: calibration of the specimens, the cases on them, and again what the rig spoiled.

#include <atomic>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "hil/app/gate/accepted_build.h"
#include "hil/app/gate/gate_jobs.h"
#include "hil/app/play/worker.h"
#include "hil/gate/run_judge.h"

namespace forcegate {

class GatePlayer {
 public:
  /// References must outlive the player.
  GatePlayer(const GateRequest& request, const GateSetup& setup, const DerivedLimits& limits,
             const GateProgress& progress, const std::atomic<bool>* cancelled);

  /// Level and values that hold for every specimen: nominal ones or those of the calibration file.
  void take_base_calibration();

  /// Every record is played with this image too, in turn; it must outlive the player.
  void set_accepted(const AcceptedBuild* build) { accepted_build_ = build; }
  /// Of the accepted image for a record of the candidate; null when there is none.
  const CaseRecord* accepted(const CaseJob& job) const;

  /// One record for each (case, index of its specimen), with a calibration of this session before them.
  void play(std::uint64_t session, const std::vector<std::pair<std::size_t, std::size_t>>& wanted,
            const std::filesystem::path& keep_folder);

  /// Whether anything may be played after what is played next: then the share of the run that is shown stays below 1.
  void expect_more(bool more) { ceiling_ = more ? 0.95 : 1.0; }

  /// Again with curves and kept samples, for those of the emulated rig that are in doubt.
  void keep(const std::vector<PlayedRecord*>& doubtful, const std::filesystem::path& folder);
  /// The shortest record a second time: does the firmware repeat itself?
  void try_one_again();
  /// Records that came out otherwise in a second play for which the firmware alone answers, each in words.
  const std::vector<std::string>& not_repeated() const { return not_repeated_; }

  std::vector<PlayedRecord>& records() { return records_; }
  const std::vector<std::string>& notes() const { return notes_; }
  CalibrationLevel level() const { return level_; }
  bool cancelled() const { return cancelled_ != nullptr && cancelled_->load(); }

 private:
  using Key = std::pair<std::string, std::uint64_t>;  ///< specimen, session
  void calibrate(std::uint64_t session, const std::vector<std::string>& specimens);
  std::vector<CaseRecord> run(const std::vector<CaseJob>& jobs);
  /// Whether it is the first one once more; what differs goes into notes or not_repeated.
  bool note_second_play(const CaseRecord& first, const CaseRecord& again);
  std::vector<CaseRecord> run_in_turn(const std::vector<CaseJob>& jobs);
  /// A second silence of the board at the sample of the first is the firmware's.
  void charge_silence(PlayedRecord& one) const;
  void add(PlayedRecord played, const std::filesystem::path& keep_folder, std::vector<PlayedRecord>& to_play);

  const GateRequest& request_;
  const GateSetup& setup_;
  const DerivedLimits& limits_;
  const GateProgress& progress_;
  const std::atomic<bool>* cancelled_;
  int attempts_;
  CalibrationLevel level_ = CalibrationLevel::nominal;
  Calibration base_;
  std::map<Key, Calibration> calibrations_;
  std::map<Key, CaseFailure> failures_;
  double planned_s_ = 0.0, done_s_ = 0.0;  ///< rig time
  double share_ = 0.0, ceiling_ = 1.0;     ///< of the run, as shown
  std::vector<PlayedRecord> records_;
  const AcceptedBuild* accepted_build_ = nullptr;
  std::map<std::string, CaseRecord> accepted_;  ///< by the candidate's id
  std::vector<std::string> notes_, not_repeated_;
};

}  // namespace forcegate
