#pragma once
// One image under some cases of a plan and one seed, gated like any build; and what of it `forcegate power` counts.

#include <atomic>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "hil/app/files/resume_journal.h"
#include "hil/app/gate/gate.h"

namespace forcegate {

/// Of a decision.
struct Gated {
  DecisionKind kind = DecisionKind::no_decision;
  std::set<std::string> failed;  ///< required checks, without the case in their id
  bool conformance_known = false;
  DecisionKind blind = DecisionKind::no_decision;  ///< had no implementation of its algorithm been known
  std::string reason;
};

std::string to_json_line(const std::string& id, const Gated& gated);
/// Error (parse): not a line of to_json_line.
Result<Gated> gated_from_json(const std::string& line);

class PowerGatings {
 public:
  /// journal: file of the gatings done before, by the same program; empty = none is kept.
  static Result<PowerGatings> open(const std::vector<const Plan*>& plans,
                                   const std::filesystem::path& journal, unsigned threads,
                                   const std::atomic<bool>* cancelled);

  /// Plays the cases, or recalls what they gave. Calibrations of a plan and seed are measured once for all images.
  Result<Gated> gate(const Plan& plan, const std::filesystem::path& image, std::uint64_t seed,
                     const std::vector<std::string>& cases);
  /// Calibrations of this seed are needed no more.
  void forget_calibrations() { calibrations_.clear(); }

 private:
  Result<std::string> sha256(const std::filesystem::path& image);

  ResumeJournal journal_;
  unsigned threads_ = 0;
  const std::atomic<bool>* cancelled_ = nullptr;
  std::map<std::string, CalibrationCache> calibrations_;  ///< by plan and seed
  std::map<std::filesystem::path, std::string> sha256_;
  std::map<std::string, std::string> plans_;  ///< name -> digests of the plan and of its derived limits
};

}  // namespace forcegate
