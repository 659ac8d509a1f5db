#include "hil/trace/cycle_words.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "hil/trace/campaign.h"
#include "tests/support/folder_test.h"

namespace forcegate {
namespace {

TEST(CycleWords, OfARecordAreThoseBeforeIt) {
  for (const char* text : {"after 500 cycles", "after 500 fatigue cycles at 2 Hz", "500 endurance cycles before this run", "500 cycles since the last record", "cycles since the last run: 500",
                           "cycles_before 500", "ramp; 500 unrecorded cycles before"})
    EXPECT_EQ(cycles_in_words(text), 500.0) << text;
}

TEST(CycleWords, OtherCyclesAreNone) {
  for (const char* text : {"", "20 cycles at 1 Hz", "run 3 of the fatigue series", "cycles", "duty cycle 50 %", "500 cycles before, 300 cycles before", "1.5 cycles before the jump", "10k cycles before this run",
                           "after run 2: 20 cycles"})
    EXPECT_FALSE(cycles_in_words(text).has_value()) << text;
}

TEST(CycleWords, OfACampaignNameTheirRun) {
  const std::vector<double> expected{0.0, 200.0, 1500.0, 0.0};
  for (const char* text : {"unrecorded endurance cycles between runs: 200 before run 2; 1500 before run 3;", "200 cycles before record 2, 1500 cycles before record 3",
                           "cycles: 200 before run no. 2, 1500 before run #3"})
    EXPECT_EQ(cycles_of_runs(text, 4), expected) << text;
  EXPECT_TRUE(cycles_of_runs("rest of 200 s before run 2", 4).empty());
  EXPECT_TRUE(cycles_of_runs("200 cycles before run 7", 4).empty()) << "there is no such run";
  EXPECT_TRUE(cycles_of_runs("200 cycles before lunch at 12", 4).empty());
}

TEST(CycleWords, ARunningCountNeverFalls) {
  EXPECT_TRUE(is_running_count(std::vector<double>{0, 0, 500, 1500, 1500}));
  EXPECT_FALSE(is_running_count(std::vector<double>{0, 500, 500, 500})) << "as many before each";
  EXPECT_FALSE(is_running_count(std::vector<double>{0, 500, 200, 1500}));
  EXPECT_FALSE(is_running_count(std::vector<double>{0, 500, 1500})) << "three records say little";
}

class CyclesOfACampaign : public FolderTest {
 protected:
  Campaign read(const std::string& members, const std::vector<std::string>& of_records) {
    std::string json = "{" + members + "\"records\": [";
    for (std::size_t k = 0; k < of_records.size(); ++k) {
      const std::string name = "r" + std::to_string(k + 1) + ".csv";
      const std::string level = std::to_string(k);  // no record repeats another
      put(name, "t_s,F_ref_N,U_V\n0,1," + level + "\n0.1,2,3\n0.2,3,4\n");
      json += std::string(k > 0 ? ", " : "") + R"({"file": ")" + name + R"(", "start_s": )" + std::to_string(100 * k) + of_records[k] + "}";
    }
    put("campaign.json", json + "]}");
    auto campaign = read_campaign(folder_);
    EXPECT_TRUE(campaign) << campaign.error().to_text();
    return campaign ? *campaign : Campaign{};
  }
  static std::vector<double> cycles(const Campaign& campaign) {
    std::vector<double> out;
    for (const Record& r : campaign.records) out.push_back(r.cycles_before.value_or(-1.0));
    return out;
  }
};

TEST_F(CyclesOfACampaign, AreThoseSinceTheRecordBefore) {
  EXPECT_EQ(cycles(read("", {"", R"(, "cycles_before": 500)", R"(, "cycles_before": 200)"})), (std::vector<double>{-1.0, 500.0, 200.0}));
}

TEST_F(CyclesOfACampaign, ARunningCountIsWhatEachRecordAdds) {
  const Campaign read_as = read("", {R"(, "cycles_before": 0)", R"(, "cycles_before": 500)", R"(, "cycles_before": 500)", R"(, "cycles_before": 2000)"});
  EXPECT_EQ(cycles(read_as), (std::vector<double>{0.0, 500.0, 0.0, 1500.0}));
  EXPECT_TRUE(std::ranges::any_of(read_as.notes, [](const std::string& n) { return n.find("count of all cycles") != std::string::npos; }));
}

TEST_F(CyclesOfACampaign, AreTakenFromWordsWhereNoRecordHasTheKey) {
  EXPECT_EQ(cycles(read(R"("note": "200 fatigue cycles before run 2; 1500 before run 3", )", {"", "", ""})), (std::vector<double>{0.0, 200.0, 1500.0}));
  EXPECT_EQ(cycles(read(R"("note": "200 cycles before run 2", )", {"", R"(, "cycles_before": 7)", ""})), (std::vector<double>{-1.0, 7.0, -1.0}));
  EXPECT_EQ(cycles(read("", {"", R"(, "note": "after 300 cycles")"})), (std::vector<double>{-1.0, 300.0}));
}

}  // namespace
}  // namespace forcegate
