#pragma once
// Judging a firmware that reads conductance and capacitance (Paredes-Madrid 2010, VI): the frames that it is fed, what a
// network in double precision makes of them, and the checks.

#include <string>
#include <string_view>
#include <vector>

#include "hil/characterize/capacitance/weight_study.h"
#include "hil/gate/rule.h"

namespace forcegate::characterize {

inline constexpr const char* kWeightGateKind = "capacitance-gate";  ///< of a plan

struct WeightGatePlan {
  std::string name, doc, sha256;
  std::filesystem::path path;
  WeightPlan study;  ///< training loadings, sources, steps
  std::size_t pack = 0;
  std::uint64_t first_loading = 1000;
  std::size_t loadings = 3;
  double rate_Hz = 40000.0;
  std::size_t direct_samples = 600, sine_samples = 200;
  double overdrive_V = 12.0;
  double conformance_N = 0.005, sensor_mse_N2 = 2.01, pack_mse_N2 = 0.515, pack_per_pct = 39.7;
  double loss_pct = 0.5;  ///< of error reduction against an accepted build, percentage points
  std::string goldens;    ///< folder of the golden traces beside the plan; "" = none are compared
  std::size_t frame_samples() const { return direct_samples + sine_samples; }
  double frame_end_s(std::size_t frame) const {
    return static_cast<double>((frame + 1) * frame_samples()) / rate_Hz;
  }
  DecisionRule rule;
};

/// Strict reader; the study's plan is sought beside this one, unless `study` names it. Errors (config) with
/// file:line:column.
Result<WeightGatePlan> read_weight_gate_plan(const std::filesystem::path& path,
                                             const std::filesystem::path& study = {});

/// Everything that one sensor's firmware instance is fed, frame by frame: direct samples, then those of the sine, as codes
/// with 2^(bits-1) for 0 V; the last two frames are an overdriven and a sound one at full force.
struct SensorFrames {
  std::vector<std::uint16_t> codes;
  std::vector<double> force_N;        ///< of the weights, one a frame
  std::vector<double> oracle_N;       ///< the network in double precision; NaN for the overdriven frame
  std::vector<double> conductance_N;  ///< the one-variable model of the same training
  std::vector<std::size_t> loading;   ///< number of the loading; plan.loadings for the last two frames
};

struct PackFrames {
  WeightBenchInfo bench;
  std::vector<SensorFrames> sensors;
};

/// Trains on the study's loadings and plays the gate's. `make_bench` takes the converter's rate. Errors: of bench and fits.
Result<PackFrames> play_pack(
    const WeightGatePlan& plan,
    const std::function<Result<std::unique_ptr<WeightBench>>(double rate_Hz)>& make_bench);

/// What a firmware answered at the end of each frame.
struct FrameAnswers {
  std::vector<double> force_N;
  std::vector<std::uint8_t> flags;
};

/// Mean squared errors of an estimate of every frame against the weights, loading by loading.
std::vector<double> squared_error_by_loading_N2(const WeightGatePlan& plan, const SensorFrames& frames,
                                                const std::vector<double>& estimate_N);

/// Checks of one sensor, and of the pack (of each sensor its frames and answers); `case_id` names the sensor. Not judged
/// yet (see apply_rule), but for rig_network, and for the pack where the network in double precision itself misses a limit:
/// those are rig_error.
std::vector<JudgedCheck> judge_sensor(const WeightGatePlan& plan, const SensorFrames& frames,
                                      const FrameAnswers& answers, const std::string& case_id);
std::vector<JudgedCheck> judge_pack(const WeightGatePlan& plan,
                                    const std::vector<const SensorFrames*>& frames,
                                    const std::vector<const FrameAnswers*>& answers);

}  // namespace forcegate::characterize
