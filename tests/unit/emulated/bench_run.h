#pragma once
// Plays a profile on the emulated rig as a test needs it: 10 ms periods, columns kept whole.

#include <cstdlib>
#include <functional>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "hil/interface/controller.h"
#include "hil/interface/rig.h"
#include "hil/interface/stimulus.h"
#include "tests/support/value_or_abort.h"

namespace forcegate::test {

inline std::unique_ptr<Stimulus> stimulus(const std::string& name, std::map<std::string, double> numbers,
                                          std::map<std::string, std::vector<double>> lists = {},
                                          std::uint64_t seed = 1) {
  StimulusSpec spec;
  spec.name = name;
  spec.numbers = std::move(numbers);
  spec.lists = std::move(lists);
  spec.seed = seed;
  return value_or_abort(make_stimulus(spec));
}

/// Force from one converter code; called for every sample in order.
using Estimator = std::function<double(std::uint16_t)>;

struct BenchRun {
  std::map<std::string, std::string> rig_options = {};
  RigRecordRequest request = {};
  std::string controller = "open_loop";
  Estimator estimator = {};            ///< needed by force_integral
  std::vector<float> estimate_N = {};  ///< filled when there is an estimator

  /// Duration and range come from the profile.
  RigBlock play(const Stimulus& profile) {
    const auto rig = value_or_abort(make_rig("emulated", rig_options));
    return play(*rig, profile);
  }

  RigBlock play(Rig& rig, const Stimulus& profile) {
    const StimulusFacts facts = profile.facts();
    request.duration_s = profile.duration_s();
    request.force_low_N = facts.minimum_N;
    request.force_high_N = facts.maximum_N;
    if (const auto begun = rig.begin(request); !begun) {
      std::cerr << begun.error().to_text() << '\n';
      std::abort();
    }
    const double rate_Hz = rig.info().rate_Hz;
    const auto control = Registry<ControllerKind>::instance().find(controller)->make();
    control->reset(rig.info().geometry);
    const auto total = static_cast<std::size_t>(request.duration_s * rate_Hz + 0.5);
    const auto period = static_cast<std::size_t>(rate_Hz / 100.0 + 0.5);
    std::vector<double> fill(period);
    RigBlock block;
    block.resize(total);
    estimate_N.clear();
    ControllerInput in;
    in.estimate_N = facts.minimum_N;
    std::size_t at = 0;
    while (at < total) {
      in.t_s = static_cast<double>(at) / rate_Hz;
      in.setpoint_N = profile.force_N(in.t_s);
      in.setpoint_next_N = profile.force_N(std::min(in.t_s + in.period_s, request.duration_s));
      in.theta_rad = rig.theta_rad();
      if (!rig.command_velocity(control->velocity_rad_per_s(in))) std::abort();
      const std::size_t n = value_or_abort(rig.run(std::min(period, total - at), block, at));
      if (n == 0) break;
      profile.fill(in.t_s, 1.0 / rate_Hz, n, fill.data());
      for (std::size_t i = 0; i < n; ++i) {
        block.setpoint_N[at + i] = static_cast<float>(fill[i]);
        if (estimator) {
          in.estimate_N = estimator(block.adc[at + i]);
          estimate_N.push_back(static_cast<float>(in.estimate_N));
        }
      }
      at += n;
    }
    rig.park();
    block.resize(at);
    return block;
  }
};

}  // namespace forcegate::test
