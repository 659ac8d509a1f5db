#include "hil/trace/campaign.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

namespace forcegate {
namespace {

using ::testing::Contains;
using ::testing::EndsWith;
using ::testing::HasSubstr;
namespace fs = std::filesystem;

class ReadCampaign : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(::testing::TempDir()) / ("forcegate_campaign_" + std::to_string(::getpid()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  void put(const std::string& name, const std::string& text) { std::ofstream(folder_ / name, std::ios::binary) << text; }
  Error refusal() {
    const auto campaign = read_campaign(folder_);
    EXPECT_FALSE(campaign);
    return campaign ? Error{} : campaign.error();
  }
  fs::path folder_;
};

constexpr const char* kCsv = "t_s,F_ref_N,U_V,level_mm\n0,1,2,3\n0.1,2,3,4\n0.2,3,4,5\n";

TEST_F(ReadCampaign, TakesEveryFactOfADescribedCampaign) {
  put("r1.csv", kCsv);
  put("r2.csv", kCsv);
  put("campaign.json", R"({"campaign": "C01", "sensor": "A201",
    "bench": {"spring_N_per_mm": 0.25, "law": "F = k x", "voltage_range_V": [0, 10], "force_range_N": [0, 5],
              "reference_resolution_N": 0.025, "adc_bits": 12, "colour": "blue"},
    "records": [{"file": "r1.csv", "kind": "sine", "role": "fit", "fs_Hz": 10, "start_s": 1900, "rest_before_s": 677,
                 "excitation_start_s": 2, "dynamic": true, "f_min_Hz": 0.5, "A_N": 1.16, "m_N": 1.92, "drive_V": 5.0,
                 "eccentricity_mm": 11, "preload_mm": 1.6, "stimulus": {"f": 0.5}},
                {"file": "r2.csv", "role": "heldout"}]})");
  const auto c = read_campaign(folder_);
  ASSERT_TRUE(c) << c.error().to_text();
  EXPECT_EQ(c->name, "C01");
  EXPECT_EQ(c->bench.adc_bits, 12);
  EXPECT_EQ(c->bench.voltage_max_V, 10.0);
  EXPECT_TRUE(c->bench.reference_noise_N != c->bench.reference_noise_N);
  ASSERT_EQ(c->records.size(), 2u);
  const Record& r = c->records[0];
  EXPECT_EQ(r.name, "r1");
  EXPECT_EQ(r.kind, "sine");
  EXPECT_EQ(r.A_N, 1.16);
  EXPECT_EQ(r.rest_before_s, 677.0);
  EXPECT_EQ(r.dynamic, true);
  EXPECT_EQ(r.trace.find("U")->value[2], 4.0);
  EXPECT_NE(r.trace.find("level"), nullptr);
  EXPECT_EQ(c->records[1].role, RecordRole::heldout);
  EXPECT_FALSE(c->records[1].A_N.has_value());
  EXPECT_TRUE(read_campaign(folder_ / "campaign.json"));
}

TEST_F(ReadCampaign, TakesAFolderWithoutDescriptionInTheOrderOfNames) {
  put("b.csv", kCsv);
  put("a.csv", kCsv);
  put("notes.csv", "hello\nworld\n");
  put("readme.txt", "x");
  const auto c = read_campaign(folder_);
  ASSERT_TRUE(c) << c.error().to_text();
  ASSERT_EQ(c->records.size(), 2u);
  EXPECT_EQ(c->records[0].name, "a");
  EXPECT_FALSE(c->records[0].role_given);
  EXPECT_THAT(c->notes, Contains(HasSubstr("skipped notes.csv")));
}

TEST_F(ReadCampaign, TakesASingleCsv) {
  put("run.csv", kCsv);
  const auto c = read_campaign(folder_ / "run.csv");
  ASSERT_TRUE(c);
  EXPECT_EQ(c->name, "run");
  EXPECT_EQ(c->records.size(), 1u);
}

TEST_F(ReadCampaign, GivesTheDeclaredRateToAFileWithoutAClock) {
  put("r.csv", "F_ref_N,U_V\n1,2\n2,3\n");
  put("campaign.json", R"({"records": [{"file": "r.csv", "fs_Hz": 400}]})");
  const auto c = read_campaign(folder_);
  ASSERT_TRUE(c) << c.error().to_text();
  EXPECT_TRUE(c->records[0].trace.time_bases[0].invented);
  EXPECT_DOUBLE_EQ(c->records[0].trace.time_bases[0].t_s[1], 0.0025);
}

TEST_F(ReadCampaign, SaysWhereTheDescriptionIsWrong) {
  put("r.csv", kCsv);
  put("campaign.json", "{\"records\": [\n  {\"file\": \"r.csv\",,}\n]}");
  EXPECT_THAT(refusal().where, EndsWith("campaign.json:2:20"));
  put("campaign.json", "{\"records\": [\n  {\"file\": \"r.csv\",\n   \"A_N\": \"big\"}\n]}");
  EXPECT_THAT(refusal().where, EndsWith("campaign.json:3:4"));
  EXPECT_THAT(refusal().text, HasSubstr("\"A_N\" must be a number"));
  put("campaign.json", "{\"records\": [{\"file\": \"r.csv\", \"role\": \"test\"}]}");
  EXPECT_THAT(refusal().hint, HasSubstr("heldout"));
  put("campaign.json", "{\"records\": [{\"file\": \"gone.csv\"}]}");
  EXPECT_THAT(refusal().text, HasSubstr("gone.csv"));
  EXPECT_EQ(refusal().code, ErrorCode::io);
  put("campaign.json", "{\"records\": []}");
  EXPECT_THAT(refusal().text, HasSubstr("at least one record"));
  put("campaign.json", "[1]");
  EXPECT_THAT(refusal().text, HasSubstr("one object"));
}

TEST_F(ReadCampaign, PassesOnWhereACsvIsWrong) {
  put("r.csv", "t_s,F_ref_N\n0,1\n1,oops\n");
  put("campaign.json", R"({"records": [{"file": "r.csv"}]})");
  EXPECT_THAT(refusal().where, EndsWith("r.csv:3:3"));
}

TEST_F(ReadCampaign, RefusesAnEmptyFolderAndAMissingPath) {
  EXPECT_THAT(refusal().text, HasSubstr("neither"));
  EXPECT_EQ(read_campaign(folder_ / "nowhere").error().code, ErrorCode::io);
}

TEST_F(ReadCampaign, NotesAMappedColumnThatIsNotThere) {
  put("r.csv", kCsv);
  const auto c = read_campaign(folder_, {.column_map = {{"frce", "F_dut_N"}}, .assumed_rate_Hz = 0.0});
  ASSERT_TRUE(c);
  EXPECT_THAT(c->notes, Contains(HasSubstr("\"frce\"")));
}

}  // namespace
}  // namespace forcegate
