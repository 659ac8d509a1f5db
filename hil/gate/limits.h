#pragma once
// Derived limits: what the reference build shows over many other seeds, kept in golden/limits/*.toml with n,
// date and rig version. Never called the paper's.

#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "hil/base/result.h"
#include "hil/interface/check.h"
#include "hil/interface/rig.h"

namespace forcegate {

struct DerivedLimit {
  double p99_upper = 0.0;  ///< value that the quantile 0.99 exceeds with probability 5 %; below n = 299 the largest one
  double sd = 0.0;         ///< standard deviation of the values, not below the uncertainty of one; of few plays of one specimen their sum
  double value = 0.0;      ///< the limit: p99_upper + 2 sd, so that a good record is not refused by chance
  std::string unit;
  std::uint64_t n = 0;
};

/// The limit after `values` of a known-good build, none of them NaN. The point estimate of p99 will not do: of 300
/// heavy-tailed values it lies too low as often as too high.
DerivedLimit derive_limit(const std::vector<double>& values, double sd, std::string unit);

struct DerivedLimits {
  std::string plan, firmware_sha256, rig, date;
  std::map<std::pair<std::string, std::string>, DerivedLimit> by_case_and_check;

  /// Whether they were derived on this rig, by name, version and, where they name one, id. Of limits that name no rig: yes.
  bool of_rig(const RigInfo& rig) const;

  /// Kind none when there is no limit for this case and check.
  Limit find(const std::string& case_name, const std::string& check_id) const;
};

Result<DerivedLimits> read_limits(const std::filesystem::path& path);
/// The file's text; the same limits give the same bytes.
std::string write_limits(const DerivedLimits& limits);
/// The same for programs.
std::string limits_json(const DerivedLimits& limits);

}  // namespace forcegate
