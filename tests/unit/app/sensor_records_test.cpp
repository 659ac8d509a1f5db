#include "hil/app/gate/sensor_records.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace forcegate::test {
namespace {

using namespace characterize;

std::vector<SensorRecord> two_records() {
  SensorRecord sound;
  sound.sensor = 3;
  sound.frames.force_N = {5.0, 10.0};
  sound.frames.oracle_N = {5.0 / 3.0, std::nan("")};
  sound.frames.conductance_N = {1e-300, -0.1};
  sound.frames.loading = {0, 3};
  sound.answers.force_N = {0.1f, -std::numeric_limits<double>::infinity()};
  sound.answers.flags = {0, 8};
  sound.accepted_N = {5.1, 10.2};
  SensorRecord broken = sound;
  broken.answers = {};
  broken.failure = Error{ErrorCode::firmware, "crashed \"here\"", "pack0-sensor4", "look"};
  return {sound, broken};
}

TEST(SensorRecords, come_back_to_the_last_bit) {
  const std::string text = to_text(two_records());
  const auto back = sensor_records_from(text, {}, "records.jsonl");
  ASSERT_TRUE(back.has_value()) << back.error().to_text();
  EXPECT_EQ(to_text(*back), text);
  EXPECT_EQ((*back)[0].frames.oracle_N[0], 5.0 / 3.0);
  EXPECT_TRUE(std::isnan((*back)[0].frames.oracle_N[1]));
  EXPECT_EQ((*back)[0].answers.force_N[1], -std::numeric_limits<double>::infinity());
  EXPECT_EQ((*back)[1].failure->text, "crashed \"here\"");
}

TEST(SensorRecords, damaged_lines_are_refused) {
  const std::string text = to_text(two_records());
  EXPECT_FALSE(sensor_records_from("{", {}, "r").has_value());
  EXPECT_FALSE(sensor_records_from("{\"sensor\":1}", {}, "r").has_value());
  std::string shorter = text;
  shorter.replace(shorter.find("[5.0,10.0]"), 10, "[5.0]");
  const auto uneven = sensor_records_from(shorter, {}, "r");
  ASSERT_FALSE(uneven.has_value());
  EXPECT_EQ(uneven.error().text, "the lists of a record are not of one length");
  std::string beyond = text;
  beyond.replace(beyond.find("[0,3]"), 5, "[0,4]");
  const auto more = sensor_records_from(beyond, {}, "r");
  ASSERT_FALSE(more.has_value()) << "the plan has three loadings, 3 is the last frames'";
  EXPECT_EQ(more.error().text, "a record has more loadings than its plan");
}

}  // namespace
}  // namespace forcegate::test
