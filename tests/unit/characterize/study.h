#pragma once
// A study on the emulated rig as tests need it: short records, one specimen.

#include <memory>
#include <string>

#include "hil/app/characterize/characterize.h"
#include "hil/characterize/population_study.h"
#include "hil/interface/rig.h"
#include "tests/support/value_or_abort.h"

namespace forcegate::test {

inline characterize::StudyPlan plan_of_the_paper() {
  return value_or_abort(characterize::read_study_plan(FORCEGATE_SOURCE_DIR "/ci/plans/characterize.toml"));
}

inline characterize::StudyRequest request_of(characterize::StudyPlan plan, std::vector<std::string> sensors) {
  characterize::StudyRequest request;
  request.plan = std::move(plan);
  request.sensors = std::move(sensors);
  request.make_rig = [](const std::string& sensor) { return make_rig("emulated", {{"sensor", sensor}}); };
  request.compensation = oracle_compensation;
  return request;
}

inline std::vector<characterize::SensorStudy> run(const characterize::StudyRequest& request) {
  characterize::BenchProgress progress;
  return value_or_abort(characterize::run_study(request, progress));
}

}  // namespace forcegate::test
