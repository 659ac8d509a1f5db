#pragma once
// The experiments of Paredes-Madrid 2010 on a bench of weights: frequency sweeps (section V), then loadings from which the
// four force models and ours learn, and loadings on which they are tested (section VI).

#include <array>
#include <atomic>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "hil/characterize/capacitance/weight_plan.h"
#include "hil/interface/weight_bench.h"
#include "hil/model/impedance/bode_fit.h"
#include "hil/model/impedance/force_models.h"

namespace forcegate::characterize {

/// Conductance; capacitance; their mean; network; and ours.
inline constexpr std::size_t kForceModels = 5;
inline constexpr std::array<std::string_view, kForceModels> kForceModelNames{
    "conductance", "capacitance", "mean of both", "network 2-2-1", "two variables (ours)"};

/// A sweep at one force, with what the bench knows if it is an emulated one (NaN on others).
struct SweepResult {
  double force_N = 0;
  std::vector<impedance::RcReading> readings;
  bool fitted = false;
  impedance::BodeFit fit;
  double true_conductance_S = 0, true_capacitance_F = 0, true_divergence_Hz = 0;
  std::size_t flagged_inside = 0, inside = 0;  ///< readings 1 kHz ... 0.4 divergence that were said to depart
  std::size_t flagged_outside = 0, outside = 0;  ///< readings above 1.5 divergence
};

struct SensorResult {
  std::array<double, kForceModels> mse_N2{};  ///< on the test loadings, models of plan.training loadings
  std::array<double, kForceModels> unloading_mse_N2{};  ///< on the way down of one more test loading
  std::vector<double> network_mse_N2, ours_mse_N2,
      conductance_mse_N2;               ///< for 1, 2 ... most_training loadings; NaN where not possible
  double per_pct = 0;                   ///< eq. (11)
  std::size_t covered = 0, tested = 0;  ///< test readings within the 95 % interval of ours
  double u_mean_N = 0;                  ///< mean standard uncertainty stated by ours
  std::vector<SweepResult> sweeps;
};

struct SetResult {
  std::size_t set = 0;
  std::vector<SensorResult> sensors;
  double operating_Hz = 0;
  double per_mean_pct() const;
};

/// What the pictures need of one sensor of pack 0.
struct WeightExemplar {
  std::vector<impedance::ForceReading> training, testing;
  impedance::Network network;
};

struct WeightStudy {
  WeightPlan plan;
  WeightBenchInfo bench;
  std::vector<SetResult> sets;  ///< 1 ... plan.sets
  SetResult exemplar_set;       ///< pack 0
  std::vector<WeightExemplar> exemplar;
  double bench_time_s = 0;
  std::uint64_t samples = 0;
};

struct WeightStudyRequest {
  WeightPlan plan;
  std::function<Result<std::unique_ptr<WeightBench>>()> make_bench;
  unsigned threads = 0;
  std::function<void(double fraction, std::string_view now)> progress;
  const std::atomic<bool>* cancelled = nullptr;
};

/// Seed from which run_weight_study trains a sensor's network on `loadings` loadings.
std::uint64_t network_seed(const WeightPlan& plan, std::size_t set, std::size_t sensor, std::size_t loadings);

/// The same answer whatever the number of threads. Errors: those of the bench, of a fit, cancelled.
Result<WeightStudy> run_weight_study(const WeightStudyRequest& request);

/// Readings of every sensor on a staircase of one loading: [sensor][level]. The bench must stand at 0 N after begin().
/// `down`: also on the way back, appended. Errors: of the bench; a saturated reading (device).
Result<std::vector<std::vector<impedance::ForceReading>>> play_loading(WeightBench& bench,
                                                                       const WeightPlan& plan,
                                                                       bool down = false);

}  // namespace forcegate::characterize
