#pragma once
// `forcegate diff RUN_A RUN_B`: two builds (or two days) paired by case and check, with the uncertainty of each difference.

#include <filesystem>
#include <string>
#include <vector>

#include "hil/base/result.h"
#include "hil/interface/run_result.h"

namespace forcegate {

struct CheckDelta {
  std::string case_id, check_id, unit;
  double a = 0.0, b = 0.0;
  double delta = 0.0;  ///< b - a
  double u = 0.0;      ///< root of the sum of both squares: an upper bound when both ran on one rig
  Verdict verdict_a = Verdict::not_run, verdict_b = Verdict::not_run;
  bool limited = false;  ///< B held its value against a limit
};

/// All cases of one check together. Pairs share profile, specimen and seed, so what is common to both drops out: the
/// standard error comes from the spread of the differences, Student with n - 1.
struct CheckSummary {
  std::string check_id, unit;
  std::size_t n = 0;
  double mean_delta = 0.0, u = 0.0;
  double low = 0.0, high = 0.0;  ///< 95.45 % interval; NaN below two pairs
  std::string in_words;          ///< "better", "worse", "no difference shown"
};

/// A required check that did not pass and that the other run does not have: firmware_runs of a build that crashed.
struct OneSided {
  std::string case_id, check_id;
  Verdict verdict = Verdict::not_run;
  bool in_b = false;
  std::string evidence;
};

struct RunDiff {
  RunResult a, b;
  bool same_conditions = false;          ///< plan, seed, rig, its faults and options, version and calibrations agree
  std::vector<std::string> differences;  ///< of the conditions
  std::vector<CheckDelta>
      checks;  ///< pairs whose values or verdicts differ, largest share of their limit first
  std::vector<OneSided> failures;
  std::vector<CheckSummary> summary;
  std::vector<std::string> only_in_a, only_in_b;  ///< cases without a partner
};

/// Arguments are folders of runs or result.json files.
Result<RunDiff> diff_runs(const std::filesystem::path& a, const std::filesystem::path& b);
std::string diff_text(const RunDiff& diff);
std::string diff_json(const RunDiff& diff);

}  // namespace forcegate
