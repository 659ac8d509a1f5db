#pragma once
// `forcegate limits`: derive golden limits from the reference build over many other seeds.

#include "hil/app/gate/gate.h"
#include "hil/gate/limits.h"

namespace forcegate {

struct LimitsRequest {
  std::filesystem::path firmware;
  std::string plan = "smoke";                  ///< file, or name of a plan in ci/plans
  std::vector<std::string> only_cases;         ///< names; empty = all that need a derived limit
  std::vector<std::filesystem::path> records;  ///< recordings to judge on instead of an emulated rig
  std::string map;                             ///< names of their columns, COLUMN=NAME, one a line
  std::filesystem::path calibration_file;      ///< of the specimen in the recordings
  std::size_t n = 300;                         ///< specimens, each with its own session
  std::uint64_t first_seed = 1000;             ///< specimens "seed:1000", "seed:1001" ... : none of any panel
  unsigned threads = 0;
  std::string date;  ///< "2026-11-21", for the file
};

struct MadeLimits {
  DerivedLimits limits;
  std::vector<std::string> notes;  ///< why they may be no limits of a good build
};

/// derive_limit() of the judged errors of every open-loop case with the check `accuracy`. With recordings (at least
/// 5 of one profile on one bench: its repeatability run) each of them gives one value, under the case of the plan that
/// a gate of them would judge (`recording` of the plan `replay`). Errors: those of gate(); config when a record gave no value (the file would
/// claim too much).
/// A build that fails a check which no derived limit decides is noted: its errors are those of no known-good one.
Result<MadeLimits> derive_limits(const LimitsRequest& request, const GateProgress& progress = {},
                                 const std::atomic<bool>* cancelled = nullptr);

/// The text of the file, notes as comments above it.
std::string made_limits_text(const MadeLimits& made);
/// The same for programs.
std::string made_limits_json(const MadeLimits& made);

/// Asked before the work: a file that stands in force changes only with a reason. Errors: usage, where `output` exists and is the limits
/// file of `plan`, or lies beside the CHANGES.md that `forcegate bless` keeps.
Result<void> check_limits_output(const std::filesystem::path& output, const std::string& plan);

/// Whether a plan of that name names a file of derived limits, which `forcegate bless` writes.
bool takes_derived_limits(const std::string& plan);

}  // namespace forcegate
