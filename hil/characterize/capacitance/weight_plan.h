#pragma once
// What a study of conductance and capacitance plays: ci/plans/capacitance.toml. Defaults are those of Paredes-Madrid 2010
// where it gives them.

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "hil/base/result.h"

namespace forcegate::characterize {

struct WeightPlan {
  std::string name, doc;
  std::filesystem::path path;
  std::uint64_t seed = 2010;
  std::size_t sets = 32;

  double step_N = 5.0, force_max_N = 250.0, hold_s = 20.0, rest_s = 7200.0;
  std::size_t training = 3, most_training = 6, testing = 3;

  double dc_V = -5.0, sine_V = 3.0, sine_Hz = 4000.0;
  std::size_t dc_samples = 6400, sine_samples = 1600;

  double sweep_V = 0.5, sweep_low_Hz = 100.0, sweep_high_Hz = 40000.0;
  std::vector<double> sweep_forces_N{50.0, 125.0, 250.0};
  std::size_t sweep_points = 60, sweep_samples = 6400;
};

/// "capacitance", "characterize" or what else the plan says it is; errors (config): no file, no such key.
Result<std::string> plan_kind(const std::filesystem::path& path);

/// Strict reader; errors (config) with file:line:column.
Result<WeightPlan> parse_weight_plan(std::string_view text, const std::string& name);
Result<WeightPlan> read_weight_plan(const std::filesystem::path& path);

}  // namespace forcegate::characterize
