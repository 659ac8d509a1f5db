#include "hil/trace/campaign.h"
#include "tests/support/folder_test.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>

namespace forcegate {
namespace {

using ::testing::Contains;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Not;
namespace fs = std::filesystem;

class ReadCampaign : public FolderTest {
 protected:
  Error refusal() {
    const auto campaign = read_campaign(folder_);
    EXPECT_FALSE(campaign);
    return campaign ? Error{} : campaign.error();
  }
};

constexpr const char* kCsv = "t_s,F_ref_N,U_V,level_mm\n0,1,2,3\n0.1,2,3,4\n0.2,3,4,5\n";

TEST_F(ReadCampaign, AColumnThatIsMappedOutIsGone) {
  put("r.csv", kCsv);
  CampaignOptions options;
  options.column_map = {{"level_mm", "unused"}, {"U_V", "unused"}};
  const auto campaign = read_campaign(folder_ / "r.csv", options);
  ASSERT_TRUE(campaign) << campaign.error().to_text();
  ASSERT_EQ(campaign->records.front().trace.channels.size(), 1u);
  EXPECT_EQ(campaign->records.front().trace.channels.front().name, "F_ref");
}

TEST_F(ReadCampaign, TakesEveryFactOfADescribedCampaign) {
  put("r1.csv", kCsv);
  put("r2.csv", kCsv);
  put("campaign.json", R"({"campaign": "C01", "sensor": "A201",
    "bench": {"spring_N_per_mm": 0.25, "law": "F = k x", "voltage_range_V": [0, 10], "force_range_N": [0, 5],
              "reference_resolution_N": 0.025, "reference_lowpass_Hz": 73, "adc_bits": 12, "colour": "blue"},
    "records": [{"file": "r1.csv", "kind": "sine", "role": "fit", "fs_Hz": 10, "start_s": 1900, "rest_before_s": 677,
                 "excitation_start_s": 2, "dynamic": true, "f_min_Hz": 0.5, "A_N": 1.16, "m_N": 1.92, "drive_V": 5.0,
                 "eccentricity_mm": 11, "preload_mm": 1.6, "mounting": 2, "temp_C": 21.5, "rh_pct": 40,
                 "stimulus": {"f": 0.5}},
                {"file": "r2.csv", "role": "heldout", "mounting": "glued", "humidity_pct": 55}]})");
  const auto c = read_campaign(folder_);
  ASSERT_TRUE(c) << c.error().to_text();
  EXPECT_EQ(c->name, "C01");
  EXPECT_EQ(c->bench.adc_bits, 12);
  EXPECT_EQ(c->bench.voltage_max_V, 10.0);
  EXPECT_EQ(c->bench.reference_lowpass_Hz, 73.0);
  EXPECT_TRUE(c->bench.reference_noise_N != c->bench.reference_noise_N);
  ASSERT_EQ(c->records.size(), 2u);
  const Record& r = c->records[0];
  EXPECT_EQ(r.name, "r1");
  EXPECT_EQ(r.kind, "sine");
  EXPECT_EQ(r.A_N, 1.16);
  EXPECT_EQ(r.rest_before_s, 677.0);
  EXPECT_EQ(r.mounting, "2");
  EXPECT_EQ(c->records[1].mounting, "glued");
  EXPECT_EQ(r.temp_C, 21.5);
  EXPECT_EQ(r.humidity_pct, 40.0);
  EXPECT_EQ(c->records[1].humidity_pct, 55.0);
  EXPECT_FALSE(c->records[1].temp_C.has_value());
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

TEST_F(ReadCampaign, TakesTheRecordsOfTheFolderWhereTheDescriptionListsNone) {
  put("run10.csv", kCsv);
  put("run2.csv", kCsv);
  put("campaign.json", R"({"campaign": "K1", "bench": {"reference_resolution_N": 0.025}})");
  const auto c = read_campaign(folder_);
  ASSERT_TRUE(c) << c.error().to_text();
  EXPECT_EQ(c->name, "K1");
  EXPECT_EQ(c->bench.reference_resolution_N, 0.025);
  ASSERT_EQ(c->records.size(), 2u);
  EXPECT_EQ(c->records[0].name, "run2");
  EXPECT_EQ(c->records[1].name, "run10");
  EXPECT_THAT(c->notes, Contains(HasSubstr("lists no records")));
  EXPECT_TRUE(read_campaign(folder_ / "campaign.json"));
  put("campaign.json", R"({"records": "run2.csv"})");
  EXPECT_THAT(refusal().text, HasSubstr("at least one record"));
}

TEST_F(ReadCampaign, NotesTheRecordingsOfItsFolderThatItDoesNotList) {
  put("a.csv", kCsv);
  put("campaign.json", R"({"records": [{"file": "a.csv"}]})");
  const auto about_others = [&](const fs::path& path) {
    const auto campaign = read_campaign(path);
    EXPECT_TRUE(campaign);
    std::string out;
    for (const std::string& note : campaign->notes)
      if (note.find("does not list") != std::string::npos) out += note;
    return out;
  };
  EXPECT_EQ(about_others(folder_), "");
  put("a.h5", "what the instruments said of a.csv");
  EXPECT_EQ(about_others(folder_), "");
  put("b.csv", kCsv);
  put("notes.txt", "a note");
  EXPECT_EQ(about_others(folder_), "not read, since campaign.json does not list it: b.csv");
  for (const char* name : {"c.csv", "d.mat", "e.h5", "f.tsv", "g.csv"}) put(name, kCsv);
  EXPECT_EQ(about_others(folder_), "not read, since campaign.json does not list them: b.csv, c.csv, d.mat, e.h5 and 2 more");
  EXPECT_EQ(about_others(folder_ / "campaign.json"), "") << "a list that is named itself is meant";
}

TEST_F(ReadCampaign, AsksWhatAMistypedKeyMeans) {
  put("run.csv", kCsv);
  put("campaign.json", R"({"record": [{"file": "run.csv"}]})");
  const auto listed = read_campaign(folder_);
  ASSERT_TRUE(listed);
  EXPECT_THAT(listed->notes, Contains("campaign.json: nothing reads the key \"record\"; did you mean \"records\"?"));
  put("campaign.json", R"({"Sensor": "FSR", "bench": {"voltage_range": [0, 5], "colour": "blue"},
                           "records": [{"file": "run.csv", "room_temp_degC": 22, "start": 5, "excitation_startt_s": 2, "x_N": 3, "operator": "me"}]})");
  const auto c = read_campaign(folder_);
  ASSERT_TRUE(c) << c.error().to_text();
  for (const char* meant : {"sensor", "voltage_range_V", "start_s", "excitation_start_s"})
    EXPECT_THAT(c->notes, Contains(HasSubstr(std::string("did you mean \"") + meant + "\"?")));
  for (const char* fine : {"colour", "x_N", "operator", "temp"}) EXPECT_THAT(c->notes, ::testing::Not(Contains(HasSubstr(std::string("the key \"") + fine)))) << fine;
}

TEST_F(ReadCampaign, AsksWhatAShortKeyMeansThatHasALetterTooFew) {
  put("run.csv", kCsv);
  put("campaign.json", R"({"bench": {"lab": "A"}, "records": [{"file": "run.csv", "knd": "sine", "rule": "first", "m_s": 3, "dia": 9}]})");
  const auto c = read_campaign(folder_);
  ASSERT_TRUE(c) << c.error().to_text();
  EXPECT_THAT(c->notes, Contains("campaign.json: nothing reads the key \"knd\"; did you mean \"kind\"?"));
  for (const char* fine : {"lab", "rule", "m_s", "dia"}) EXPECT_THAT(c->notes, ::testing::Not(Contains(HasSubstr(std::string("the key \"") + fine)))) << fine;
  put("campaign.json", R"({"records": [{"file": "run.csv", "knid": "sine"}]})");
  EXPECT_THAT(read_campaign(folder_)->notes, Contains(HasSubstr("did you mean \"kind\"?")));
}

TEST_F(ReadCampaign, SaysThatARecordingWasCutShort) {
  put("r1.csv", kCsv);
  const std::string text = R"({"recorded_with": {"rig": "emulated", "planned_records": 3}, "records": [{"file": "r1.csv"}]})";
  put("campaign.json", text);
  EXPECT_THAT(read_campaign(folder_)->notes, Contains(HasSubstr("1 of the 3 records that were planned is there")));
  put("campaign.json", std::string(text).replace(text.find("3}"), 1, "1"));
  EXPECT_THAT(read_campaign(folder_)->notes, Not(Contains(HasSubstr("planned"))));
}

TEST_F(ReadCampaign, NotesWhatNoBenchHasAndKeysThatAreGivenTwice) {
  put("r1.csv", kCsv);
  put("campaign.json", R"({"sensor": "a", "sensor": "b", "records": [{"file": "r1.csv", "drive_V": -5, "excitation_start_s": -1e9, "preload_mm": 1e300, "A_N": 1, "A_N": 2}]})");
  const auto c = read_campaign(folder_);
  ASSERT_TRUE(c) << c.error().to_text();
  EXPECT_THAT(c->notes, Contains(HasSubstr("has the key \"sensor\" twice")));
  EXPECT_THAT(c->notes, Contains(HasSubstr("has the key \"A_N\" twice")));
  for (const char* fact : {"drive_V = -5 V", "excitation_start_s = -1e+09 s", "preload_mm = 1e+300 mm"}) EXPECT_THAT(c->notes, Contains(HasSubstr(fact)));
  for (const char* wrong : {R"("A_N": -1)", R"("f_min_Hz": 0)"}) {
    put("campaign.json", "{\"records\": [{\"file\": \"r1.csv\", " + std::string(wrong) + "}]}");
    EXPECT_THAT(refusal().hint, HasSubstr("leave it out"));
  }
  put("campaign.json", R"({"bench": {"voltage_range_V": [10, 0]}, "records": [{"file": "r1.csv"}]})");
  EXPECT_THAT(refusal().hint, HasSubstr("the lower end first"));
}

TEST_F(ReadCampaign, TakesASingleCsv) {
  put("run.csv", kCsv);
  const auto c = read_campaign(folder_ / "run.csv");
  ASSERT_TRUE(c);
  EXPECT_EQ(c->name, "run");
  EXPECT_EQ(c->records.size(), 1u);
}

TEST_F(ReadCampaign, SaysThatTheDescriptionBesideASingleFileIsNotRead) {
  const auto note = HasSubstr("campaign.json beside r1.csv is not read");
  const auto notes = [&] {
    const auto campaign = read_campaign(folder_ / "r1.csv");
    EXPECT_TRUE(campaign);
    return campaign ? campaign->notes : std::vector<std::string>{};
  };
  put("r1.csv", kCsv);
  EXPECT_THAT(notes(), ::testing::Not(Contains(note)));
  for (const char* description : {R"({"records": [{"file": "r2.csv"}, {"file": "./r1.csv", "kind": "sine"}]})", R"({"sensor": "FSR 402"})", "{"}) {
    put("campaign.json", description);
    EXPECT_THAT(notes(), Contains(note)) << description;
    EXPECT_THAT(notes(), Contains(HasSubstr(folder_.string()))) << "which folder to name";
  }
  put("campaign.json", R"({"records": [{"file": "r2.csv"}]})");
  EXPECT_THAT(notes(), ::testing::Not(Contains(note))) << "it says nothing of this file";
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
  put("campaign.json", "{\"records\": [{\"file\": \"r.csv\", \"mounting\": 1.5}]}");
  EXPECT_THAT(refusal().text, HasSubstr("a name or a whole number"));
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
  EXPECT_THAT(refusal().text, HasSubstr("holds no .csv"));
  EXPECT_EQ(read_campaign(folder_ / "nowhere").error().code, ErrorCode::io);
}

TEST_F(ReadCampaign, RefusesToMapAColumnThatIsNotThereAndSaysWhichAre) {
  put("r.csv", kCsv);
  for (const fs::path& path : {folder_, folder_ / "r.csv"}) {
    const auto c = read_campaign(path, {.column_map = {{"frce", "F_dut_N"}}, .assumed_rate_Hz = 0.0});
    ASSERT_FALSE(c);
    EXPECT_EQ(c.error().code, ErrorCode::usage);
    EXPECT_THAT(c.error().text, HasSubstr("\"frce\""));
    EXPECT_THAT(c.error().hint, HasSubstr("F_ref_N, U_V, level_m"));
  }
}

TEST_F(ReadCampaign, MapsAColumnByItsOwnNameAndByTheNameInCanonicalUnits) {
  put("r.csv", "t_s,pressure_bar,U_V\n0,1,2\n0.1,2,3\n0.2,3,4\n");
  for (const char* name : {"pressure_bar", "pressure_Pa"}) {
    const auto c =
        read_campaign(folder_ / "r.csv", {.column_map = {{name, "F_ref_N"}}, .assumed_rate_Hz = 0.0});
    ASSERT_TRUE(c) << c.error().text;
    const Channel* force = c->records[0].trace.find("F_ref");
    ASSERT_NE(force, nullptr) << name;
    EXPECT_EQ(force->value[2], 3.0) << name;
  }
}

TEST_F(ReadCampaign, MapsAColumnByTheNameThatItWasTakenFor) {
  put("r.csv", "t_s,position_mm,force_N\n0,1,2\n0.1,2,3\n0.2,3,4\n");
  const auto c =
      read_campaign(folder_ / "r.csv",
                    {.column_map = {{"F_ref_N", "U_V"}, {"position_mm", "F_ref_N"}}, .assumed_rate_Hz = 0.0});
  ASSERT_TRUE(c) << c.error().text;
  EXPECT_EQ(c->records[0].trace.find("U")->value[2], 4.0);
  EXPECT_EQ(c->records[0].trace.find("F_ref")->value[2], 3.0);
}

TEST_F(ReadCampaign, TellsOnceWhatRecordsShareEvenWhenTheNumbersDiffer) {
  std::string a = "t_s,F_ref_N,U_V\n", b = a;
  for (int i = 0; i < 200; ++i) {
    const std::string row = std::to_string(i) + "e-2,1,2\n";
    if (i != 50) a += row;
    if (i != 50 && i != 90 && i != 91) b += row;
  }
  put("a.csv", a);
  put("b.csv", b);
  const auto c = read_campaign(folder_);
  ASSERT_TRUE(c) << c.error().text;
  std::vector<std::string> gaps;
  for (const std::string& note : c->notes)
    if (note.find("in the clock") != std::string::npos) gaps.push_back(note);
  EXPECT_THAT(gaps, ::testing::SizeIs(::testing::Le(2u)));
  put("c.csv", b);
  put("d.csv", b);
  const auto more = read_campaign(folder_);
  ASSERT_TRUE(more);
  EXPECT_EQ(
      std::ranges::count_if(more->notes,
                            [](const std::string& n) { return n.find("in the clock") != std::string::npos; }),
      static_cast<std::ptrdiff_t>(gaps.size()));
}

}  // namespace
}  // namespace forcegate
