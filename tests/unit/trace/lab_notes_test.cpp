#include "hil/trace/lab_notes.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "hil/trace/campaign.h"

namespace forcegate {
namespace {

LabNotes note(const std::string& name, const std::string& value) { return lab_notes({{name, value}}); }

TEST(LabNotes, AMountingIsReadUnderAnyNameAndOutOfWords) {
  EXPECT_EQ(note("mount_id", "2").mounting, "2");
  EXPECT_EQ(note("Mounting", "3").mounting, "3");
  EXPECT_EQ(note("mounting_no", "B").mounting, "b");
  EXPECT_EQ(note("note", "remounted, mounting 4").mounting, "4");
  EXPECT_EQ(note("comment", "Mounting no. 12, new cable").mounting, "12");
  EXPECT_EQ(note("remark", "mounting looked fine").mounting, "");
}

TEST(LabNotes, TellFromWhereOnTheSensorWasMountedAnew) {
  for (const char* text : {"remounted", "Sensor re-mounted after lunch", "new mounting", "mounted again", "newly mounted", "film reseated", "re-glued", "weights on, weights off; reglued", "taped again", "sensor placed anew",
                           "sensor taken off and re-positioned", "film re-inserted"})
    EXPECT_TRUE(note("note", text).remounted) << text;
  for (const char* text : {"not remounted", "same mounting as before", "no remount", "mounted on the steel plate", "new cable", "weights placed again", "specimen re-clamped", "glued to the plate", ""})
    EXPECT_FALSE(note("note", text).remounted) << text;
  EXPECT_TRUE(note("remounted", "true").remounted);
  EXPECT_FALSE(note("remounted", "false").remounted);
}

TEST(LabNotes, AStampHasADay) {
  EXPECT_EQ(note("time", "2026-03-02T10:01").stamp_s.value_or(0.0) - note("time", "2026-03-02T10:00").stamp_s.value_or(0.0), 60.0);
  EXPECT_FALSE(note("time", "10:01:00").stamp_s.has_value());
  EXPECT_FALSE(note("time", "morning").stamp_s.has_value());
}

class LabNotesOfACampaign : public ::testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directories(folder_); }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  // `records`: what stands in each beside its file.
  Campaign read(const std::vector<std::string>& records) {
    std::string list;
    for (std::size_t k = 0; k < records.size(); ++k) {
      const std::string file = "r" + std::to_string(k) + ".csv";
      std::ofstream(folder_ / file) << "t_s,F_ref_N,U_V\n0,0,0\n0.1,1,2\n0.2,2,4\n0.3,1," << 2 + k << "\n";
      list += (k > 0 ? ", " : "") + std::string("{\"file\": \"") + file + "\"" + (records[k].empty() ? "" : ", " + records[k]) + "}";
    }
    std::ofstream(folder_ / "campaign.json") << "{\"records\": [" << list << "]}";
    auto campaign = read_campaign(folder_);
    EXPECT_TRUE(campaign) << campaign.error().to_text();
    return campaign ? std::move(*campaign) : Campaign{};
  }
  static std::vector<std::string> mountings(const Campaign& c) {
    std::vector<std::string> out;
    for (const Record& r : c.records) out.push_back(r.mounting);
    return out;
  }

  const std::filesystem::path folder_ = std::filesystem::path(::testing::TempDir()) / (std::string("forcegate_lab_notes_") + ::testing::UnitTest::GetInstance()->current_test_info()->name());
};

TEST_F(LabNotesOfACampaign, CountMountingsFromTheRecordThatSaysSo) {
  EXPECT_EQ(mountings(read({"", "", R"("note": "remounted")", ""})), (std::vector<std::string>{"1", "1", "2", "2"}));
  EXPECT_EQ(mountings(read({R"("note": "mounting 1")", "", R"("note": "remounted, mounting 2")"})), (std::vector<std::string>{"1", "1", "2"}));
  EXPECT_EQ(mountings(read({R"("note": "mounting 1")", "", R"("note": "mounting 2")"})), (std::vector<std::string>{"1", "", "2"})) << "which of the two, nobody said";
  EXPECT_EQ(mountings(read({"", "", R"("note": "remounted, mounting 2")", "", R"("note": "remounted")"})),
            (std::vector<std::string>{"unnamed 1", "unnamed 1", "2", "2", "unnamed 2"}));
  EXPECT_EQ(mountings(read({"", R"("note": "mounting 2")", R"("note": "remounted")"})), (std::vector<std::string>{"2", "2", "unnamed 2"}));
  EXPECT_EQ(mountings(read({R"("mounting": "a")", R"("note": "remounted")"})), (std::vector<std::string>{"a", ""})) << "the key comes first";
  EXPECT_EQ(mountings(read({"", R"("note": "dry air")"})), (std::vector<std::string>{"", ""}));
}

TEST_F(LabNotesOfACampaign, GiveStartTimesWhereEveryRecordHasAStampAndNoneHasTheKey) {
  const Campaign c = read({R"("time": "2026-03-02T10:01")", R"("time": "2026-03-02T09:01")"});
  EXPECT_EQ(c.records.at(0).start_s, 3600.0);
  EXPECT_EQ(c.records.at(1).start_s, 0.0);
  EXPECT_FALSE(read({R"("time": "2026-03-02T10:01")", ""}).records.at(0).start_s.has_value());
  EXPECT_EQ(read({R"("start_s": 5, "time": "2026-03-02T10:01")", R"("start_s": 9, "time": "2026-03-02T11:01")"}).records.at(1).start_s, 9.0);
}

}  // namespace
}  // namespace forcegate
