// Repeatability (III-A): ten loads, each applied ten times (five staircases up and down); mean distance of a visit
// from the mean of its load, in newtons by eq. (1) over 5 N. The visits up and down differ by the hysteresis, as
// they do by hand. Steps are slow and dwells long enough to be quasi-static.

#include <array>
#include <cmath>
#include <vector>

#include "hil/characterize/session.h"

namespace forcegate::characterize {
namespace {

constexpr int kLoads = 10, kRounds = 5;
constexpr double kDwell_s = 6.0, kTransition_s = 1.5, kMeanOver_s = 2.0, kFullScale_N = 5.0;

Result<void> run(Session& s) {
  StimulusSpec stairs{
      "staircase", {{"dwell_s", kDwell_s}, {"transition_s", kTransition_s}, {"up_down", 0.0}}, {}, {}, 1};
  std::vector<int> load;  // of each dwell
  const double step_N = (s.plan.sweep_high_N - s.plan.sweep_low_N) / (kLoads - 1);
  for (int round = 0; round < kRounds; ++round)
    for (int k = 0; k < 2 * kLoads; ++k) load.push_back(k < kLoads ? k : 2 * kLoads - 1 - k);
  for (const int k : load) stairs.lists["levels_N"].push_back(s.plan.sweep_low_N + step_N * k);
  const double per_code = s.bench.volts_per_code();
  std::vector<double> sum(load.size(), 0.0), count(load.size(), 0.0);
  FORCEGATE_TRY(const PlayedRecord played,
                s.bench.play(stairs, [&](const RigBlock& b, std::size_t n, std::span<const float>) {
                  for (std::size_t i = 0; i < n; ++i) {
                    const auto visit = static_cast<std::size_t>(b.t_s[i] / kDwell_s);
                    const double since_s = b.t_s[i] - static_cast<double>(visit) * kDwell_s;
                    if (visit >= load.size() || since_s < kDwell_s - kMeanOver_s) continue;
                    sum[visit] += per_code * b.adc[i];
                    count[visit] += 1.0;
                  }
                }));
  (void)played;
  std::array<double, kLoads> mean_V{}, visits{};
  for (std::size_t v = 0; v < load.size(); ++v) {
    mean_V[static_cast<std::size_t>(load[v])] += sum[v] / count[v];
    visits[static_cast<std::size_t>(load[v])] += 1.0;
  }
  double error_N = 0.0;
  for (std::size_t v = 0; v < load.size(); ++v) {
    const auto k = static_cast<std::size_t>(load[v]);
    error_N += s.sheet.calibration.gain_N_per_V * std::abs(sum[v] / count[v] - mean_V[k] / visits[k]) /
               static_cast<double>(load.size());
  }
  s.add("static.repeatability", "Repeatability, ten times ten loads", "% FS", 100.0 * error_N / kFullScale_N);
  return {};
}

const Registration<ProcedureKind> kRow{
    {"repeatability", "Ten loads, each ten times: mean distance from the mean of the load (III-A, Table I)",
     true, run,
     always({"static.repeatability"})}};

}  // namespace
}  // namespace forcegate::characterize
