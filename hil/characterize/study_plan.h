#pragma once
// What a characterisation plays: ci/plans/characterize.toml. Every number has the paper's value as default.

#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "hil/base/result.h"

namespace forcegate::characterize {

struct SineSpec {
  double f_Hz = 0.5, A_N = 1.5, m_N = 2.7;
};

/// A bound that every session of every specimen must keep.
struct StudyLimit {
  std::string key;  ///< of a Measurement: "tms.noise"
  double minimum = -std::numeric_limits<double>::infinity(),
         maximum = std::numeric_limits<double>::infinity();
  std::string source;  ///< whose bound it is
  std::string where = {};  ///< file:line:column of its key
};

struct StudyPlan {
  std::string name, doc;
  std::filesystem::path path;
  std::uint64_t seed = 2011;

  // population
  std::vector<std::string> specimens;  ///< named ones, then seed:1 ... seed:count
  std::vector<std::string>
      identification;  ///< specimens whose records the laws are fitted to; the rest validates
  int sessions = 3;
  std::string exemplar = "q50";  ///< its session 0 gives the curves and golden traces; in no statistic

  std::vector<std::string> flexiforce, fsr;  ///< procedures in order
  std::vector<std::string> once;             ///< those that only session 0 of a specimen plays (long ones)

  double record_s = 1200.0;  ///< "time horizons of 20 min"
  double rest_s = 7200.0;    ///< before each record: "almost 2 h are necessary"
  double sweep_low_N = 0.3, sweep_high_N = 4.0, sweep_s = 60.0;
  int sweeps = 2;
  std::vector<SineSpec> harmonic;    ///< Table II
  std::vector<SineSpec> validation;  ///< the six independent sines (IV-A1c); the paper does not give them
  std::vector<double> two_sines_f1_Hz, two_sines_f2_Hz;  ///< Table III
  double two_sines_A_N = 0.6, two_sines_m_N = 2.4;       ///< each; ours
  double sweep_up_Hz = 3.0, sweep_A_N = 1.5, sweep_m_N = 2.7;
  double four_sines_m_N = 2.0;  ///< ours
  double prbs_Hz = 5.0, prbs_A_N = 1.6, prbs_m_N = 2.6;
  std::vector<double> recovery_s{300.0, 1200.0, 3600.0, 7200.0};
  double control_f_Hz = 0.5, control_A_N = 1.05, control_m_N = 2.15;  ///< 1.1 to 3.2 N
  std::vector<StudyLimit> limits;
  double learning_s =
      30.0;  ///< closed loop: extrema count from the end of the start window, at the latest here
};

/// Strict reader; errors (config) with file:line:column.
Result<StudyPlan> parse_study_plan(std::string_view text, const std::string& name);
Result<StudyPlan> read_study_plan(const std::filesystem::path& path);

}  // namespace forcegate::characterize
