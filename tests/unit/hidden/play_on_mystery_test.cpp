// The sensor of a mystery stays at hand: further records of it, without a word about what is hidden.

#include <gtest/gtest.h>

#include <filesystem>

#include <nlohmann/json.hpp>

#include "hil/app/mystery/mystery.h"
#include "tests/support/process.h"

namespace forcegate {
namespace {

namespace fs = std::filesystem;

std::string made(const test::TemporaryFolder& folder, const std::string& name) {
  MysteryRequest request;
  request.seed = 5;
  request.folder = folder / name;
  request.effect = "hysteresis";
  request.strength = "strong";
  request.minutes = 2.0;
  EXPECT_TRUE(make_mystery(request, {}).has_value());
  return folder / name;
}

MysterySegment triangle() {
  return {"triangle", "ramp", {0.0, 10.0, 20.0, 30.0, 40.0}, {0.2, 4.0, 0.2, 4.0, 0.2}};
}

TEST(PlayOnMystery, AppendsRecordsOfTheSameSensorAndRepeatsThemBitForBit) {
  const test::TemporaryFolder folder;
  const std::string one = made(folder, "m"), again = made(folder, "n");
  const auto before = nlohmann::json::parse(test::read_text(one + "/campaign.json"));
  const auto files = play_on_mystery(one, {triangle()});
  ASSERT_TRUE(files.has_value()) << files.error().to_text();
  ASSERT_EQ(files->size(), 1u);
  const auto after = nlohmann::json::parse(test::read_text(one + "/campaign.json"));
  ASSERT_EQ(after["records"].size(), before["records"].size() + 1);
  EXPECT_EQ(after["records"].back()["file"], files->front());
  const std::string csv = test::read_text(one + "/" + files->front());
  const std::string own = test::read_text(one + "/" + before["records"][0]["file"].get<std::string>());
  EXPECT_EQ(csv.substr(0, csv.find('\n')), own.substr(0, own.find('\n')));
  EXPECT_GT(csv.size(), 100000u);
  ASSERT_TRUE(play_on_mystery(again, {triangle()}).has_value());
  EXPECT_EQ(test::read_text(again + "/" + files->front()), csv);
  EXPECT_EQ(after.dump().find("hysteresis"), std::string::npos);
  // another record of the same sensor is not the same record
  const auto more = play_on_mystery(one, {triangle()});
  ASSERT_TRUE(more.has_value());
  EXPECT_NE(test::read_text(one + "/" + more->front()), csv);
}

// The sensor has felt what was played before, and the clock has counted it: played one after the other or at once, it is one sensor.
TEST(PlayOnMystery, ASecondTimeGoesOnBehindTheFirst) {
  const test::TemporaryFolder folder;
  const std::string one = made(folder, "m"), again = made(folder, "n");
  const MysterySegment ramp{"ramp", "ramp", {0.0, 15.0, 30.0}, {0.2, 3.0, 1.0}};
  ASSERT_TRUE(play_on_mystery(one, {triangle()}).has_value());
  const auto second = play_on_mystery(one, {ramp}), both = play_on_mystery(again, {triangle(), ramp});
  ASSERT_TRUE(second.has_value()) << second.error().to_text();
  ASSERT_TRUE(both.has_value()) << both.error().to_text();
  EXPECT_EQ(second->front(), both->back());
  EXPECT_TRUE(test::read_text(one + "/" + second->front()) == test::read_text(again + "/" + both->back()));
  const auto records = nlohmann::json::parse(test::read_text(one + "/campaign.json"))["records"];
  const auto &last = records[records.size() - 1], &before = records[records.size() - 2];
  ASSERT_TRUE(last.contains("start_s")) << last;
  EXPECT_GE(last["start_s"].get<double>(), before["start_s"].get<double>() + before["duration_s"].get<double>());
}

TEST(PlayOnMystery, ANewMysteryInItsPlaceHasFeltNothing) {
  const test::TemporaryFolder folder;
  const std::string one = made(folder, "m"), again = made(folder, "n");
  ASSERT_TRUE(play_on_mystery(one, {triangle()}).has_value());
  MysteryRequest request;
  request.seed = 5;
  request.folder = one;
  request.effect = "hysteresis";
  request.strength = "strong";
  request.minutes = 2.0;
  request.overwrite = true;
  ASSERT_TRUE(make_mystery(request, {}).has_value());
  const auto files = play_on_mystery(one, {triangle()}), same = play_on_mystery(again, {triangle()});
  ASSERT_TRUE(files.has_value() && same.has_value());
  EXPECT_TRUE(test::read_text(one + "/" + files->front()) == test::read_text(again + "/" + same->front()));
}

TEST(PlayOnMystery, ForcesThatCannotBeReadAreNotForgotten) {
  const test::TemporaryFolder folder;
  const std::string one = made(folder, "m");
  ASSERT_TRUE(play_on_mystery(one, {triangle()}).has_value());
  test::write_text(one + "/played_forces.json", "{\"format\": 1}");
  const auto refused = play_on_mystery(one, {triangle()});
  ASSERT_FALSE(refused.has_value());
  EXPECT_NE(refused.error().where.find("played_forces.json"), std::string::npos) << refused.error().to_text();
}

TEST(PlayOnMystery, RefusesASealThatWasChangedAndAForceThatIsNone) {
  const test::TemporaryFolder folder;
  const std::string one = made(folder, "m");
  EXPECT_FALSE(play_on_mystery(one, {{"empty", "ramp", {0.0}, {1.0}}}).has_value());
  auto sheet = nlohmann::json::parse(test::read_text(one + "/sealed_truth.json"));
  sheet["nonce"] = std::string(32, '0');
  test::write_text(one + "/sealed_truth.json", sheet.dump());
  const auto refused = play_on_mystery(one, {triangle()});
  ASSERT_FALSE(refused.has_value());
  EXPECT_FALSE(is_mystery(folder.path()));
}

}  // namespace
}  // namespace forcegate
