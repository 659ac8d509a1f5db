#pragma once
// One record of an ideal bench and an ideal firmware, which the tests spoil, and its judgement.

#include <string>
#include <vector>

#include "hil/gate/judge.h"
#include "hil/gate/runner.h"
#include "tests/support/fake_dut.h"
#include "tests/support/fake_rig.h"

namespace forcegate::testing {

struct Bench {
  FakeRig rig;
  FakeDut dut;
  CaseJob job;
  Plan plan;
  Bench() {
    job.id = "sine/fake";
    job.nonce = 0x1234;
    job.planned.name = "sine";
    job.planned.controller = "open_loop";
    job.planned.checks = kCheckAccuracy;
    job.planned.maxima_pct = job.planned.minima_pct = 5.0;
    job.planned.limit_source = "test";
    job.planned.stimulus.name = "sine";
    job.planned.stimulus.numbers = {
        {"f_Hz", 0.5}, {"A_N", 1.0}, {"m_N", 2.0}, {"duration_s", 60.0}, {"ramp_s", 2.0}};
    job.calibration.gain_N_per_V = rig.gain_N_per_V;
    job.calibration.offset_N = rig.offset_N;
  }
  CaseRecord run() {
    RunDevices devices;
    devices.rig = &rig;
    devices.dut = &dut;
    return run_case(job, devices);
  }
  JudgedCase judge(const CaseRecord& record) {
    JudgedCase judged = judge_case(plan, job.planned, record, {});
    std::vector<JudgedCheck*> all;
    for (JudgedCheck& j : judged.checks) all.push_back(&j);
    apply_rule(plan.rule, all);
    return judged;
  }
  void close_loop() {
    job.planned.loop = LoopMode::closed;
    job.planned.controller = "force_integral";
  }
};

inline const Check* find(const JudgedCase& judged, const std::string& id) {
  for (const JudgedCheck& j : judged.checks)
    if (j.check.id == id) return &j.check;
  return nullptr;
}

}  // namespace forcegate::testing
