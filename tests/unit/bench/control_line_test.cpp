// The control socket of the twins: a line that is not understood as a whole does nothing, and says what is wrong with it.

#include <gtest/gtest.h>

#include <string>

#include "rigs/emulated/twins/wire.h"
#include "tests/support/twin_bench.h"

namespace forcegate {
namespace {

using emulated::FaultScript;
using emulated::WireFault;
using test::TwinBench;

TEST(ControlLine, AWordThatIsNoNumberIsRefusedByName) {
  TwinBench b;
  const std::pair<const char*, const char*> lines[] = {
      {"fault board garbage abc 1 0 8", "AT_S"},
      {"fault board garbage 0 inf 0 8", "FOR_S"},
      {"fault board garbage 0 1 2.5 8", "COUNT"},
      {"fault board garbage 0 1 -1 8", "COUNT"},
      {"fault board garbage 0 1 0 nan", "AMOUNT"},
      {"fault motor garbage 0 100000 5 1e18", "AMOUNT of a fault must be a number from 0 to 4096, not '1e18'"},
      {"fault board garbage 0 1 0 8x", "AMOUNT"},
      {"fault board saturated 0 1 0 0", "there is no fault 'saturated'"},
      {"fault motor saturation 0 1 0 0", "has no fault"},
      {"mount specimen=q50 seed=zz low_N=0.5 high_N=4", "seed of mount must be a whole number, not 'zz'"},
      {"mount specimen=q50 seed=-1 low_N=0.5 high_N=4", "seed"},
      {"mount specimen=q50 low_N=nan high_N=4", "low_N of mount must be a number"},
      {"mount specimen=q50 low_N=0.5 high_N=4 fault:sensor_gain=x", "fault:sensor_gain"},
      {"advance 1.5", "samples"},
      {"advance 10 board=x", "DEVICE=BYTES"},
      {"load heavy", "newtons"},
  };
  for (const auto& [line, said] : lines) {
    const auto told = b.hand->say(line);
    ASSERT_FALSE(told) << line;
    EXPECT_EQ(told.error().code, ErrorCode::usage) << line;
    EXPECT_NE(told.error().text.find(said), std::string::npos) << told.error().to_text();
  }
  b.say("mount specimen=q50 seed=7 low_N=0.5 high_N=4");
  b.say("fault board garbage 0 1 0 4096");
  b.say("fault clear");
}

TEST(ControlLine, AFaultOfSomeMessagesHitsThemInEveryRecord) {
  FaultScript script;
  const std::vector<std::string> words{"board", "drop", "0.5", "1e9", "2", "0"};
  auto entry = FaultScript::read_words(words);
  ASSERT_TRUE(entry) << entry.error().to_text();
  script.add(*entry);
  for (int record = 0; record < 2; ++record) {
    script.begin_record();
    EXPECT_FALSE(script.hit("board", WireFault::drop, 0.4));
    EXPECT_TRUE(script.hit("board", WireFault::drop, 0.5));
    EXPECT_TRUE(script.hit("board", WireFault::drop, 0.6));
    EXPECT_FALSE(script.hit("board", WireFault::drop, 0.7));
  }
}

TEST(ControlLine, MountingBeginsTheRecordOfTheFaults) {
  TwinBench b;
  b.mount();
  TwinBench::ok(b.session->open());
  b.say("fault reference reset 0.05 1e9 1 0");
  for (int record = 0; record < 2; ++record) {
    b.mount();
    TwinBench::ok(b.session->reference().start());
    std::vector<ReferenceReading> readings;
    for (int i = 0; i < 20; ++i) {
      TwinBench::ok(b.advance(0.01));
      TwinBench::ok(b.session->reference().poll(readings));
    }
    EXPECT_LT(readings.size(), 20U) << "the box forgets its stream at 0.05 s of record " << record;
    TwinBench::ok(b.session->reference().stop());
  }
}

// The bytes of garbage before a message say nothing of how late it comes.
TEST(WireFaults, GarbageDelaysNoMessageBehindADelayedOne) {
  FaultScript script;
  for (const std::vector<std::string>& words : {std::vector<std::string>{"reference", "delay", "0", "0.5", "0", "100"},
                                                std::vector<std::string>{"reference", "garbage", "0.6", "1e9", "0", "4000"}}) {
    auto entry = FaultScript::read_words(words);
    ASSERT_TRUE(entry);
    script.add(*entry);
  }
  emulated::Wire wire("reference", script, false);
  ASSERT_TRUE(wire.open_terminal(testing::TempDir() + "garbage_delay"));
  wire.send(nullptr, {1}, 0.4);
  wire.send_due(0.45);
  EXPECT_EQ(wire.terminal()->sent, 0U);
  wire.send(nullptr, {2}, 0.6);  // while the first still waits
  wire.send_due(0.7);
  EXPECT_EQ(wire.terminal()->sent, 4002U);
}

}  // namespace
}  // namespace forcegate
