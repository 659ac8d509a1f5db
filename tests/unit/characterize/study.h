#pragma once
// A study on the emulated rig as tests need it: short records, one specimen.

#include <iostream>
#include <memory>
#include <string>

#include "golden/compare/lebosse_oracle.h"
#include "hil/characterize/population_study.h"
#include "hil/interface/dut.h"

namespace forcegate::test {

template <class T>
T value_or_abort(Result<T> result) {
  if (!result) {
    std::cerr << result.error().to_text() << '\n';
    std::abort();
  }
  return std::move(*result);
}

inline characterize::Compensation eq_7(const Calibration& calibration) {
  struct State {
    LebosseOracle oracle;
    std::uint8_t flags = 0;
  };
  const auto state = std::make_shared<State>(State{LebosseOracle(calibration)});
  return {[state](std::uint16_t code) {
            const LebosseOracle::Output out = state->oracle.step(code);
            state->flags = out.flags;
            return out.force_N;
          },
          [state] { return (state->flags & kDutLearning) != 0; }};
}

inline characterize::StudyPlan plan_of_the_paper() {
  return value_or_abort(characterize::read_study_plan(FORCEGATE_SOURCE_DIR "/ci/plans/characterize.toml"));
}

inline characterize::StudyRequest request_of(characterize::StudyPlan plan, std::vector<std::string> sensors) {
  characterize::StudyRequest request;
  request.plan = std::move(plan);
  request.sensors = std::move(sensors);
  request.make_rig = [](const std::string& sensor) { return make_rig("emulated", {{"sensor", sensor}}); };
  request.compensation = eq_7;
  return request;
}

inline std::vector<characterize::SensorStudy> run(const characterize::StudyRequest& request) {
  characterize::BenchProgress progress;
  return value_or_abort(characterize::run_study(request, progress));
}

}  // namespace forcegate::test
