// What read_campaign does about records that cannot be what they are said to be, and about channels of two rates.

#include "hil/trace/campaign_checks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>

#include "hil/trace/common_clock.h"
#include "tests/support/folder_test.h"

namespace forcegate {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;
namespace fs = std::filesystem;

class CheckedCampaign : public FolderTest {
 protected:
  // 200 rows at 10 Hz; `row` writes what stands behind the time
  void put_rows(const std::string& name, const std::string& header, const std::function<std::string(int)>& row) const {
    std::string text = header + "\n";
    for (int i = 0; i < 200; ++i) text += std::to_string(0.1 * i) + "," + row(i) + "\n";
    put(name, text);
  }
  void put_wave(const std::string& name, double phase) const {
    put_rows(name, "t_s,F_ref_N,U_V", [&](int i) { return std::to_string(force(i, phase)) + "," + std::to_string(2.0 * force(i, phase)); });
  }
  static double force(int i, double phase) { return 2.0 + std::sin(0.1 * i + phase); }
  Campaign read(const CampaignOptions& options = {}) const {
    auto campaign = read_campaign(folder_, options);
    EXPECT_TRUE(campaign) << (campaign ? "" : campaign.error().to_text());
    return campaign ? std::move(*campaign) : Campaign{};
  }
  std::string refusal() const {
    const auto campaign = read_campaign(folder_);
    EXPECT_FALSE(campaign);
    return campaign ? "" : campaign.error().to_text();
  }
};

TEST_F(CheckedCampaign, TakesACopyOnce) {
  put_wave("a.csv", 0.0);
  put_wave("b.csv", 1.0);
  put_wave("c.csv", 0.0);
  const Campaign folder = read();
  ASSERT_EQ(folder.records.size(), 2u);
  EXPECT_THAT(folder.notes, Contains(HasSubstr("c repeats a sample by sample")));
  put("campaign.json", R"({"records": [{"file": "a.csv"}, {"file": "b.csv"}, {"file": "a.csv", "role": "heldout"}]})");
  const Campaign listed = read();
  ASSERT_EQ(listed.records.size(), 2u);
  EXPECT_EQ(listed.records[0].role, RecordRole::fit);
  EXPECT_THAT(listed.notes, Contains(HasSubstr("cannot be fitted and held out at once")));
}

TEST_F(CheckedCampaign, SkipsWhatInAFolderCannotStandBesideTheOtherRecords) {
  put_wave("a.csv", 0.0);
  put("five.csv", "t_s,F_ref_N,U_V\n0,1,2\n1,2,3\n2,3,4\n3,4,5\n4,5,6\n");
  put_rows("level.csv", "t_s,level_mm", [](int i) { return std::to_string(i); });
  const Campaign campaign = read();
  ASSERT_EQ(campaign.records.size(), 1u);
  EXPECT_EQ(campaign.records.front().name, "a");
  EXPECT_THAT(campaign.notes, Contains("skipped five.csv: the record has only 5 samples, at least 16 are needed"));
  EXPECT_THAT(campaign.notes, Contains("skipped level.csv: no column is the reference force: there are level_m"));
  put("campaign.json", R"({"records": [{"file": "a.csv"}, {"file": "five.csv"}]})");
  EXPECT_EQ(read().records.size(), 2u) << "what is listed is meant";
}

TEST_F(CheckedCampaign, KeepsAFolderInWhichNoRecordIsLongEnough) {
  for (const char* name : {"a.csv", "b.csv"}) put(name, "t_s,F_ref_N,U_V\n0,1,2\n1,2,3\n");
  EXPECT_EQ(read().records.size(), 2u);
}

TEST_F(CheckedCampaign, KeepsRecordsThatRestAtTheSameCode) {
  for (const char* name : {"a.csv", "b.csv"}) put_rows(name, "t_s,F_ref_N,U_V", [](int) { return "1,2"; });
  EXPECT_EQ(read().records.size(), 2u);
}

TEST_F(CheckedCampaign, NotesThatEveryRecordIsHeldOut) {
  put_wave("a.csv", 0.0);
  put_wave("b.csv", 1.0);
  put("campaign.json", R"({"records": [{"file": "a.csv", "role": "heldout"}, {"file": "b.csv", "role": "heldout"}]})");
  EXPECT_THAT(read().notes, Contains(HasSubstr("every record is held out")));
  put("campaign.json", R"({"records": [{"file": "a.csv"}, {"file": "b.csv", "role": "heldout"}]})");
  EXPECT_THAT(read().notes, Not(Contains(HasSubstr("every record is held out"))));
}

TEST_F(CheckedCampaign, NotesARestThatTheStartTimesLeaveNoRoomFor) {
  for (int i = 0; i < 4; ++i) put_wave(std::string(1, static_cast<char>('a' + i)) + ".csv", i);  // 19.9 s each
  const auto notes = [&](const std::string& b, const std::string& c = R"("start_s": 2000)", const std::string& kind_of_b = "") {
    put("campaign.json", R"({"records": [{"file": "a.csv", "start_s": 0, "rest_before_s": 7200}, {"file": "b.csv", )" + b + kind_of_b + R"(}, {"file": "c.csv", )" + c + "}]}");
    return read().notes;
  };
  const auto note = HasSubstr("rest_before_s of b (7200 s) is longer than the 980 s from the end of a to its start_s");
  EXPECT_THAT(notes(R"("start_s": 1000, "rest_before_s": 7200)"), Contains(note));
  EXPECT_THAT(notes(R"("start_s": 1000, "rest_before_s": 7200)"), Contains(HasSubstr("start_s counts for order and times")));
  EXPECT_THAT(notes(R"("start_s": 1000, "rest_before_s": 7200)", R"("start_s": 2000, "rest_before_s": 4000)"), Contains(HasSubstr("and the like in c")));
  EXPECT_THAT(notes(R"("start_s": 1000, "rest_before_s": 1000)"), Not(Contains(HasSubstr("rest_before_s")))) << "written down to the minute";
  EXPECT_THAT(notes(R"("start_s": 1000, "rest_before_s": 100)"), Not(Contains(HasSubstr("rest_before_s")))) << "it may have been cycled in between";
  EXPECT_THAT(notes(R"("start_s": 1000)", R"("start_s": 2000, "rest_before_s": 1900)", R"(, "kind": "rest")"), Not(Contains(HasSubstr("rest_before_s"))));
}

TEST_F(CheckedCampaign, RefusesABenchThatCannotBe) {
  put_wave("a.csv", 0.0);
  for (const auto& [bench, says] : {std::pair{R"("adc_bits": 0)", "between 1 and 32"}, std::pair{R"("adc_bits": 11.5)", "between 1 and 32"},
                                    std::pair{R"("reference_noise_N": -0.5)", "must not be negative"},
                                    std::pair{R"("reference_resolution_N": -1)", "must not be negative"},
                                    std::pair{R"("reference_lowpass_Hz": 0)", "must be above 0"},
                                    std::pair{R"("spring_N_per_mm": 0)", "must be above 0"}}) {
    put("campaign.json", std::string("{\"bench\": {") + bench + "}, \"records\": [{\"file\": \"a.csv\"}]}");
    EXPECT_THAT(refusal(), HasSubstr(says)) << bench;
  }
}

TEST_F(CheckedCampaign, ARangeInVoltsIsNoneOfCounts) {
  put_rows("a.csv", "t_s,F_ref_N,U_counts", [](int i) { return std::to_string(force(i, 0.0)) + "," + std::to_string(1000 + i); });
  const auto with = [&](const std::string& range) {
    put("campaign.json", "{\"bench\": {\"voltage_range_V\": " + range + R"(}, "records": [{"file": "a.csv"}]})");
    return read();
  };
  const Campaign volts = with("[0, 3.3]");
  EXPECT_FALSE(std::isfinite(volts.bench.voltage_max_V));
  EXPECT_THAT(volts.notes, Contains(HasSubstr("voltage_range_V [0, 3.3] is hardly theirs")));
  const Campaign counts = with("[0, 1024]");
  EXPECT_EQ(counts.bench.voltage_max_V, 1024.0);
  EXPECT_THAT(counts.notes, Not(Contains(HasSubstr("hardly theirs"))));
}

// 3.3 V of 12 bits would be steps of 0.8 mS.
TEST_F(CheckedCampaign, AConverterInVoltsIsNoneOfConductances) {
  put_rows("a.csv", "t_s,F_ref_N,U_uS", [](int i) { return std::to_string(force(i, 0.0)) + "," + std::to_string(100 + i); });
  put("campaign.json", R"({"bench": {"voltage_range_V": [0, 3.3], "adc_bits": 12}, "records": [{"file": "a.csv"}]})");
  const Campaign siemens = read();
  EXPECT_FALSE(std::isfinite(siemens.bench.voltage_max_V));
  EXPECT_EQ(siemens.bench.adc_bits, 0);
  EXPECT_THAT(siemens.notes, Contains(HasSubstr("are of volts, and the output is in S")));
}

TEST_F(CheckedCampaign, NotesSamplesFarBeyondTheDeclaredRange) {
  put_wave("a.csv", 0.0);  // 1 to 3 N, 2 to 6 V
  put("campaign.json", R"({"bench": {"voltage_range_V": [0, 3.3], "force_range_N": [0, 5]}, "records": [{"file": "a.csv"}]})");
  const Campaign campaign = read();
  EXPECT_THAT(campaign.notes, Contains(HasSubstr("beyond the declared voltage_range_V [0, 3.3]")));
  EXPECT_THAT(campaign.notes, Not(Contains(HasSubstr("force_range_N"))));
}

TEST_F(CheckedCampaign, DoesNotUseStartTimesThatOverlap) {
  put_wave("a.csv", 0.0);
  put_wave("b.csv", 1.0);
  put("campaign.json", R"({"records": [{"file": "a.csv", "start_s": 0}, {"file": "b.csv", "start_s": 0}]})");
  const Campaign overlapping = read();
  EXPECT_FALSE(overlapping.records[0].start_s || overlapping.records[1].start_s);
  EXPECT_THAT(overlapping.notes, Contains(HasSubstr("one sensor cannot be in two records")));
  put("campaign.json", R"({"records": [{"file": "a.csv", "start_s": 0}, {"file": "b.csv", "start_s": -1000}]})");
  const Campaign before = read();
  EXPECT_EQ(before.records[1].start_s, -1000.0) << "a clock may begin anywhere";
}

TEST_F(CheckedCampaign, ReadsASlowChannelAtItsOwnSamples) {
  put_rows("a.csv", "t_s,F_ref_N,U_V", [](int i) { return (i % 4 == 0 ? std::to_string(force(i, 0.0)) : "") + "," + std::to_string(i); });
  const Campaign campaign = read();
  const Trace& trace = campaign.records.front().trace;
  ASSERT_EQ(trace.size(), 50u);
  EXPECT_NEAR(trace.time_bases.front().nominal_rate_Hz, 2.5, 1e-9);
  EXPECT_EQ(trace.find("U")->value[3], 12.0);
  EXPECT_NEAR(trace.find("F_ref")->value[3], force(12, 0.0), 1e-5);
  EXPECT_THAT(campaign.notes, Contains(HasSubstr("F_ref has a sample in every 4th row only")));
}

TEST_F(CheckedCampaign, BringsChannelsThatNeverShareARowToOneClock) {
  put_rows("a.csv", "t_s,F_ref_N,U_V", [](int i) { return i % 2 == 0 ? std::to_string(0.1 * i) + "," : "," + std::to_string(0.2 * i); });
  const Campaign campaign = read();
  const Trace& trace = campaign.records.front().trace;
  ASSERT_EQ(trace.size(), 100u);
  for (std::size_t i = 1; i + 1 < trace.size(); ++i) EXPECT_NEAR(trace.find("U")->value[i], 2.0 * trace.find("F_ref")->value[i], 1e-5) << i;
  EXPECT_THAT(campaign.notes, Contains(HasSubstr("straight lines")));
}

TEST_F(CheckedCampaign, LeavesLostSamplesMissing) {
  put_rows("a.csv", "t_s,F_ref_N,U_V", [](int i) { return std::to_string(force(i, 0.0)) + "," + (i > 60 && i < 140 ? "" : std::to_string(i)); });
  const Campaign campaign = read();
  EXPECT_EQ(campaign.records.front().trace.size(), 200u) << "a sensor that was off for a while has no slower clock";
}

TEST_F(CheckedCampaign, ReadsAResistanceAsConductanceWhereThatIsStraighter) {
  put_rows("a.csv", "t_s,F_ref_N,R_kohm", [](int i) { return std::to_string(force(i, 0.0)) + "," + std::to_string(100.0 / force(i, 0.0)); });
  const Campaign campaign = read();
  const Channel& U = *campaign.records.front().trace.find("U");
  EXPECT_EQ(U.unit, "S");
  EXPECT_NEAR(U.value[7], 1e-5 * force(7, 0.0), 1e-10);
  EXPECT_THAT(campaign.notes, Contains(HasSubstr("conductance 1/R")));
  CampaignOptions options;
  options.column_map["R_kohm"] = "U_ohm";
  EXPECT_EQ(read(options).records.front().trace.find("U")->unit, "ohm") << "whoever names it means it";
}

TEST_F(CheckedCampaign, KeepsAResistanceThatFollowsTheForceItself) {
  put_rows("a.csv", "t_s,F_ref_N,R_ohm", [](int i) { return std::to_string(force(i, 0.0)) + "," + std::to_string(100.0 + 60.0 * force(i, 0.0)); });
  EXPECT_EQ(read().records.front().trace.find("U")->unit, "ohm");
}

TEST_F(CheckedCampaign, NotesColumnsThatNothingReads) {
  put_rows("a.csv", "t_s,F_ref_N,U_V,level_mm", [](int i) { return std::to_string(force(i, 0.0)) + ",2,3"; });
  EXPECT_THAT(read().notes, Contains("a: not used: level_mm"));
  CampaignOptions options;
  options.column_map["level_mm"] = "unused";
  EXPECT_THAT(read(options).notes, Not(Contains(HasSubstr("not used"))));
  std::string header = "t_s,F_ref_N,U_V", more;
  for (int k = 0; k < 50; ++k) header += ",c" + std::to_string(k) + "_mm", more += ",3";
  put_rows("a.csv", header, [&](int i) { return std::to_string(force(i, 0.0)) + ",2" + more; });
  EXPECT_THAT(read().notes, Contains(::testing::AllOf(::testing::StartsWith("a: not used: c0_mm, "), HasSubstr(" and 30 more"))));
}

TEST_F(CheckedCampaign, ReadsForceAndOutputOfTwoClocksAtTheSamplesOfTheSlowerOne) {
  Trace trace;
  trace.time_bases.resize(2);
  std::vector<double> F, U;
  for (int i = 0; i < 2000; ++i) trace.time_bases[0].t_s.push_back(i / 200.0), F.push_back(1.0 + i / 200.0);
  for (int i = 0; i < 3050; ++i) trace.time_bases[1].t_s.push_back(i / 300.0 - 0.1), U.push_back(i >= 1200 && i < 1230 ? kMissing : 5.0 + 2.0 * (i / 300.0 - 0.1));
  trace.channels = {{"F_ref", "N", "force", 0, F, {}}, {"U", "V", "voltage", 1, U, {}}};
  const auto note = put_on_common_clock(trace);
  ASSERT_TRUE(note);
  EXPECT_THAT(*note, HasSubstr("F_ref and U have clocks of their own"));
  ASSERT_EQ(trace.time_bases.size(), 1u);
  const std::vector<double>& t_s = trace.time_bases.front().t_s;
  const Channel &force = *trace.find("F_ref"), &output = *trace.find("U");
  ASSERT_EQ(force.value.size(), t_s.size());
  ASSERT_EQ(output.value.size(), t_s.size());
  std::size_t missing = 0;
  for (std::size_t i = 0; i < t_s.size(); ++i) {
    EXPECT_EQ(force.value[i], 1.0 + t_s[i]);
    if (std::isfinite(output.value[i])) {
      EXPECT_NEAR(output.value[i], 5.0 + 2.0 * t_s[i], 1e-9);
      continue;
    }
    ++missing;
    EXPECT_NEAR(t_s[i], 3.95, 0.06) << "where the output was lost";
  }
  EXPECT_NEAR(static_cast<double>(missing), 20.0, 2.0);
}

TEST_F(CheckedCampaign, LeavesWhatOneClockDoesNotCoverOut) {
  Trace trace;
  trace.time_bases.resize(2);
  std::vector<double> F(1000, 1.0), U(500, 2.0);
  for (int i = 0; i < 1000; ++i) trace.time_bases[0].t_s.push_back(0.01 * i);
  for (int i = 0; i < 500; ++i) trace.time_bases[1].t_s.push_back(2.003 + 0.01 * i);
  trace.channels = {{"F_ref", "N", "force", 0, F, {}}, {"U", "V", "voltage", 1, U, {}}};
  ASSERT_TRUE(put_on_common_clock(trace));
  EXPECT_NEAR(trace.time_bases.front().t_s.front(), 2.0, 0.011);
  EXPECT_NEAR(trace.time_bases.front().t_s.back(), 7.0, 0.011);
  for (const Channel& channel : trace.channels)
    for (const double v : channel.value) EXPECT_TRUE(std::isfinite(v));
}

TEST_F(CheckedCampaign, TakesASupplyForTheDriveOnlyWhereSomebodySetIt) {
  const auto put_supply = [&](const std::string& name, const std::string& header, double supply_V) {
    put_rows(name, "t_s,F_ref_N,U_V," + header, [&](int i) { return std::to_string(force(i, supply_V)) + ",2," + std::to_string(supply_V + 0.01 * std::sin(i)); });
  };
  put_supply("a.csv", "supply_V", 5.0);
  put_supply("b.csv", "supply_V", 5.004);
  const Campaign same = read();
  EXPECT_EQ(same.records.front().trace.find("drive"), nullptr);
  EXPECT_THAT(same.notes, Contains(HasSubstr("not used: the supply")));
  EXPECT_THAT(same.notes, Not(Contains(HasSubstr("taken for"))));
  put_supply("b.csv", "supply_V", 3.3);
  const Campaign set = read();
  EXPECT_NE(set.records.front().trace.find("drive"), nullptr);
  EXPECT_THAT(set.notes, Contains(HasSubstr("the supply was set from 3.3 to 5 V")));
  put_supply("a.csv", "drive_V", 5.0);
  put_supply("b.csv", "drive_V", 5.0);
  EXPECT_NE(read().records.front().trace.find("drive"), nullptr) << "a drive is one by its name";
}

TEST_F(CheckedCampaign, NotesSpeakOfColumnsAsTheFileWritesThem) {
  put_rows("a.csv", "t_s,load_cell_mN,Sensor_mV,RH_pct,pos_mm", [](int i) { return std::to_string(force(i, 0.0)) + ",2,40,3"; });
  const Campaign campaign = read();
  EXPECT_THAT(campaign.notes, Contains(HasSubstr("column \"load_cell_mN\" was taken for F_ref")));
  EXPECT_THAT(campaign.notes, Contains(HasSubstr("not used: pos_mm")));
  EXPECT_THAT(campaign.notes, Not(Contains(HasSubstr("pct to 1"))));
}

TEST_F(CheckedCampaign, FactsOfTheBenchLargerThanWhatWasRecordedAreNoted) {
  put_wave("a.csv", 0.0);
  const auto notes_of = [&](const std::string& bench) {
    put("campaign.json", R"({"bench": {)" + bench + R"(}, "records": [{"file": "a.csv"}]})");
    return read().notes;
  };
  const std::string noise = "reference_noise_N 10 N is declared, and F_ref of these records runs from 1 to 3 N";
  EXPECT_THAT(notes_of(R"("reference_noise_N": 10)"), Contains(HasSubstr(noise)));
  EXPECT_THAT(notes_of(R"("reference_resolution_N": 25)"), Contains(HasSubstr("reference_resolution_N 25 N is declared")));
  EXPECT_THAT(notes_of(R"("voltage_range_V": [0, 5000])"), Contains(HasSubstr("voltage_range_V [0, 5000] V is declared, and U of these records runs from 2 to 6 V")));
  EXPECT_THAT(notes_of(R"("force_range_N": [0, 5000])"), Contains(HasSubstr("force_range_N [0, 5000] N is declared")));
  EXPECT_THAT(notes_of(R"("reference_noise_N": 0.5, "reference_resolution_N": 0.1, "voltage_range_V": [0, 10], "force_range_N": [0, 100])"), Not(Contains(HasSubstr("is declared"))));
  put_rows("a.csv", "t_s,F_ref_N,U_V", [](int i) { return std::to_string(0.001 * (i * 7919 % 13)) + (i / 40 % 2 == 0 ? ",0.0024" : ",0.0049"); });
  EXPECT_THAT(notes_of(R"("reference_noise_N": 0.05, "voltage_range_V": [0, 10], "force_range_N": [0, 5])"), Not(Contains(HasSubstr("is declared")))) << "nothing moves";
}

TEST_F(CheckedCampaign, ARateThatTheClockOfTheFileOverrulesIsNoted) {
  put_wave("a.csv", 0.0);
  CampaignOptions options;
  options.assumed_rate_Hz = 100.0;
  EXPECT_THAT(read(options).notes, Contains(HasSubstr("a: the rate of 100 Hz that was given is not used, for the clock of the file has 10 Hz")));
  options.assumed_rate_Hz = 10.0;
  EXPECT_THAT(read(options).notes, Not(Contains(HasSubstr("not used"))));
}

TEST_F(CheckedCampaign, RefusesSizesThatNoBenchHasWithTheirColumn) {
  const auto refusal = [&](const std::string& rows) {
    const auto read = read_campaign(put("big.csv", "t_s,Force (N),U_V\n" + rows));
    EXPECT_FALSE(read) << rows;
    return read ? Error{} : read.error();
  };
  const Error volts = refusal("0,1,2e30\n1,2,3e30\n");
  EXPECT_THAT(volts.text, HasSubstr("column \"U_V\" runs from 2e+30 to 3e+30 V, and no bench has that"));
  EXPECT_THAT(volts.where, ::testing::EndsWith("big.csv"));
  EXPECT_THAT(volts.hint, HasSubstr("--map U_V=U_mV"));
  EXPECT_THAT(refusal("0,2e13,1\n1,3e13,2\n").hint, HasSubstr("--map 'Force (N)=F_ref_mN'"));
  EXPECT_TRUE(read_campaign(put("big.csv", "t_s,F_ref_N,U_V\n0,1,8388000\n1,2,8388600\n"))) << "codes of 24 bits";
}

}  // namespace
}  // namespace forcegate
