#include "hil/characterize/capacitance/weight_study.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <mutex>

#include "hil/base/parallel.h"
#include "hil/base/rng.h"
#include "hil/characterize/capacitance/weight_sweep.h"
#include "hil/gate/statistics.h"
#include "hil/model/impedance/two_variable.h"

namespace forcegate::characterize {
namespace {

using impedance::ForceReading;
using Loading = std::vector<ForceReading>;
using SensorLoadings = std::vector<std::vector<Loading>>;  // [sensor][loading]

constexpr double kCoverage = 0.95;
constexpr std::uint64_t kSweepLoading = 0, kFirstLoading = 1;

std::vector<ForceReading> joined(const std::vector<Loading>& loadings, std::size_t first, std::size_t n) {
  std::vector<ForceReading> out;
  for (std::size_t i = first; i < first + n; ++i)
    out.insert(out.end(), loadings[i].begin(), loadings[i].end());
  return out;
}

struct Models {
  impedance::LineModel by_g, by_c;
  impedance::Network network;
};

Result<Models> learn(const std::vector<ForceReading>& training, std::uint64_t seed) {
  Models m{impedance::fit_conductance(training), impedance::fit_capacitance(training), {}};
  FORCEGATE_TRY(m.network, impedance::train_network(training, seed));
  return m;
}

std::array<double, kForceModels> errors_of(const Models& m, const impedance::TwoVariableModel& ours,
                                           const std::vector<ForceReading>& test) {
  const auto by_g = [&](const ForceReading& r) { return m.by_g.force_N(r.output_V); };
  const auto by_c = [&](const ForceReading& r) { return m.by_c.force_N(r.capacitance_F); };
  return {impedance::mean_squared_error_N2(test, by_g), impedance::mean_squared_error_N2(test, by_c),
          impedance::mean_squared_error_N2(test,
                                           [&](const ForceReading& r) { return 0.5 * (by_g(r) + by_c(r)); }),
          impedance::mean_squared_error_N2(
              test, [&](const ForceReading& r) { return m.network.force_N(r.output_V, r.capacitance_F); }),
          impedance::mean_squared_error_N2(test, [&](const ForceReading& r) {
            return ours.estimate(r.output_V, r.capacitance_F).force_N;
          })};
}

class SetRun {
 public:
  SetRun(const WeightStudyRequest& request, std::size_t set)
      : request_(request), plan_(request.plan), set_(set) {}

  Result<void> run() {
    FORCEGATE_TRY(bench_, request_.make_bench());
    result.set = set_;
    result.sensors.resize(bench_->info().sensors);
    FORCEGATE_CHECK_OK(sweeps());
    FORCEGATE_CHECK_OK(loadings());
    return models();
  }

  SetResult result;
  std::vector<WeightExemplar> exemplar;
  std::uint64_t samples = 0;
  double time_s = 0;

 private:
  Result<void> begin(std::uint64_t loading) {
    if (request_.cancelled != nullptr && request_.cancelled->load(std::memory_order_relaxed))
      return fail(ErrorCode::cancelled, "interrupted");
    time_s += plan_.rest_s;
    return bench_->begin({plan_.seed, set_, loading, plan_.rest_s});
  }

  Result<void> sweeps() {
    FORCEGATE_CHECK_OK(begin(kSweepLoading));
    std::vector<impedance::BodeFit> fits;
    std::vector<std::vector<impedance::RcReading>> readings;
    for (const double force_N : plan_.sweep_forces_N) {
      FORCEGATE_CHECK_OK(bench_->load(force_N, plan_.hold_s));
      for (std::size_t s = 0; s < result.sensors.size(); ++s) {
        FORCEGATE_TRY(SweepResult sweep, play_sweep(*bench_, s, force_N, plan_));
        samples += plan_.sweep_samples * sweep.readings.size();
        if (sweep.fitted) fits.push_back(sweep.fit);
        readings.push_back(sweep.readings);
        result.sensors[s].sweeps.push_back(std::move(sweep));
      }
    }
    result.operating_Hz = impedance::operating_frequency_Hz(fits, readings);
    return {};
  }

  Result<void> loadings() {
    const std::size_t n = plan_.most_training + plan_.testing;
    readings_.assign(result.sensors.size(), {});
    for (std::size_t l = 0; l <= n; ++l) {
      const bool down = l == n;
      FORCEGATE_CHECK_OK(begin(kFirstLoading + l));
      FORCEGATE_TRY(auto made, play_loading(*bench_, plan_, down));
      for (std::size_t s = 0; s < made.size(); ++s) {
        samples += made[s].size() * (plan_.dc_samples + plan_.sine_samples);
        readings_[s].push_back(
            down ? Loading(made[s].begin() + static_cast<std::ptrdiff_t>(made[s].size() / 2), made[s].end())
                 : std::move(made[s]));
      }
      time_s += plan_.hold_s * std::floor(plan_.force_max_N / plan_.step_N) * (down ? 2.0 : 1.0);
    }
    return {};
  }

  Result<std::vector<impedance::TwoVariableModel>> ours_of(std::size_t n) const {
    SensorLoadings training;
    for (const auto& own : readings_)
      training.emplace_back(own.begin(), own.begin() + static_cast<std::ptrdiff_t>(n));
    return impedance::fit_two_variable(training);
  }

  Result<void> models() {
    for (std::size_t n = 1; n <= plan_.most_training; ++n) {
      std::vector<impedance::TwoVariableModel> ours;
      if (n >= 2) {
        FORCEGATE_TRY(ours, ours_of(n));
      }
      for (std::size_t s = 0; s < readings_.size(); ++s)
        FORCEGATE_CHECK_OK(judge(s, n, ours.empty() ? nullptr : &ours[s]));
    }
    return {};
  }

  Result<void> judge(std::size_t s, std::size_t n, const impedance::TwoVariableModel* ours) {
    SensorResult& out = result.sensors[s];
    const auto training = joined(readings_[s], 0, n),
               test = joined(readings_[s], plan_.most_training, plan_.testing);
    FORCEGATE_TRY(const Models m, learn(training, network_seed(plan_, set_, s, n)));
    const auto errors = errors_of(m, ours != nullptr ? *ours : impedance::TwoVariableModel{}, test);
    out.conductance_mse_N2.push_back(errors[0]);
    out.network_mse_N2.push_back(errors[3]);
    out.ours_mse_N2.push_back(ours != nullptr ? errors[4] : std::nan(""));
    if (n != plan_.training) return {};
    out.mse_N2 = errors;
    out.unloading_mse_N2 = errors_of(m, *ours, readings_[s].back());
    out.per_pct = impedance::error_reduction_pct(errors[3], errors[0]);
    const double k = coverage_factor(kCoverage, ours->dof());
    for (const ForceReading& r : test) {
      const auto e = ours->estimate(r.output_V, r.capacitance_F);
      out.covered += std::abs(e.force_N - r.force_N) <= k * e.u_N ? 1 : 0;
      out.u_mean_N += e.u_N / static_cast<double>(test.size());
    }
    out.tested = test.size();
    if (set_ == 0) exemplar.push_back({training, test, m.network});
    return {};
  }

  const WeightStudyRequest& request_;
  const WeightPlan& plan_;
  std::size_t set_;
  std::unique_ptr<WeightBench> bench_;
  SensorLoadings readings_;
};

}  // namespace

double SetResult::per_mean_pct() const {
  double sum = 0.0;
  for (const SensorResult& s : sensors) sum += s.per_pct;
  return sum / static_cast<double>(sensors.size());
}

Result<std::vector<std::vector<ForceReading>>> play_loading(WeightBench& bench, const WeightPlan& plan,
                                                            bool down) {
  const WeightBenchInfo info = bench.info();
  const impedance::Circuit circuit{info.feedback_ohm, info.feedback_u_rel, info.gain_bandwidth_Hz,
                                   info.gain_bandwidth_u_rel};
  const double rail_V = std::min(info.rail_V, info.range_V) - info.volts_per_code();
  std::vector<double> levels_N;
  const auto steps = static_cast<int>(std::floor(plan.force_max_N / plan.step_N + 1e-9));
  for (int i = 1; i <= steps; ++i) levels_N.push_back(i * plan.step_N);
  if (down)
    for (int i = steps - 1; i >= 0; --i) levels_N.push_back(i * plan.step_N);
  std::vector<std::vector<ForceReading>> out(info.sensors);
  std::vector<std::int16_t> direct(plan.dc_samples), sine(plan.sine_samples);
  for (const double force_N : levels_N) {
    FORCEGATE_CHECK_OK(bench.load(force_N, plan.hold_s));
    for (std::size_t s = 0; s < info.sensors; ++s) {
      FORCEGATE_CHECK_OK(bench.capture(s, {WeightBenchSource::Kind::dc, plan.dc_V, 0.0}, direct));
      FORCEGATE_CHECK_OK(bench.capture(s, {WeightBenchSource::Kind::sine, plan.sine_V, plan.sine_Hz}, sine));
      const auto level = impedance::direct_level(direct, info.volts_per_code(), rail_V);
      const auto phasor = impedance::lock_in(sine, plan.sine_Hz, info.rate_Hz, info.volts_per_code(), rail_V);
      const auto reading = impedance::rc_reading(phasor, plan.sine_V, plan.sine_Hz, circuit);
      if (level.clipped > 0 || reading.saturated)
        return fail(ErrorCode::device, "the amplifier saturates",
                    fmt::format("sensor {}, {} N", s + 1, force_N), "lower dc_V or sine_V, or R_g");
      out[s].push_back({force_N, level.mean_V, reading.capacitance_F});
    }
  }
  return out;
}

std::uint64_t network_seed(const WeightPlan& plan, std::size_t set, std::size_t sensor,
                           std::size_t loadings) {
  return mix_seed(plan.seed, fmt::format("network/{}/{}/{}", set, sensor, loadings));
}

Result<WeightStudy> run_weight_study(const WeightStudyRequest& request) {
  WeightStudy study;
  study.plan = request.plan;
  FORCEGATE_TRY(const auto probe, request.make_bench());
  study.bench = probe->info();
  if (request.plan.force_max_N > study.bench.force_max_N)
    return fail(ErrorCode::config,
                fmt::format("the plan asks for {} N, the bench holds {} N", request.plan.force_max_N,
                            study.bench.force_max_N),
                request.plan.path.string());
  const std::size_t n = request.plan.sets + 1;
  std::vector<std::unique_ptr<SetRun>> runs(n);
  std::vector<Result<void>> states(n);
  std::mutex mutex;
  std::size_t done = 0;
  parallel_for(n, study.bench.emulated ? request.threads : 1, [&](std::size_t i) {
    runs[i] = std::make_unique<SetRun>(request, i);
    states[i] = runs[i]->run();
    const std::lock_guard lock(mutex);
    ++done;
    if (request.progress)
      request.progress(static_cast<double>(done) / static_cast<double>(n),
                       fmt::format("pack {} of {}", done, n));
  });
  for (std::size_t i = 0; i < n; ++i) {
    FORCEGATE_CHECK_OK(states[i]);
    study.bench_time_s += runs[i]->time_s;
    study.samples += runs[i]->samples;
    if (i == 0) {
      study.exemplar_set = std::move(runs[i]->result);
      study.exemplar = std::move(runs[i]->exemplar);
    } else {
      study.sets.push_back(std::move(runs[i]->result));
    }
  }
  return study;
}

}  // namespace forcegate::characterize
