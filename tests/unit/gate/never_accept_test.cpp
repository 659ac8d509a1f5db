// Whatever sequence of errors rig, reference, sensor and link make: no build is accepted, and no good build is rejected.

#include <gtest/gtest.h>

#include <cmath>

#include "hil/base/rng.h"
#include "hil/gate/run_judge.h"
#include "hil/gate/runner.h"
#include "tests/support/fake_dut.h"
#include "tests/support/fake_rig.h"

namespace forcegate {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

// One thing that goes wrong from an instant on, for a while.
struct Trouble {
  std::string name;
  double from_s, to_s, size;
};

const std::vector<std::string>& kinds() {
  static const std::vector<std::string> kAll{
      "ati_nan",     "ati_saturated", "ati_fault", "ati_offset",  "ati_frozen",   "ati_gain",
      "motor_fault", "lost",          "code_zero", "code_frozen", "code_stuck",   "time_back",
      "time_gap",    "ends",          "rig_error", "link_counts", "link_timeout", "wheel_noise"};
  return kAll;
}

class TroubledRig : public testing::FakeRig {
 public:
  double fails_at_s = std::numeric_limits<double>::infinity();
  Result<std::size_t> run(std::size_t n, RigBlock& out, std::size_t at) override {
    FORCEGATE_TRY(const std::size_t got, testing::FakeRig::run(n, out, at));
    if (got > 0 && out.t_s[at + got - 1] >= fails_at_s) return fail(ErrorCode::device, "the rig fell silent");
    return got;
  }
};

class TroubledDut : public testing::FakeDut {
 public:
  double silent_at_s = std::numeric_limits<double>::infinity();
  DutCounters spoiled;
  Result<void> process(std::uint32_t first, std::span<const std::uint16_t> adc, std::span<float> force_N,
                       std::span<std::uint8_t> flags) override {
    if (first / 1000.0 >= silent_at_s) return fail(ErrorCode::timeout, "no answer");
    return testing::FakeDut::process(first, adc, force_N, flags);
  }
  Result<DutCounters> close() override {
    FORCEGATE_TRY(DutCounters c, testing::FakeDut::close());
    c.frames_bad += spoiled.frames_bad;
    c.indices_lost += spoiled.indices_lost;
    return c;
  }
};

void spoil_row(const Trouble& t, std::size_t row, double t_s, RigBlock& b, float& frozen_N,
               std::uint16_t& frozen_code) {
  if (t_s < t.from_s || t_s > t.to_s) {
    frozen_N = b.force_ref_N[row];
    frozen_code = b.adc[row];
    return;
  }
  if (t.name == "ati_nan") b.force_ref_N[row] = kNan;
  if (t.name == "ati_saturated") b.status[row] |= kRigReferenceSaturated;
  if (t.name == "ati_fault") b.status[row] |= kRigReferenceFault;
  if (t.name == "ati_offset") b.force_ref_N[row] += static_cast<float>(t.size);
  if (t.name == "ati_gain") b.force_ref_N[row] *= static_cast<float>(1.0 + t.size);
  if (t.name == "ati_frozen") b.force_ref_N[row] = frozen_N;
  if (t.name == "motor_fault") b.status[row] |= kRigMotorFault;
  if (t.name == "lost") b.status[row] |= kRigSampleLost;
  if (t.name == "code_zero") b.adc[row] = 0;
  if (t.name == "code_frozen") b.adc[row] = frozen_code;
  if (t.name == "code_stuck") b.adc[row] |= 0x2000;
  if (t.name == "time_back") b.t_s[row] -= 2.0 * (t_s - t.from_s) + 0.01;
  if (t.name == "time_gap") b.t_s[row] += 3.0;
  if (t.name == "wheel_noise") b.theta_rad[row] += static_cast<float>(t.size * std::sin(400.0 * t_s));
}

Decision play(const std::vector<Trouble>& troubles, bool closed, double firmware_gain = 1.0) {
  TroubledRig rig;
  TroubledDut dut;
  if (firmware_gain != 1.0)
    dut.spoil = [=](std::uint32_t, float& force_N, std::uint8_t&) {
      force_N *= static_cast<float>(firmware_gain);
    };
  std::vector<float> frozen_N(troubles.size());
  std::vector<std::uint16_t> frozen_code(troubles.size());
  for (const Trouble& t : troubles) {
    if (t.name == "ends") rig.ends_after_s = t.from_s;
    if (t.name == "rig_error") rig.fails_at_s = t.from_s;
    if (t.name == "link_timeout") dut.silent_at_s = t.from_s;
    if (t.name == "link_counts") dut.spoiled.frames_bad += 3;
  }
  rig.spoil = [&](std::size_t row, double t_s, RigBlock& b) {
    for (std::size_t k = 0; k < troubles.size(); ++k)
      spoil_row(troubles[k], row, t_s, b, frozen_N[k], frozen_code[k]);
  };
  RunMaterial m;
  m.plan.panel = {"fake"};
  PlanCase c;
  c.name = "sine";
  c.loop = closed ? LoopMode::closed : LoopMode::open;
  c.controller = closed ? "force_integral" : "open_loop";
  c.checks = closed ? kCheckPromise : kCheckAccuracy;
  c.maxima_pct = c.minima_pct = 5.0;
  c.limit_source = "test";
  c.stimulus.name = "sine";
  c.stimulus.numbers = {{"f_Hz", 0.5}, {"A_N", 1.0}, {"m_N", 2.0}, {"duration_s", 60.0}, {"ramp_s", 2.0}};
  m.plan.cases = {c};
  CaseJob job;
  job.id = "sine/fake";
  job.specimen = "fake";
  job.planned = c;
  job.calibration.gain_N_per_V = rig.gain_N_per_V;
  job.calibration.offset_N = rig.offset_N;
  job.calibration.level = CalibrationLevel::statical;
  RunDevices devices;
  devices.rig = &rig;
  devices.dut = &dut;
  PlayedRecord one;
  one.job = job;
  one.record = run_case(job, devices);
  m.records.push_back(std::move(one));
  const auto of_run = judge_records(m.plan, m.limits, m.records);
  return to_run_result(m, of_run).decision;
}

std::string in_words(const std::vector<Trouble>& troubles) {
  std::string out;
  for (const Trouble& t : troubles)
    out += t.name + " " + std::to_string(t.from_s) + ".." + std::to_string(t.to_s) + "; ";
  return out;
}

TEST(NeverAccept, without_any_trouble_the_same_bench_accepts) {
  EXPECT_EQ(play({}, false).kind, DecisionKind::accept) << play({}, false).reason;
  EXPECT_EQ(play({}, true).kind, DecisionKind::accept) << play({}, true).reason;
  EXPECT_EQ(play({}, false, 1.3).kind, DecisionKind::reject);
}

TEST(NeverAccept, each_kind_of_trouble_alone_gives_no_decision) {
  for (const std::string& kind : kinds())
    for (const bool closed : {false, true}) {
      const Decision d = play({{kind, 20.0, 45.0, 0.4}}, closed);
      EXPECT_EQ(d.kind, DecisionKind::no_decision) << kind << (closed ? " closed: " : " open: ") << d.reason;
      EXPECT_NE(d.blame, Blame::firmware) << kind << ": " << d.reason;
    }
}

TEST(NeverAccept, no_random_sequence_of_troubles_accepts_or_rejects_a_build) {
  Rng rng(20261121, "troubles");
  for (int i = 0; i < 100; ++i) {
    std::vector<Trouble> troubles;
    const int n = 1 + static_cast<int>(4.0 * rng.uniform());
    for (int k = 0; k < n; ++k) {
      const double from_s = 4.0 + 40.0 * rng.uniform();
      troubles.push_back(
          {kinds()[static_cast<std::size_t>(rng.uniform() * static_cast<double>(kinds().size()))], from_s,
           from_s + 5.0 + 30.0 * rng.uniform(), (rng.uniform() < 0.5 ? -1.0 : 1.0) * (0.2 + rng.uniform())});
    }
    const bool closed = rng.uniform() < 0.3;
    const double gain = rng.uniform() < 0.5 ? 1.0 : 1.2;
    const Decision d = play(troubles, closed, gain);
    EXPECT_NE(d.kind, DecisionKind::accept) << in_words(troubles);
    if (gain == 1.0) {
      EXPECT_NE(d.kind, DecisionKind::reject) << in_words(troubles) << d.reason;
    }
  }
}

}  // namespace
}  // namespace forcegate
