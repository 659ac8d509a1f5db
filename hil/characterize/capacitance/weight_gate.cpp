#include "hil/characterize/capacitance/weight_gate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hil/base/rng.h"
#include "hil/gate/statistics.h"
#include "hil/interface/dut.h"

namespace forcegate::characterize {
namespace {

using impedance::ForceReading;

constexpr std::uint64_t kFirstTraining = 1;  // loadings of run_weight_study

struct Trained {
  impedance::LineModel conductance;
  impedance::Network network;
};

Result<std::vector<Trained>> train(const WeightGatePlan& plan, WeightBench& bench) {
  std::vector<std::vector<ForceReading>> readings(bench.info().sensors);
  for (std::size_t l = 0; l < plan.study.training; ++l) {
    FORCEGATE_CHECK_OK(bench.begin({plan.study.seed, plan.pack, kFirstTraining + l, plan.study.rest_s}));
    FORCEGATE_TRY(const auto made, play_loading(bench, plan.study));
    for (std::size_t s = 0; s < made.size(); ++s)
      readings[s].insert(readings[s].end(), made[s].begin(), made[s].end());
  }
  std::vector<Trained> out;
  for (std::size_t s = 0; s < readings.size(); ++s) {
    FORCEGATE_TRY(
        impedance::Network network,
        impedance::train_network(readings[s], network_seed(plan.study, plan.pack, s, plan.study.training)));
    out.push_back({impedance::fit_conductance(readings[s]), network});
  }
  return out;
}

class Player {
 public:
  Player(const WeightGatePlan& plan, WeightBench& bench, const std::vector<Trained>& trained)
      : plan_(plan), bench_(bench), trained_(trained) {
    out.bench = bench.info();
    out.sensors.resize(out.bench.sensors);
    direct_.resize(plan.direct_samples);
    sine_.resize(plan.sine_samples);
  }

  Result<void> play() {
    const auto levels = static_cast<int>(std::floor(plan_.study.force_max_N / plan_.study.step_N + 1e-9));
    for (std::size_t l = 0; l < plan_.loadings; ++l) {
      FORCEGATE_CHECK_OK(
          bench_.begin({plan_.study.seed, plan_.pack, plan_.first_loading + l, plan_.study.rest_s}));
      for (int level = 1; level <= levels; ++level) {
        FORCEGATE_CHECK_OK(bench_.load(level * plan_.study.step_N, plan_.study.hold_s));
        FORCEGATE_CHECK_OK(frame(level * plan_.study.step_N, l, plan_.study.sine_V));
      }
    }
    FORCEGATE_CHECK_OK(frame(levels * plan_.study.step_N, plan_.loadings, plan_.overdrive_V));
    return frame(levels * plan_.study.step_N, plan_.loadings, plan_.study.sine_V);
  }

  PackFrames out;

 private:
  Result<void> frame(double force_N, std::size_t loading, double sine_V) {
    const WeightBenchInfo& info = out.bench;
    const impedance::Circuit circuit{info.feedback_ohm, info.feedback_u_rel, info.gain_bandwidth_Hz,
                                     info.gain_bandwidth_u_rel};
    const double rail_V = std::min(info.rail_V, info.range_V) - info.volts_per_code();
    const auto middle = static_cast<std::int32_t>(1u << (info.adc_bits - 1));
    for (std::size_t s = 0; s < info.sensors; ++s) {
      SensorFrames& to = out.sensors[s];
      FORCEGATE_CHECK_OK(bench_.capture(s, {WeightBenchSource::Kind::dc, plan_.study.dc_V, 0.0}, direct_));
      FORCEGATE_CHECK_OK(
          bench_.capture(s, {WeightBenchSource::Kind::sine, sine_V, plan_.study.sine_Hz}, sine_));
      for (const auto* part : {&direct_, &sine_})
        for (const std::int16_t code : *part) to.codes.push_back(static_cast<std::uint16_t>(code + middle));
      const auto level = impedance::direct_level(direct_, info.volts_per_code(), rail_V);
      const auto reading = impedance::rc_reading(
          impedance::lock_in(sine_, plan_.study.sine_Hz, info.rate_Hz, info.volts_per_code(), rail_V), sine_V,
          plan_.study.sine_Hz, circuit);
      to.force_N.push_back(force_N);
      to.loading.push_back(loading);
      to.oracle_N.push_back(sine_V == plan_.study.sine_V
                                ? trained_[s].network.force_N(level.mean_V, reading.capacitance_F)
                                : std::nan(""));
      to.conductance_N.push_back(trained_[s].conductance.force_N(level.mean_V));
    }
    return {};
  }

  const WeightGatePlan& plan_;
  WeightBench& bench_;
  const std::vector<Trained>& trained_;
  std::vector<std::int16_t> direct_, sine_;
};

JudgedCheck check(std::string id, const std::string& case_id, std::string title, double value,
                  std::string unit, Limit limit) {
  JudgedCheck j;
  j.check.id = std::move(id);
  j.check.case_id = case_id;
  j.check.title = std::move(title);
  j.check.value = value;
  j.check.unit = std::move(unit);
  j.check.limit = std::move(limit);
  j.check.blame = Blame::firmware;
  return j;
}

void with_spread(JudgedCheck& j, const std::vector<double>& values) {
  const Moments m = moments(values);
  j.check.value = m.mean;
  j.check.u = m.n > 1 ? m.sd / std::sqrt(static_cast<double>(m.n)) : 0.0;
  j.check.n = m.n;
  j.dof = static_cast<double>(m.n) - 1.0;
}

// The network in double precision misses the limit on the same codes: the bench, the sensors or the training, not the build.
void out_of_reach(JudgedCheck& j) {
  j.judgeable = false;
  j.check.verdict = Verdict::rig_error;
  j.check.blame = Blame::rig;
  j.check.evidence +=
      ": no firmware can hold this limit on these codes; look at the bench, or train the networks on its sensors";
}

std::string spread_in_words(const std::vector<double>& values, const std::vector<double>& network,
                            const char* unit) {
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  return fmt::format("sensors from {:.3g} to {:.3g} {}; the network in double precision {:.4g} {}", *low,
                     *high, unit, moments(network).mean, unit);
}

// Of the rig, before any value of the firmware.
JudgedCheck rig_network(const WeightGatePlan& plan, const SensorFrames& frames, const std::string& case_id) {
  JudgedCheck j = check("rig_network", case_id,
                        "Network in double precision on the codes of this bench, mean squared error",
                        moments(squared_error_by_loading_N2(plan, frames, frames.oracle_N)).mean, "N^2",
                        {Limit::Kind::upper, plan.sensor_mse_N2, "as for the firmware"});
  j.check.blame = Blame::none;
  j.check.verdict = Verdict::pass;
  j.judgeable = false;
  if (!(j.check.value <= plan.sensor_mse_N2)) out_of_reach(j);
  return j;
}

}  // namespace

Result<PackFrames> play_pack(const WeightGatePlan& plan,
                             const std::function<Result<std::unique_ptr<WeightBench>>(double)>& make_bench) {
  FORCEGATE_TRY(const auto training_bench, make_bench(0.0));
  FORCEGATE_TRY(const auto trained, train(plan, *training_bench));
  FORCEGATE_TRY(const auto bench, make_bench(plan.rate_Hz));
  Player player(plan, *bench, trained);
  FORCEGATE_CHECK_OK(player.play());
  return std::move(player.out);
}

std::vector<double> squared_error_by_loading_N2(const WeightGatePlan& plan, const SensorFrames& frames,
                                                const std::vector<double>& estimate_N) {
  std::vector<double> out(plan.loadings, 0.0), n(plan.loadings, 0.0);
  for (std::size_t i = 0; i < frames.force_N.size(); ++i) {
    if (frames.loading[i] >= plan.loadings) continue;
    out[frames.loading[i]] += std::pow(estimate_N[i] - frames.force_N[i], 2);
    n[frames.loading[i]] += 1.0;
  }
  for (std::size_t l = 0; l < plan.loadings; ++l) out[l] /= n[l];
  return out;
}

std::vector<JudgedCheck> judge_sensor(const WeightGatePlan& plan, const SensorFrames& frames,
                                      const FrameAnswers& answers, const std::string& case_id) {
  std::vector<JudgedCheck> out{rig_network(plan, frames, case_id)};
  double worst_N = 0.0;
  std::size_t at = 0, unflagged = 0, wrongly_flagged = 0, not_finite = 0;
  for (std::size_t i = 0; i < frames.force_N.size(); ++i) {
    not_finite += std::isfinite(answers.force_N[i]) ? 0 : 1;
    const bool overdriven = std::isnan(frames.oracle_N[i]);
    const bool flagged = (answers.flags[i] & kDutInputRail) != 0;
    if (overdriven) {
      unflagged += flagged ? 0 : 1;
      continue;
    }
    wrongly_flagged += flagged ? 1 : 0;
    const double off_N = std::abs(answers.force_N[i] - frames.oracle_N[i]);
    if (off_N > worst_N) worst_N = off_N, at = i;
  }
  out.push_back(check("conformance", case_id,
                      "Largest difference to the network in double precision, same codes", worst_N, "N",
                      {Limit::Kind::upper, plan.conformance_N, "ours: single precision"}));
  out.back().check.n = frames.force_N.size();
  out.back().check.evidence = fmt::format("at {:.0f} N the firmware says {:.3f} N, the network {:.3f} N",
                                          frames.force_N[at], answers.force_N[at], frames.oracle_N[at]);
  out.push_back(check("finite", case_id, "Forces that are no number", static_cast<double>(not_finite), "1",
                      {Limit::Kind::upper, 0.0, "ours"}));
  out.push_back(check("saturation_flag", case_id,
                      "Saturated frames that are not flagged, and sound ones that are",
                      static_cast<double>(unflagged + wrongly_flagged), "1",
                      {Limit::Kind::upper, 0.0, "ours: a saturated reading is no force"}));
  out.back().check.evidence =
      fmt::format("{} saturated without a flag, {} flagged without need", unflagged, wrongly_flagged);
  out.push_back(check("mse", case_id, "Mean squared error against the weights", 0.0, "N^2",
                      {Limit::Kind::upper, plan.sensor_mse_N2,
                       "Paredes-Madrid 2010, Table I: largest of the conductance model"}));
  const auto own = squared_error_by_loading_N2(plan, frames, answers.force_N),
             line = squared_error_by_loading_N2(plan, frames, frames.conductance_N);
  with_spread(out.back(), own);
  const double by_line = moments(line).mean;
  out.back().check.evidence =
      fmt::format("conductance model {:.3f} N^2: error reduction by eq. (11) {:.1f} %", by_line,
                  impedance::error_reduction_pct(out.back().check.value, by_line));
  return out;
}

std::vector<JudgedCheck> judge_pack(const WeightGatePlan& plan,
                                    const std::vector<const SensorFrames*>& frames,
                                    const std::vector<const FrameAnswers*>& answers) {
  std::vector<double> mse, per, possible_mse, possible_per;
  for (std::size_t s = 0; s < frames.size(); ++s) {
    const auto mean = [&](const std::vector<double>& estimate_N) {
      return moments(squared_error_by_loading_N2(plan, *frames[s], estimate_N)).mean;
    };
    const double own = mean(answers[s]->force_N), line = mean(frames[s]->conductance_N),
                 network = mean(frames[s]->oracle_N);
    mse.push_back(own);
    per.push_back(impedance::error_reduction_pct(own, line));
    possible_mse.push_back(network);
    possible_per.push_back(impedance::error_reduction_pct(network, line));
  }
  std::vector<JudgedCheck> out;
  out.push_back(
      check("mse_pack", "", "Mean squared error, mean over the pack", 0.0, "N^2",
            {Limit::Kind::upper, plan.pack_mse_N2, "Paredes-Madrid 2010, Table I: largest of the network"}));
  with_spread(out.back(), mse);
  out.back().check.evidence = spread_in_words(mse, possible_mse, "N^2");
  if (!(moments(possible_mse).mean <= plan.pack_mse_N2)) out_of_reach(out.back());
  out.push_back(check("per_pack", "", "Percentage of error reduction, eq. (11), mean over the pack", 0.0, "%",
                      {Limit::Kind::lower, plan.pack_per_pct, "Paredes-Madrid 2010, Table I: smallest"}));
  with_spread(out.back(), per);
  out.back().check.evidence = spread_in_words(per, possible_per, "%");
  if (!(moments(possible_per).mean >= plan.pack_per_pct)) out_of_reach(out.back());
  return out;
}

}  // namespace forcegate::characterize
