// Property: whatever goes wrong in a record, and in whatever combination, the decision is never ACCEPT.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "hil/base/rng.h"
#include "hil/gate/case_json.h"
#include "hil/gate/decision.h"
#include "hil/gate/judge.h"
#include "hil/gate/runner.h"
#include "tests/support/fake_dut.h"
#include "tests/support/fake_rig.h"

namespace forcegate {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr double kDuration_s = 40.0;

class TroubledRig : public testing::FakeRig {
 public:
  double fails_at_s = 1e9;
  bool refuses_to_begin = false;
  Result<void> begin(const RigRecordRequest& request) override {
    if (refuses_to_begin) return fail(ErrorCode::device, "the drive does not answer");
    return FakeRig::begin(request);
  }
  Result<std::size_t> run(std::size_t n, RigBlock& out, std::size_t at) override {
    auto done = FakeRig::run(n, out, at);
    if (done && *done > 0 && out.t_s[at + *done - 1] > fails_at_s)
      return fail(ErrorCode::device, "a cable came off");
    return done;
  }
};

class TroubledDut : public testing::FakeDut {
 public:
  bool refuses_to_open = false, refuses_to_close = false;
  std::uint32_t blames_link_at = 0xFFFFFFFF;
  Result<DutInfo> open(const DutSession& session) override {
    if (refuses_to_open) return fail(ErrorCode::firmware, "wrong protocol");
    return FakeDut::open(session);
  }
  Result<void> process(std::uint32_t first_index, std::span<const std::uint16_t> adc,
                       std::span<float> force_N, std::span<std::uint8_t> flags) override {
    if (first_index + adc.size() > blames_link_at) return fail(ErrorCode::io, "the line is dead");
    return FakeDut::process(first_index, adc, force_N, flags);
  }
  Result<DutCounters> close() override {
    if (refuses_to_close) return fail(ErrorCode::firmware, "the image does not end");
    return FakeDut::close();
  }
};

// An oracle that can fail like everything else.
class TroubledComparator : public Comparator {
 public:
  double value = 0.0;
  bool refuses = false;
  Result<void> begin(const ComparatorSession&) override {
    if (refuses) return fail(ErrorCode::config, "no oracle");
    return {};
  }
  void push(std::span<const std::uint16_t> adc, std::span<const float>,
            std::span<const std::uint8_t>) override {
    n_ += adc.size();
  }
  Comparison finish() override {
    Comparison c;
    c.value = value;
    c.limit = 1.0;
    c.n = n_;
    return c;
  }

 private:
  std::uint64_t n_ = 0;
};

struct Bench {
  TroubledRig rig;
  TroubledDut dut;
  TroubledComparator comparator;
  CaseJob job;
  Plan plan;
  RunEvents events;
  double from_s = 0.0;  ///< when the trouble begins

  Bench() {
    job.id = "sine/fake";
    job.planned.name = "sine";
    job.planned.controller = "open_loop";
    job.planned.checks = kCheckAccuracy | kCheckConformance;
    job.planned.maxima_pct = job.planned.minima_pct = 5.0;
    job.planned.limit_source = "test";
    job.planned.stimulus.name = "sine";
    job.planned.stimulus.numbers = {
        {"f_Hz", 0.5}, {"A_N", 1.0}, {"m_N", 2.0}, {"duration_s", kDuration_s}, {"ramp_s", 2.0}};
    job.calibration.gain_N_per_V = rig.gain_N_per_V;
    job.calibration.offset_N = rig.offset_N;
  }

  Decision decide_on(CaseRecord record) {
    JudgedCase judged = judge_case(plan, job.planned, record, {});
    std::vector<JudgedCheck*> all;
    std::vector<const Check*> checks;
    for (JudgedCheck& j : judged.checks) {
      all.push_back(&j);
      checks.push_back(&j.check);
    }
    apply_rule(plan.rule, all);
    events.harness_error = judged.harness_error;
    events.safety_stop = judged.safety_stop;
    events.safety_cause_decided = judged.safety_cause_decided;
    return decide(checks, plan.rule, events);
  }

  CaseRecord run() {
    RunDevices devices;
    devices.rig = &rig;
    devices.dut = &dut;
    devices.comparator = &comparator;
    return run_case(job, devices);
  }

  // Trouble of the rig lasts for five seconds, of the firmware for a sample.
  void rig_trouble(std::function<void(std::size_t, RigBlock&)> what) {
    rig.spoil = [this, before = rig.spoil, what](std::size_t row, double t_s, RigBlock& block) {
      if (before) before(row, t_s, block);
      if (t_s >= from_s && t_s < from_s + 5.0) what(row, block);
    };
  }
  void firmware_trouble(std::function<void(float&)> what) {
    const auto at = static_cast<std::uint32_t>(1000.0 * from_s);
    dut.spoil = [at, before = dut.spoil, what](std::uint32_t index, float& force_N, std::uint8_t& flags) {
      if (before) before(index, force_N, flags);
      if (index == at) what(force_N);
    };
  }
};

using Trouble = void (*)(Bench&);
const Trouble kTroubles[] = {
    [](Bench& b) { b.rig.refuses_to_begin = true; },
    [](Bench& b) { b.rig.fails_at_s = b.from_s; },
    [](Bench& b) { b.rig.ends_after_s = b.from_s; },
    [](Bench& b) { b.rig_trouble([](std::size_t i, RigBlock& r) { r.force_ref_N[i] = kNan; }); },
    [](Bench& b) { b.rig_trouble([](std::size_t i, RigBlock& r) { r.status[i] |= kRigReferenceFault; }); },
    [](Bench& b) {
      b.rig_trouble([](std::size_t i, RigBlock& r) { r.status[i] |= kRigReferenceSaturated; });
    },
    [](Bench& b) { b.rig_trouble([](std::size_t i, RigBlock& r) { r.status[i] |= kRigMotorFault; }); },
    [](Bench& b) { b.rig_trouble([](std::size_t i, RigBlock& r) { r.status[i] |= kRigSampleLost; }); },
    [](Bench& b) { b.rig_trouble([](std::size_t i, RigBlock& r) { r.t_s[i] -= 100.0; }); },
    [](Bench& b) { b.rig_trouble([](std::size_t i, RigBlock& r) { r.force_ref_N[i] = 2.0f; }); },
    [](Bench& b) { b.dut.wrong_nonce = true; },
    [](Bench& b) { b.dut.refuses_to_open = true; },
    [](Bench& b) { b.dut.refuses_to_close = true; },
    [](Bench& b) { b.dut.dies_at = static_cast<std::uint32_t>(1000.0 * b.from_s); },
    [](Bench& b) { b.dut.blames_link_at = static_cast<std::uint32_t>(1000.0 * b.from_s); },
    [](Bench& b) { b.dut.counters.frames_dropped = 1; },
    [](Bench& b) { b.dut.counters.indices_lost = 3; },
    [](Bench& b) { b.firmware_trouble([](float& force_N) { force_N = kNan; }); },
    [](Bench& b) { b.firmware_trouble([](float& force_N) { force_N = -INFINITY; }); },
    [](Bench& b) { b.firmware_trouble([](float& force_N) { force_N = 1e9f; }); },
    [](Bench& b) { b.comparator.value = std::nan(""); },
    [](Bench& b) { b.comparator.value = INFINITY; },
    [](Bench& b) { b.comparator.value = 1.001; },
    [](Bench& b) { b.comparator.refuses = true; },
    [](Bench& b) { b.job.planned.maxima_pct.reset(); },  // no limit, and none derived
    [](Bench& b) { b.job.planned.stimulus.numbers["A_N"] = -1.0; },
    [](Bench& b) { b.job.planned.controller = "nobody"; },
    [](Bench& b) { b.events.cancelled = true; },
};

TEST(NoFalseAccept, the_sound_record_is_accepted) {
  Bench b;
  const Decision d = b.decide_on(b.run());
  EXPECT_EQ(d.kind, DecisionKind::accept) << d.reason;
}

TEST(NoFalseAccept, any_single_trouble_at_any_time_keeps_the_build_from_being_accepted) {
  Rng rng(1, "single");
  for (std::size_t k = 0; k < std::size(kTroubles); ++k)
    for (int turn = 0; turn < 2; ++turn) {
      Bench b;
      b.from_s = 1.0 + rng.uniform() * (kDuration_s - 8.0);
      kTroubles[k](b);
      const Decision d = b.decide_on(b.run());
      EXPECT_NE(d.kind, DecisionKind::accept) << "trouble " << k << " at " << b.from_s << " s";
      EXPECT_NE(d.exit_code, 0) << "trouble " << k;
    }
}

TEST(NoFalseAccept, any_sequence_of_troubles_keeps_the_build_from_being_accepted) {
  Rng rng(2, "sequences");
  for (int turn = 0; turn < 150; ++turn) {
    Bench b;
    const int n = 1 + static_cast<int>(rng.uniform() * 4.0);
    std::string which;
    for (int i = 0; i < n; ++i) {
      const auto k = static_cast<std::size_t>(rng.uniform() * static_cast<double>(std::size(kTroubles)));
      b.from_s = 1.0 + rng.uniform() * (kDuration_s - 8.0);
      kTroubles[k](b);
      which += " " + std::to_string(k);
    }
    EXPECT_NE(b.decide_on(b.run()).kind, DecisionKind::accept) << "troubles" << which;
  }
}

// What was measured is damaged afterwards: on the way from the worker, in a store, by a defect of ours.
TEST(NoFalseAccept, missing_or_damaged_facts_are_never_accepted) {
  Bench sound;
  const CaseRecord record = sound.run();
  using Damage = void (*)(CaseRecord&);
  const Damage damages[] = {
      [](CaseRecord& r) { r.pairs.clear(); },
      [](CaseRecord& r) { r.pairs.resize(r.pairs.size() / 2); },
      [](CaseRecord& r) { r.pairs[r.pairs.size() / 2].dut_N = kNan; },
      [](CaseRecord& r) { r.pairs[r.pairs.size() / 2].ati_N = kNan; },
      [](CaseRecord& r) { r.samples = 0; },
      [](CaseRecord& r) { r.samples -= 1; },
      [](CaseRecord& r) { r.expected_samples = 0; },
      [](CaseRecord& r) { r.output.not_finite = 1; },
      [](CaseRecord& r) { r.output.maximum_N = kNan; },
      [](CaseRecord& r) { r.output.learning_longest_s = kNan; },
      [](CaseRecord& r) { r.conformance = kNan; },
      [](CaseRecord& r) { r.conformance_limit = kNan; },
      [](CaseRecord& r) { r.observed.time_not_monotone = 1; },
      [](CaseRecord& r) { r.resources.late = 1.0; },
      [](CaseRecord& r) { r.resources.heap_growth_bytes = 24.0; },
      [](CaseRecord& r) { r.prelude.samples = 1000, r.prelude.not_finite = 1; },
      [](CaseRecord& r) { r.prelude.samples = 1000, r.prelude.largest_N = 1e6; },
      [](CaseRecord& r) {
        r.prelude.samples = 1000, r.prelude.conformance_known = true, r.prelude.conformance = kNan;
      },
      [](CaseRecord& r) { r.failure = CaseFailure{}; },
      [](CaseRecord& r) { r = CaseRecord{}; },
  };
  for (std::size_t k = 0; k < std::size(damages); ++k) {
    CaseRecord bad = record;
    damages[k](bad);
    auto travelled = record_from_json(to_json(bad));
    ASSERT_TRUE(travelled) << k;
    Bench judge;
    const Decision d = judge.decide_on(std::move(*travelled));
    EXPECT_NE(d.kind, DecisionKind::accept) << "damage " << k << ": " << d.reason;
  }
}

}  // namespace
}  // namespace forcegate
