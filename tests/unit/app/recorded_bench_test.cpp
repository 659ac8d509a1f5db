// On which bench a campaign goes on.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "hil/app/recording/recorded_bench.h"
#include "tests/support/fake_rig.h"
#include "tests/support/folder_test.h"

namespace forcegate::test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using Json = nlohmann::json;
using Settings = std::map<std::string, std::string>;

/// Has two options, of which one has a value of its own.
class SetRig final : public testing::FakeRig {
 public:
  explicit SetRig(Settings given) : settings_(std::move(given)) { settings_.try_emplace("bits", "16"); }
  Settings settings() const override { return settings_; }

 private:
  Settings settings_;
};

const Registration<RigKind> kRig{{"set", "for tests", [](const Settings& given) -> Result<std::unique_ptr<Rig>> { return std::make_unique<SetRig>(given); }}};

Json campaign() {
  return {{"sensor", "a sensor, specimen q38"},
          {"recorded_with", {{"rig", "set/1"}, {"seed", 3u}, {"session", 1u}, {"rate_Hz", 100.0}, {"rig_rate_Hz", 1000.0}, {"rig_options", {{"bits", "16"}, {"hidden", "creep:0.2"}}}}}};
}

RecordingBench the_same() {
  RecordingBench bench;
  bench.rig = "set", bench.specimen = "q38", bench.seed = 3, bench.rate_Hz = 100.0;
  bench.rig_options = {{"hidden", "creep:0.2"}};
  return bench;
}

TEST(RecordedBench, TellsEveryOptionThatDiffersAndNoneThatIsItsDefault) {
  const auto there = recorded_bench(campaign().dump());
  ASSERT_TRUE(there);
  RecordingBench asked = the_same();
  EXPECT_THAT(*differences(*there, asked), IsEmpty());
  asked.rig_options["bits"] = "16";
  EXPECT_THAT(*differences(*there, asked), IsEmpty());
  asked.rig_options = {{"bits", "10"}};
  asked.seed = 4;
  EXPECT_THAT(*differences(*there, asked),
              ElementsAre("seed 3 there, 4 asked", "rig option bits 16 there, 10 asked", "rig option hidden creep:0.2 there, none asked"));
  Json sealed = campaign();
  sealed["recorded_with"]["rig_options"]["hidden"] = "sealed:abc";
  EXPECT_THAT(*differences(*recorded_bench(sealed.dump()), the_same()), ElementsAre("rig option hidden another there"));
}

TEST(RecordedBench, OfACampaignThatWasWrittenBeforeItsOptionsWereIsAsOld) {
  Json old = campaign();
  old["recorded_with"].erase("rig_options");
  RecordingBench asked = the_same();
  asked.rig_options = {{"bits", "10"}};
  EXPECT_THAT(*differences(*recorded_bench(old.dump()), asked), IsEmpty());
  EXPECT_FALSE(recorded_bench("{\"records\": []}"));
}

class BenchToGoOnTest : public FolderTest {
 protected:
  void write(const Json& json) { std::ofstream(folder_ / "campaign.json") << json; }
};

TEST_F(BenchToGoOnTest, IsThatOfTheCampaignWhereNothingElseIsGiven) {
  write(campaign());
  GivenBench given;
  given.rig = "set";
  for (const auto& path : {folder_, folder_ / "campaign.json"}) {
    const auto made = bench_to_go_on(path, given);
    ASSERT_TRUE(made);
    EXPECT_TRUE(made->known);
    EXPECT_EQ(made->bench.specimen, "q38");
    EXPECT_EQ(made->bench.seed, 3u);
    EXPECT_EQ(made->bench.rate_Hz, 100.0);
    EXPECT_EQ(made->bench.rig_options, (Settings{{"bits", "16"}, {"hidden", "creep:0.2"}}));
  }
}

TEST_F(BenchToGoOnTest, RefusesWhatContradictsTheCampaign) {
  write(campaign());
  GivenBench given;
  given.rig = "set";
  given.rig_options = {{"hidden", "creep:0.2"}};
  EXPECT_TRUE(bench_to_go_on(folder_, given));
  given.rig_options = {{"bits", "10"}};
  given.specimen = "q50";
  const auto other = bench_to_go_on(folder_, given);
  ASSERT_FALSE(other);
  EXPECT_EQ(other.error().code, ErrorCode::usage);
  EXPECT_THAT(other.error().text, HasSubstr("specimen q38 there, q50 asked; rig option bits 16 there, 10 asked"));
  EXPECT_THAT(other.error().hint, HasSubstr("leave --specimen, --seed and --rig-option out"));
}

TEST_F(BenchToGoOnTest, RefusesAnotherRigThanThatOfTheCampaignButNotRecordings) {
  write(campaign());
  GivenBench given;
  given.rig = "another";
  const auto other = bench_to_go_on(folder_, given);
  ASSERT_FALSE(other);
  EXPECT_EQ(other.error().code, ErrorCode::usage);
  EXPECT_THAT(other.error().text, HasSubstr("rig set there, another asked"));
  EXPECT_THAT(other.error().hint, HasSubstr("with --rig set: another rig holds another sensor"));
  EXPECT_THAT(other.error().hint, HasSubstr("--rig replay --record FILE"));
  given.rig = "replay";
  EXPECT_TRUE(bench_to_go_on(folder_, given));
}

TEST_F(BenchToGoOnTest, RefusesAnotherBenchFileThanThatOfTheCampaign) {
  Json by_bench = campaign();
  by_bench["recorded_with"]["rig_id"] = "bench-7";
  write(by_bench);
  GivenBench given;
  given.rig = "set";
  const auto other = bench_to_go_on(folder_, given);
  ASSERT_FALSE(other);
  EXPECT_THAT(other.error().text, HasSubstr("bench bench-7 there, "));
  EXPECT_THAT(other.error().hint, HasSubstr("give the bench file of the bench that recorded it"));
}

TEST_F(BenchToGoOnTest, IsTheGivenOneWhereNobodyKnownRecorded) {
  Json unknown = campaign();
  unknown.erase("recorded_with");
  write(unknown);
  GivenBench given;
  given.rig = "another";
  given.seed = 7;
  const auto other = bench_to_go_on(folder_, given);
  ASSERT_TRUE(other);
  EXPECT_FALSE(other->known);
  EXPECT_EQ(other->bench.specimen, "q50");
  EXPECT_EQ(other->bench.seed, 7u);
  EXPECT_FALSE(bench_to_go_on(folder_ / "no.csv", given)->known);
}

}  // namespace
}  // namespace forcegate::test
