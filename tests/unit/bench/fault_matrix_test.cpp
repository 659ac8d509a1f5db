// Every fault on every adapter: never a wrong value taken for a good one, never a hang, always parked, and the right
// party named. All in virtual time; the plant is deterministic, so that the truth of a run is a run without the fault.

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "tests/support/twin_bench.h"

namespace forcegate {
namespace {

using test::Changes;
using test::TwinBench;

struct Seen {
  std::vector<MotorState> states;
  std::vector<double> true_theta;
  std::vector<ReferenceReading> readings;
  std::map<std::uint32_t, BoardSample> samples;
  std::optional<Error> error;
  double command_after = 1.0, velocity_after = 1.0;
  std::uint64_t lost = 0;
};

const Changes kQuick{{"response_timeout_ms = 1000", "response_timeout_ms = 60"},
                     {"serial = \"BOARD-T-1\"", "serial = \"BOARD-T-1\"\nreply_timeout_ms = 200"}};

// 0.8 s of a slow swing; the fault begins at 0.3 s of the plant's time.
Seen play(const std::string& file, const std::string& fault) {
  TwinBench b(file, kQuick);
  Seen seen;
  b.run_up();
  BenchSession& s = *b.session;
  const double zero_s = s.world().now_s();
  if (!fault.empty()) b.say("fault " + fault);
  const auto step = [&](int i) -> Result<void> {
    FORCEGATE_CHECK_OK(s.motor().command_velocity(2.0 * std::sin(6.0 * 0.01 * i)));
    FORCEGATE_CHECK_OK(b.advance(0.01));
    FORCEGATE_TRY(MotorState state, s.motor().read());
    state.t_s -= zero_s;
    seen.states.push_back(state);
    seen.true_theta.push_back(b.status("theta_rad"));
    if (state.fault) return fail(ErrorCode::device, "drive fault", "motor");
    std::vector<ReferenceReading> readings;
    FORCEGATE_CHECK_OK(s.reference().poll(readings));
    for (ReferenceReading r : readings) {
      r.t_s -= zero_s;
      seen.readings.push_back(r);
    }
    std::vector<BoardSample> samples;
    FORCEGATE_CHECK_OK(s.board().poll(samples));
    for (const BoardSample& x : samples) seen.samples[x.index] = x;
    return {};
  };
  for (int i = 0; i < 80 && !seen.error; ++i)
    if (auto stepped = step(i); !stepped) seen.error = stepped.error();
  seen.lost = s.board().counters().indices_lost;
  s.make_safe();
  (void)b.advance(0.4);  // a drive that cannot be reached stops by itself
  seen.command_after = b.status("command_rad_per_s");
  seen.velocity_after = b.status("velocity_rad_per_s");
  return seen;
}

const Seen& truth(const std::string& file) {
  static std::map<std::string, Seen> seen;
  const auto at = seen.find(file);
  return at != seen.end() ? at->second : seen.emplace(file, play(file, "")).first->second;
}

void expect_parked(const Seen& seen) {
  EXPECT_EQ(seen.command_after, 0.0);
  EXPECT_NEAR(seen.velocity_after, 0.0, 0.01);
}

// name of the fault, and its script
using Fault = std::pair<const char*, const char*>;
const Fault kFaults[] = {
    {"delay", "delay 0.3 1e9 2 100"},         {"drop", "drop 0.3 1e9 1 0"},
    {"drop_for_long", "drop 0.3 0.2 0 0"},    {"drop_byte", "drop_byte 0.3 1e9 1 0"},
    {"duplicate", "duplicate 0.3 1e9 3 0"},   {"corrupt", "corrupt 0.3 1e9 1 0"},
    {"corrupt_often", "corrupt 0.3 1e9 5 0"}, {"garbage", "garbage 0.3 1e9 2 5"},
    {"truncate", "truncate 0.3 1e9 1 0"},     {"stall", "stall 0.3 0.1 0 0"},
    {"stall_for_good", "stall 0.3 1e9 0 0"},  {"unplug", "unplug 0.3 1e9 0 0"},
    {"frozen", "frozen 0.3 1e9 0 0"},         {"reset", "reset 0.3 1e9 1 0"},
};

std::string name_of(const testing::TestParamInfo<Fault>& info) { return info.param.first; }

class MotorFault : public testing::TestWithParam<Fault> {};

void check_motor(const std::string& file, const std::string& script) {
  const Seen seen = play(file, "motor " + script);
  for (std::size_t i = 0; i < seen.states.size(); ++i)
    EXPECT_NEAR(seen.states[i].theta_rad, seen.true_theta[i], 2e-3) << "period " << i;
  if (seen.error) {
    EXPECT_TRUE(seen.error->where.starts_with("motor")) << seen.error->to_text();
  } else {
    EXPECT_EQ(seen.states.size(), 80U);
  }
  expect_parked(seen);
}

TEST_P(MotorFault, OverRtu) { check_motor("twin_rtu.toml", GetParam().second); }
INSTANTIATE_TEST_SUITE_P(Matrix, MotorFault, testing::ValuesIn(kFaults), name_of);

class MotorFaultOverTcp : public testing::TestWithParam<Fault> {};
TEST_P(MotorFaultOverTcp, IsSurvivedOrNamed) { check_motor("twin.toml", GetParam().second); }
// Flipped bits inside a connection are not in it: there the checksum is TCP's own. RTU carries its CRC.
std::vector<Fault> checked_link_faults() {
  std::vector<Fault> out;
  for (const Fault& f : kFaults)
    if (!std::string(f.first).starts_with("corrupt")) out.push_back(f);
  return out;
}
INSTANTIATE_TEST_SUITE_P(Matrix, MotorFaultOverTcp, testing::ValuesIn(checked_link_faults()), name_of);

class MotorReply : public testing::TestWithParam<Fault> {};
TEST_P(MotorReply, IsSurvivedOrNamed) { check_motor("twin_rtu.toml", GetParam().second); }
const Fault kReplies[] = {{"exception_once", "exception 0.3 1e9 1 6"},
                          {"exception_always", "exception 0.3 1e9 0 4"},
                          {"wrong_slave", "wrong_slave 0.3 1e9 1 0"},
                          {"wrong_slave_always", "wrong_slave 0.3 1e9 0 0"}};
INSTANTIATE_TEST_SUITE_P(Matrix, MotorReply, testing::ValuesIn(kReplies), name_of);

class ReferenceFault : public testing::TestWithParam<Fault> {};

void check_reference(const std::string& file, const Fault& fault) {
  const std::string name = fault.first;
  const Seen seen = play(file, std::string("reference ") + fault.second);
  const auto& sound = truth(file).readings;
  ASSERT_GT(sound.size(), 150U);
  // A repeated reading is a sound record to a controller without sequence numbers; the rig's self-check sees it.
  if (name != "frozen" || file == "twin_netft.toml")
    for (const ReferenceReading& r : seen.readings) {
      if (std::isnan(r.force_N)) continue;
      // Some reading of the run without the fault within 30 ms says the same.
      double nearest = 1e9;
      for (const ReferenceReading& q : sound)
        if (std::fabs(q.t_s - r.t_s) < 0.03)
          nearest = std::min(nearest, std::fabs(static_cast<double>(q.force_N - r.force_N)));
      EXPECT_LT(nearest, 0.03) << "at " << r.t_s << " s: " << r.force_N;
    }
  if (seen.error) {
    EXPECT_TRUE(seen.error->where.starts_with("reference")) << seen.error->to_text();
  }
  // What is not fatal is survived: readings go on.
  const bool fatal = name == "stall_for_good" || name == "unplug" || name == "frozen" || name == "reset";
  if (!fatal && !seen.error) {
    ASSERT_FALSE(seen.readings.empty());
    EXPECT_GT(seen.readings.back().t_s, 0.7);
  }
  expect_parked(seen);
}

TEST_P(ReferenceFault, OnASerialControllerNeverShowsAWrongForce) { check_reference("twin.toml", GetParam()); }
TEST_P(ReferenceFault, OnADigitalSensorNeverShowsAWrongForce) {
  check_reference("twin_digital.toml", GetParam());
}
INSTANTIATE_TEST_SUITE_P(Matrix, ReferenceFault, testing::ValuesIn(kFaults), name_of);

class NetFtFault : public testing::TestWithParam<Fault> {};
TEST_P(NetFtFault, NeverShowsAWrongForce) { check_reference("twin_netft.toml", GetParam()); }
// As with TCP: what is in a datagram has passed the checksums of UDP and of the Ethernet frame.
INSTANTIATE_TEST_SUITE_P(Matrix, NetFtFault, testing::ValuesIn(checked_link_faults()), name_of);

class BoardFault : public testing::TestWithParam<Fault> {};

void check_board(const std::string& file, const Fault& fault) {
  const std::string name = fault.first;
  const Seen seen = play(file, std::string("board ") + fault.second);
  const auto& sound = truth("twin.toml").samples;
  ASSERT_EQ(sound.size(), 800U);
  std::uint32_t last = 0;
  for (const auto& [index, sample] : seen.samples) {
    if (name != "frozen") {
      EXPECT_EQ(sample.adc, sound.at(index).adc) << "index " << index;
    }
    last = index;
  }
  // A hole is told: counted, or the stream ends and the rig sees that.
  EXPECT_EQ(seen.lost, seen.samples.empty() ? 0U : last + 1 - seen.samples.size());
  if (seen.error) {
    EXPECT_TRUE(seen.error->where.starts_with("board")) << seen.error->to_text();
  }
  expect_parked(seen);
}

TEST_P(BoardFault, OnASerialLineNeverShowsAWrongSample) { check_board("twin.toml", GetParam()); }
TEST_P(BoardFault, InReportsNeverShowsAWrongSample) { check_board("twin_hid.toml", GetParam()); }
INSTANTIATE_TEST_SUITE_P(Matrix, BoardFault, testing::ValuesIn(kFaults), name_of);

}  // namespace
}  // namespace forcegate
