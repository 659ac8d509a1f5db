#pragma once
// Waivers and quarantine: a finding that somebody answers for, until a day. The record is played and shown as ever; the
// check reads `waived`, never `pass`. A waiver past its day fails.
//
//   format = 1
//   [[waiver]]
//   case = "four_sines"            # or "*"
//   specimen = "q95"               # default "*"
//   check = "mre_minima"           # or "*": the whole case is in quarantine
//   owner = "A. Smith"
//   reason = "new film, limit under review"
//   expires = "2026-12-31"         # last day on which it holds

#include <filesystem>
#include <string>
#include <vector>

#include "hil/base/result.h"
#include "hil/gate/run_judge.h"

namespace forcegate {

struct Waiver {
  std::string case_name = "*", specimen = "*", check = "*";
  std::string owner, reason;
  std::string expires;  ///< ISO date
  std::string where;    ///< position in the file
};

/// Errors (config): owner, reason or expiry missing, a date that is none, a waiver that would waive everything.
Result<std::vector<Waiver>> read_waivers(const std::filesystem::path& path);

/// To the judged run (verdicts final). What may be waived: fail, marginal, inconclusive, not_run of a required check; never
/// rig_error, a safety stop or whether the firmware answers. `today` is an ISO date given by the caller, the only use of a
/// calendar in a verdict; it is stated in the notes. An expired waiver waives nothing and adds a failed check of the run,
/// blamed on the user. Waivers that met nothing are noted.
/// `all` are the checks of run and records, see all_checks().
void apply_waivers(const std::vector<Waiver>& waivers, const std::string& today,
                   std::vector<JudgedCheck>& of_run, const std::vector<JudgedCheck*>& all,
                   std::vector<std::string>& notes);
void apply_waivers(const std::vector<Waiver>& waivers, const std::string& today,
                   std::vector<JudgedCheck>& of_run, std::vector<PlayedRecord>& records,
                   std::vector<std::string>& notes);

}  // namespace forcegate
