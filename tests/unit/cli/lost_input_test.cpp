#include "hil/cli/lost_input.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/folder_test.h"

namespace forcegate {
namespace {

using ::testing::HasSubstr;

const Command& row() {
  static const Command kRow{.name = "play",
                            .group = "",
                            .summary = "",
                            .description = "",
                            .positionals = {{.name = "CAMPAIGN", .doc = "", .names = Names::campaign}},
                            .options = {{.name = "output", .value_name = "FILE", .doc = "", .letter = 'o', .names = Names::file},
                                        {.name = "html", .value_name = "FILE", .doc = "", .names = Names::file},
                                        {.name = "model", .value_name = "MODEL", .doc = "", .names = Names::input},
                                        {.name = "into", .value_name = "DIR", .doc = "", .names = Names::records},
                                        {.name = "seed", .value_name = "N", .doc = ""}}};
  return kRow;
}

class LostInput : public FolderTest {
 protected:
  std::string at(const std::string& name) const { return (folder_ / name).string(); }
  static std::optional<Error> of(const std::string& campaign, const std::string& option, const std::string& value) {
    return lost_input(row(), {{"CAMPAIGN", campaign}, {option, value}});
  }
};

TEST_F(LostInput, StandardOutputIsNoFile) {
  for (const char* option : {"output", "html", "into"}) {
    const auto error = of(at("run.csv"), option, "-");
    ASSERT_TRUE(error) << option;
    EXPECT_THAT(error->text, HasSubstr("\"-\" names no file"));
    EXPECT_THAT(error->where, ::testing::EndsWith(" -"));
  }
  EXPECT_FALSE(of(at("run.csv"), "output", "./-"));
  EXPECT_FALSE(of("-", "seed", "1"));
}

TEST_F(LostInput, AnOutputThatIsAnInputIsRefusedUnderAnyNameOfIt) {
  put("run.csv", "t_s\n"), put("m.toml", "");
  std::filesystem::create_symlink("run.csv", folder_ / "link.csv");
  for (const std::string& output : {at("run.csv"), at("./run.csv"), at("link.csv")}) {
    const auto error = of(at("run.csv"), "output", output);
    ASSERT_TRUE(error) << output;
    EXPECT_EQ(error->text, "input and output are the same file");
    EXPECT_EQ(error->where, output);
    EXPECT_EQ(error->hint, "choose another name for -o");
  }
  EXPECT_THAT(of(at("run.csv"), "html", at("run.csv"))->hint, HasSubstr("--html"));
  EXPECT_TRUE(lost_input(row(), {{"model", at("m.toml")}, {"output", at("m.toml")}}));
  EXPECT_FALSE(of(at("run.csv"), "output", at("better.toml")));
  EXPECT_FALSE(of(at("run.csv"), "seed", at("run.csv"))) << "what names no file writes none";
}

TEST_F(LostInput, WhatACampaignIsMadeOfIsRefusedAndWhatLiesBesideItIsNot) {
  put("film/campaign.json", "{}"), put("film/day1/sine.csv", "t_s\n"), put("film/model.toml", ""), put("film/page.html", "");
  for (const std::string& campaign : {at("film"), at("film/campaign.json"), at("film/")}) {
    for (const char* output : {"film/campaign.json", "film/day1/sine.csv"}) {
      const auto error = of(campaign, "html", at(output));
      ASSERT_TRUE(error) << campaign << " " << output;
      EXPECT_EQ(error->where, at(output));
    }
    for (const char* output : {"film/model.toml", "film/page.html", "film/new.csv"}) EXPECT_FALSE(of(campaign, "html", at(output))) << campaign << " " << output;
  }
}

TEST_F(LostInput, AFolderOfRecordingsIsNotTheFolderThatIsRead) {
  put("film/sine.csv", "t_s\n");
  for (const auto& [campaign, into] : {std::pair{"film", "film"}, {"film", "film/../film"}, {"film/sine.csv", "film"}}) {
    const auto error = of(at(campaign), "into", at(into));
    ASSERT_TRUE(error) << campaign;
    EXPECT_THAT(error->hint, HasSubstr("--into"));
  }
  EXPECT_FALSE(of(at("film"), "into", at("film/new")));
  EXPECT_FALSE(of(at("film/sine.csv"), "into", folder_.string()));
}

TEST_F(LostInput, ABundleIsOneWhateverIsRead) {
  put("run/bundle.json", "{}"), put("run/result.json", "{}"), put("run/bundle/plan.toml", ""), put("run/report.html", ""), put("one/result.json", "{}"), put("a.csv", "t_s\n");
  for (const char* output : {"run/bundle.json", "run/result.json", "run/bundle/plan.toml"}) EXPECT_TRUE(of(at("a.csv"), "output", at(output))) << output;
  for (const char* output : {"run/report.html", "run/bundle/new.toml", "one/result.json"}) EXPECT_FALSE(of(at("a.csv"), "output", at(output))) << output;
}

TEST_F(LostInput, ARecordingIsReplacedByAVerbThatHasForceAlone) {
  put("a.csv", "t_s\n"), put("b.csv", "t_s\n"), put("other/campaign.json", "{}");
  for (const char* output : {"b.csv", "other/campaign.json"}) {
    const auto error = of(at("a.csv"), "output", at(output));
    ASSERT_TRUE(error) << output;
    EXPECT_THAT(error->text, HasSubstr("a recording"));
  }
  EXPECT_FALSE(of(at("a.csv"), "output", at("new.csv")));
  Command forced = row();
  forced.options.push_back({.name = "force", .value_name = "", .doc = ""});
  EXPECT_FALSE(lost_input(forced, {{"CAMPAIGN", at("a.csv")}, {"output", at("b.csv")}})) << "it asks itself";
}

TEST_F(LostInput, TwoOutputsAreTwoFiles) {
  const auto error = lost_input(row(), {{"output", at("b.toml")}, {"html", at("./b.toml")}});
  ASSERT_TRUE(error);
  EXPECT_THAT(error->text, HasSubstr("-o and --html"));
  EXPECT_FALSE(lost_input(row(), {{"output", at("b.toml")}, {"html", at("b.html")}}));
  EXPECT_FALSE(lost_input(row(), {{"output", "/dev/null"}, {"html", "/dev/null"}}));
}

}  // namespace
}  // namespace forcegate
