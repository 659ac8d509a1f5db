// The seal of a mystery is opened for an answer to this mystery, and a mystery that was not finished is no campaign.

#include "hil/app/mystery/reveal.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "hil/app/mystery/mystery.h"
#include "hil/trace/campaign.h"
#include "tests/support/process.h"

namespace forcegate {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

MysteryRequest small(const fs::path& folder) {
  MysteryRequest request;
  request.seed = 5;
  request.folder = folder;
  request.effect = "hysteresis";
  request.strength = "strong";
  request.minutes = 1.0;
  return request;
}

class Reveal : public ::testing::Test {
 protected:
  void SetUp() override { ASSERT_TRUE(make_mystery(small(folder_ / "m"), {})); }
  Result<RevealResult> asked(const std::string& answer) const {
    test::write_text(folder_ / "answer.json", answer);
    return reveal({folder_ / "m", folder_ / "answer.json", ""});
  }

  test::TemporaryFolder folder_;
};

TEST_F(Reveal, AnAnswerToAnotherCampaignOpensNothing) {
  const auto other = asked(R"({"campaign": "other", "verdict": "known", "findings": [{"effect": "hysteresis"}]})");
  ASSERT_FALSE(other);
  EXPECT_THAT(other.error().to_text(), AllOf(HasSubstr("the answer to the campaign \"other\", and this one is \"m\""), HasSubstr("stays closed"), HasSubstr("answer.json"),
                                             HasSubstr("forcegate diagnose ")));
  for (const char* named : {R"("campaign": "m", )", R"("campaign": "m_r01", )", ""}) {
    const auto own = asked("{" + std::string(named) + R"("verdict": "known", "findings": [{"effect": "hysteresis"}]})");
    ASSERT_TRUE(own) << named << own.error().to_text();
    EXPECT_TRUE(own->right) << named;
  }
}

TEST_F(Reveal, AClaimOfWhatWasNotHiddenIsToldBesideARightName) {
  const auto both = asked(R"({"campaign": "m", "verdict": "known", "findings": [{"effect": "hysteresis", "probability": 0.9}, {"effect": "creep", "probability": 0.7}]})");
  ASSERT_TRUE(both) << both.error().to_text();
  EXPECT_TRUE(both->right);
  EXPECT_THAT(both->sentence, HasSubstr("The answer also claims creep, which was not hidden."));
  const auto one = asked(R"({"campaign": "m", "verdict": "known", "findings": [{"effect": "hysteresis", "probability": 0.9}, {"effect": "creep", "probability": 0.3}]})");
  ASSERT_TRUE(one);
  EXPECT_THAT(one->sentence, Not(HasSubstr("also claims")));
}

TEST_F(Reveal, WhatIsListedFirstAndNotClaimedWasNotTheAnswer) {
  const auto sentence = [&](const std::string& answer) {
    const auto asked_for = asked(answer);
    EXPECT_TRUE(asked_for && !asked_for->right) << answer;
    return asked_for ? asked_for->sentence : std::string();
  };
  EXPECT_THAT(sentence(R"({"campaign": "m", "verdict": "none", "findings": [{"effect": "hysteresis", "probability": 0.49}]})"),
              HasSubstr("Wrong: hidden was hysteresis, in the answer it is listed first, but not claimed (0.49)."));
  EXPECT_THAT(sentence(R"({"campaign": "m", "verdict": "unknown", "findings": [{"effect": "hysteresis", "probability": 0.8}]})"),
              HasSubstr("listed first, but the verdict is \"unknown\"."));
  EXPECT_THAT(sentence(R"({"campaign": "m", "verdict": "none", "findings": [{"effect": "creep", "probability": 0.3}]})"),
              HasSubstr("hidden was hysteresis, in the answer creep is listed first, but not claimed (0.3)."));
  EXPECT_THAT(sentence(R"({"campaign": "m", "verdict": "known", "findings": [{"effect": "creep", "probability": 0.9}]})"), HasSubstr(", the answer was creep."));
}

TEST_F(Reveal, AFileThatIsNoAnswerIsToldWithoutTheNamesOfALibrary) {
  for (const char* text : {"t_s,F_ref_N\n", "{\"a\": 1}", "{\"verdict\": 3}"}) {
    const auto none = asked(text);
    ASSERT_FALSE(none) << text;
    EXPECT_THAT(none.error().to_text(), AllOf(HasSubstr("this is not an answer of diagnose: "), Not(HasSubstr("json.exception")), HasSubstr("help: "), HasSubstr("answer.json")));
  }
}

TEST(Mystery, APairHasTwoDifferentEffects) {
  const test::TemporaryFolder folder;
  MysteryRequest request = small(folder / "m");
  request.effect.clear();
  request.pair = {"creep", "creep"};
  const auto made = make_mystery(request, {});
  ASSERT_FALSE(made);
  EXPECT_THAT(made.error().to_text(), AllOf(HasSubstr("both effects of the pair are creep"), HasSubstr("--effect creep")));
  EXPECT_FALSE(fs::exists(fs::path(folder / "m") / "campaign.json"));
}

TEST(Mystery, WhatWasInterruptedTakesBackItsOwnFilesAndTheSameCommandWorksAgain) {
  const test::TemporaryFolder folder;
  const fs::path there = folder / "there", fresh = folder / "fresh";
  fs::create_directory(there);
  test::write_text(there / "mine.csv", "t_s,F_ref_N,U_V\n");
  for (const fs::path& at : {there, fresh}) {
    MysteryRequest request = small(at);
    int asked = 0;
    request.interrupted = [&] { return ++asked > 3; };
    bool committed = false;
    const auto torso = make_mystery(request, [&](const std::string&) { committed = !fs::exists(at / "campaign.json"); });
    ASSERT_FALSE(torso);
    EXPECT_TRUE(committed) << "the hash comes before the first file";
    EXPECT_EQ(torso.error().code, ErrorCode::cancelled);
    EXPECT_THAT(torso.error().to_text(), AllOf(HasSubstr("what was written is taken back"), HasSubstr(at.string()), HasSubstr("the same command")));
    EXPECT_EQ(fs::exists(at), at == there);
    if (at == there) {
      EXPECT_EQ(std::distance(fs::directory_iterator(at), {}), 1) << "what was there stays";
    }
    request.interrupted = {};
    EXPECT_TRUE(make_mystery(request, {}));
  }
}

TEST(Mystery, OneThatWasLeftHalfWrittenIsNoCampaign) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(make_mystery(small(folder / "m"), {}));
  std::vector<fs::path> records;
  for (const auto& file : fs::directory_iterator(folder / "m"))
    if (file.path().extension() == ".csv") records.push_back(file.path());
  const fs::file_time_type described = fs::last_write_time(fs::path(folder / "m") / "campaign.json");
  for (const fs::path& record : records) EXPECT_LE(described, fs::last_write_time(record)) << "the description comes first";
  fs::remove(records.front());
  const auto torso = read_campaign(folder / "m");
  ASSERT_FALSE(torso);
  EXPECT_THAT(torso.error().text, AllOf(HasSubstr(records.front().filename().string()), HasSubstr("does not exist")));
}

}  // namespace
}  // namespace forcegate
