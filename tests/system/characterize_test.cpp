// `forcegate characterize` as a user runs it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/support/process.h"

namespace forcegate::test {
namespace {

using ::testing::HasSubstr;
namespace fs = std::filesystem;

const char* const kPlan =
    "format = 1\nkind = \"characterize\"\nname = \"short\"\nseed = 5\n[population]\nspecimens = [\"q25\", \"q75\"]\nsessions = 2\nexemplar = \"q50\"\n"
    "[procedures]\nfsr = [\"static_calibration\", \"step_response\"]\n[[limit]]\nkey = \"step.sensor\"\nmaximum = MAX\nsource = \"a test\"\n";

std::string plan_with(const std::string& maximum) {
  std::string plan = kPlan;
  return plan.replace(plan.find("MAX"), 3, maximum);
}

TEST(Characterize, WritesSheetModelAndCalibrationAndKeepsALimit) {
  const TemporaryFolder temporary;
  const fs::path& folder = temporary.path();
  write_text(folder / "plan.toml", plan_with("250.0"));
  const ProcessResult r = forcegate({"characterize", "--plan", (folder / "plan.toml").string(), "-o",
                                     (folder / "out").string(), "--paper", folder.string()});
  EXPECT_EQ(r.exit_code, 0) << r.err;
  EXPECT_THAT(r.out, HasSubstr("samples a second"));
  for (const char* file :
       {"sheet-fsr.html", "sheet-fsr.json", "study.json", "fsr.toml", "calibration-fsr-q25-s1.toml"})
    EXPECT_TRUE(fs::exists(folder / "out" / file)) << file;
  EXPECT_TRUE(fs::exists(folder / "paper.md"));
  EXPECT_TRUE(fs::exists(folder / "pictures/paper/fig05.svg"));
  const auto study = nlohmann::json::parse(read_text(folder / "out/study.json"));
  EXPECT_EQ(study["sensors"][0]["sessions"].size(), 4u);
  EXPECT_TRUE(study["limits"][0]["kept"]);
}

TEST(Characterize, RejectsWhenALimitIsBrokenAndNamesTheWorstSpecimen) {
  const TemporaryFolder temporary;
  const fs::path& folder = temporary.path();
  write_text(folder / "plan.toml", plan_with("100.0"));
  const ProcessResult r =
      forcegate({"characterize", "--plan", (folder / "plan.toml").string(), "-o", (folder / "out").string()});
  EXPECT_EQ(r.exit_code, 1);
  EXPECT_THAT(r.out, HasSubstr("BROKEN"));
  EXPECT_THAT(r.out, HasSubstr("4 of 4 sessions outside"));
}

// At 100 Hz the codes of a fast FlexiForce jump from one sample to the next, which the rig's checks take for a bad contact.
TEST(Characterize, ARigThatFailsInSomeSessionsIsNoSuccessAndNoReject) {
  const TemporaryFolder temporary;
  const fs::path& folder = temporary.path();
  std::string plan = plan_with("250.0");
  plan.replace(plan.find("fsr = ["), 7, "flexiforce = [\"static_calibration\", \"harmonic_series\"]\nfsr = [");
  plan.insert(plan.find("[[limit]]"), "[harmonic]\nf_Hz = [1]\nA_N = [2.2]\nm_N = [2.95]\n[profiles]\nrecord_s = 60\n");
  for (const std::string& text : {plan, plan.substr(0, plan.find("[[limit]]"))}) {
    write_text(folder / "plan.toml", text);
    const ProcessResult r = forcegate({"characterize", "--plan", (folder / "plan.toml").string(), "--rig-option", "rate_Hz=100", "-o", (folder / "out").string()});
    EXPECT_EQ(r.exit_code, 4) << r.out << r.err;
    EXPECT_THAT(r.out, HasSubstr("q25 session 0 failed: "));
    EXPECT_THAT(r.out, HasSubstr("the exemplar q50 failed: "));
    EXPECT_THAT(r.out, ::testing::Not(HasSubstr("every figure that has a window lies in it")));
    EXPECT_TRUE(fs::exists(folder / "out" / "sheet-fsr.html"));
  }
}

// Same study, other word for the threads.
TEST(Characterize, PagesDoNotDependOnHowTheThreadsAreWritten) {
  const TemporaryFolder temporary;
  const fs::path& folder = temporary.path();
  write_text(folder / "plan.toml", plan_with("250.0"));
  std::string before;
  for (const std::vector<std::string>& threads : {std::vector<std::string>{}, {"--threads", "2"}, {"--threads=1"}}) {
    std::vector<std::string> words{"characterize", "--plan", (folder / "plan.toml").string(), "-o", (folder / "out").string()};
    words.insert(words.end(), threads.begin(), threads.end());
    EXPECT_EQ(forcegate(words).exit_code, 0);
    const std::string page = read_text(folder / "out/sheet-fsr.html");
    if (!before.empty()) {
      EXPECT_TRUE(page == before) << threads.back();
    }
    before = page;
  }
}

TEST(Characterize, ASpecimenThatIsNotThereIsToldBeforeAnythingIsPlayed) {
  const TemporaryFolder temporary;
  const fs::path& folder = temporary.path();
  std::string plan = plan_with("250.0");
  write_text(folder / "plan.toml", plan.replace(plan.find("sessions = 2"), 12, "sessions = 900"));
  const ProcessResult r = forcegate({"characterize", "--plan", (folder / "plan.toml").string(), "--specimen", "q50", "--specimen", "q50x", "-o", (folder / "out").string()},
                                    {.timeout = std::chrono::seconds(20)});
  EXPECT_EQ(r.exit_code, 2) << r.out;
  EXPECT_THAT(r.err, HasSubstr("no specimen 'q50x'"));
}

TEST(Characterize, ReadsTheDecayOutOfARecording) {
  const TemporaryFolder temporary;
  const fs::path& folder = temporary.path();
  std::string csv = "t_s,U_V,F_ref_N\n";
  for (int i = 0; i < 40000; ++i) {
    const double t = 0.02 * i, s = 0.5 - 0.5 * std::cos(3.14159265358979 * t);
    csv += std::to_string(t) + "," + std::to_string(2.0 + s * (4.0 * std::exp(-0.006 * t) + 1.0)) + "," +
           std::to_string(1.0 + 3.0 * s) + "\n";
  }
  write_text(folder / "sine.csv", csv);
  const ProcessResult r = forcegate({"characterize", "--record", (folder / "sine.csv").string(), "-o",
                                     (folder / "out").string(), "--json"});
  ASSERT_EQ(r.exit_code, 0) << r.err << r.out;
  const auto study = nlohmann::json::parse(r.out);
  double b = 0.0;
  for (const auto& s : study["sensors"][0]["spreads"])
    if (s["key"] == "recording.b") b = s["mean"];
  EXPECT_NEAR(b, 0.006, 0.0002);
}

TEST(Characterize, CountsACopyOnce) {
  const TemporaryFolder temporary;
  const fs::path& folder = temporary.path();
  std::string csv = "t_s,U_V,F_ref_N\n";
  for (int i = 0; i < 20000; ++i) {
    const double t = 0.02 * i, s = 0.5 - 0.5 * std::cos(3.14159265358979 * t);
    csv += std::to_string(t) + "," + std::to_string(2.0 + s * (4.0 * std::exp(-0.006 * t) + 1.0)) + "," + std::to_string(1.0 + 3.0 * s) + "\n";
  }
  for (const char* name : {"sine.csv", "copy.csv"}) write_text(folder / name, csv);
  const ProcessResult r = forcegate({"characterize", "--record", (folder / "sine.csv").string(), "--record", (folder / "copy.csv").string(), "-o", (folder / "out").string()});
  ASSERT_EQ(r.exit_code, 0) << r.err << r.out;
  EXPECT_THAT(r.out, HasSubstr("copy.csv is the same recording"));
  EXPECT_THAT(read_text(folder / "out/sheet-recording.json"), ::testing::Not(HasSubstr("\"specimen\": \"copy.csv\"")));
}

TEST(Characterize, OfASlowAndACyclicRecordingMakesOneCalibrationAndSaysWhatToDoWithIt) {
  const TemporaryFolder temporary;
  const fs::path& folder = temporary.path();
  std::string sine = "t_s,U_V,F_ref_N\n", ramp = sine;
  for (int i = 0; i < 20000; ++i) {
    const double t = 0.02 * i, s = 0.5 - 0.5 * std::cos(3.14159265358979 * t), up = 1.0 - std::abs(std::fmod(t / 50.0, 2.0) - 1.0);
    sine += std::to_string(t) + "," + std::to_string(2.0 + s * (4.0 * std::exp(-0.006 * t) + 1.0)) + "," + std::to_string(1.0 + 3.0 * s) + "\n";
    ramp += std::to_string(t) + "," + std::to_string(0.2 + 6.0 * up) + "," + std::to_string(3.0 * up) + "\n";
  }
  write_text(folder / "sine.csv", sine);
  write_text(folder / "ramp.csv", ramp);
  const std::vector<std::string> words{"characterize", "--record", folder / "ramp.csv", "--record", folder / "sine.csv", "-o", folder / "out"};
  const ProcessResult r = forcegate(words);
  ASSERT_EQ(r.exit_code, 0) << r.err << r.out;
  EXPECT_THAT(r.out, HasSubstr("recording: 2 recordings, "));
  EXPECT_THAT(r.out, HasSubstr("note: ramp.csv: the converter is not stated"));
  EXPECT_THAT(r.out, HasSubstr("\nnext: forcegate compare " + (folder / "ramp.csv").string() + " --model " + (folder / "out/recording.toml").string() + "\n"));
  EXPECT_THAT(read_text(folder / "out/calibration-recording-identified.toml"), HasSubstr("level = \"identified\""));
  std::vector<std::string> quiet = words, json = words;
  quiet.push_back("-q");
  json.push_back("--json");
  EXPECT_THAT(forcegate(quiet).out, ::testing::Not(HasSubstr("note:")));
  const auto files = nlohmann::json::parse(forcegate(json).out)["files"];
  EXPECT_EQ(files.size(), 6u);
  EXPECT_EQ(files[0], (folder / "out/study.json").string());
}

TEST(Characterize, PlaysConductanceAndCapacitanceOnTheBenchOfWeights) {
  const TemporaryFolder temporary;
  const fs::path& folder = temporary.path();
  write_text(
      folder / "plan.toml",
      "format = 1\nkind = \"capacitance\"\nname = \"short\"\nseed = 3\n[population]\nsets = 1\n[loading]\nstep_N = 10.0\nmost_training = 3\ntesting = 2\n"
      "[source]\ndc_samples = 800\nsine_samples = 800\n[sweep]\npoints = 40\nsamples = 3200\n");
  const ProcessResult r = forcegate({"characterize", "--plan", (folder / "plan.toml").string(), "-o",
                                     (folder / "out").string(), "--paper", folder.string()});
  ASSERT_EQ(r.exit_code, 0) << r.err;
  EXPECT_THAT(r.out, HasSubstr("network 2-2-1"));
  const auto study = nlohmann::json::parse(read_text(folder / "out/capacitance.json"));
  EXPECT_EQ(study["packs"][0]["sensors"].size(), 8u);
  EXPECT_GT(study["mse_N2"]["mean"][0], study["mse_N2"]["mean"][1]);
  EXPECT_TRUE(fs::exists(folder / "out/sheet-capacitance.html"));
  for (const char* figure :
       {"fig04.svg", "fig06.svg", "fig07.svg", "fig08.svg", "fig09.svg", "fig10.svg", "fig11.svg"})
    EXPECT_TRUE(fs::exists(folder / "pictures/paper-capacitance" / figure)) << figure;
  EXPECT_THAT(read_text(folder / "paper-capacitance.md"), HasSubstr("## Table I"));
  EXPECT_EQ(
      forcegate({"characterize", "--plan", (folder / "plan.toml").string(), "--specimen", "q50"}).exit_code,
      2);
}

// A sine whose maxima decay at 0.006 1/s.
void write_decaying_sine(const fs::path& file) {
  std::string csv = "t_s,U_V,F_ref_N\n";
  for (int i = 0; i < 20000; ++i) {
    const double t = 0.02 * i, s = 0.5 - 0.5 * std::cos(3.14159265358979 * t);
    csv += std::to_string(t) + "," + std::to_string(2.0 + s * (4.0 * std::exp(-0.006 * t) + 1.0)) + "," + std::to_string(1.0 + 3.0 * s) + "\n";
  }
  write_text(file, csv);
}

TEST(Characterize, JudgesRecordingsByTheLimitsOfThePlan) {
  const TemporaryFolder temporary;
  const fs::path& folder = temporary.path();
  write_decaying_sine(folder / "sine.csv");
  const auto judged = [&](const std::string& key, const std::string& maximum) {
    std::string plan = plan_with(maximum);
    plan.replace(plan.find("step.sensor"), 11, key);
    write_text(folder / "plan.toml", plan);
    return forcegate({"characterize", "--record", folder / "sine.csv", "--plan", folder / "plan.toml", "-o", folder / "out"});
  };
  const ProcessResult kept = judged("recording.b", "0.1"), broken = judged("recording.b", "0.001"), unmeasured = judged("step.sensor", "250.0");
  EXPECT_EQ(kept.exit_code, 0) << kept.out << kept.err;
  EXPECT_THAT(kept.out, HasSubstr("kept  recording "));
  EXPECT_EQ(broken.exit_code, 1);
  EXPECT_THAT(broken.out, HasSubstr("BROKEN recording "));
  EXPECT_THAT(broken.out, HasSubstr("1 of 1 recordings outside"));
  EXPECT_EQ(unmeasured.exit_code, 1);
  EXPECT_THAT(unmeasured.out, HasSubstr("not measured step.sensor by any of the recordings: at most 250"));
  EXPECT_EQ(unmeasured.out.find("BROKEN"), std::string::npos) << unmeasured.out;
  const ProcessResult no_plan = forcegate({"characterize", "--record", folder / "sine.csv", "--plan", folder / "no.toml", "-o", folder / "out"});
  EXPECT_EQ(no_plan.exit_code, 2) << no_plan.out;
}

TEST(Characterize, RefusesBesideARecordingWhatOnlyARigCanDo) {
  const TemporaryFolder temporary;
  const fs::path& folder = temporary.path();
  write_decaying_sine(folder / "sine.csv");
  for (const std::vector<std::string>& more : {std::vector<std::string>{"--specimen", "q50"}, {"--sessions", "2"}, {"--seed", "3"}, {"--golden", "golden"}}) {
    std::vector<std::string> words{"characterize", "--record", folder / "sine.csv", "-o", folder / "out"};
    words.insert(words.end(), more.begin(), more.end());
    const ProcessResult r = forcegate(words);
    EXPECT_EQ(r.exit_code, 2) << more[0];
    EXPECT_THAT(r.err, HasSubstr("where: " + more[0]));
    EXPECT_THAT(r.err, HasSubstr("leave " + more[0] + " out"));
    EXPECT_FALSE(fs::exists(folder / "out"));
  }
}

TEST(Characterize, DrawsTheFirstSpecimenThatIsNamedAndPlaysNoOther) {
  const TemporaryFolder temporary;
  const fs::path& folder = temporary.path();
  write_text(folder / "plan.toml", plan_with("250.0"));
  const std::vector<std::string> words{"characterize", "--plan", folder / "plan.toml", "--sessions", "1", "--specimen", "q75", "-o", folder / "out"};
  const ProcessResult one = forcegate(words);
  EXPECT_EQ(one.exit_code, 0) << one.err;
  const auto study = nlohmann::json::parse(read_text(folder / "out/study.json"))["sensors"][0];
  ASSERT_EQ(study["sessions"].size(), 1u);
  EXPECT_EQ(study["samples"], study["sessions"][0]["samples"]);
  const std::string gain = study["sessions"][0]["values"]["static.gain"].dump().substr(0, 4);
  EXPECT_THAT(read_text(folder / "out/sheet-fsr.html"), ::testing::AllOf(HasSubstr("Drawn: specimen q75, session 0."), HasSubstr("G = " + gain)));
  std::vector<std::string> two = words, twice = words;
  two.insert(two.end(), {"--specimen", "q25"});
  EXPECT_EQ(forcegate(two).exit_code, 0);
  EXPECT_THAT(read_text(folder / "out/sheet-fsr.html"), HasSubstr("Drawn: specimen q75, session 0."));
  twice.insert(twice.end(), {"--specimen", "q75"});
  const ProcessResult refused = forcegate(twice);
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.err, HasSubstr("specimen 'q75' is named twice"));
  // what the plan draws beside its specimens
  EXPECT_EQ(forcegate({"characterize", "--plan", folder / "plan.toml", "-o", folder / "out"}).exit_code, 0);
  EXPECT_THAT(read_text(folder / "out/sheet-fsr.html"), HasSubstr("Drawn: specimen q50, session 0, which is in no table."));
}

TEST(Characterize, EndsInALineThatRecordsTheCampaignToCompareWith) {
  const TemporaryFolder temporary;
  const fs::path& folder = temporary.path();
  write_text(folder / "plan.toml", plan_with("250.0"));
  const std::vector<std::string> words{"characterize", "--plan", folder / "plan.toml", "-o", folder / "out"};
  const std::string campaign = folder / "out/campaign";
  EXPECT_THAT(forcegate(words).out, HasSubstr("\nnext: forcegate record --specimen q25 --seed 5 --rig-option sensor=fsr -o " + campaign + "\n"));
  fs::create_directories(campaign);
  write_text(campaign + "/campaign.json", "{}");
  EXPECT_THAT(forcegate(words).out, HasSubstr("\nnext: forcegate compare " + campaign + " --model " + (folder / "out/fsr.toml").string() + "\n"));
}

TEST(Characterize, SaysWhatIsWrongWithARequest) {
  EXPECT_EQ(forcegate({"characterize", "--plan", "no-such-plan"}).exit_code, 2);
  const ProcessResult gate_plan =
      forcegate({"characterize", "--plan", FORCEGATE_SOURCE_DIR "/ci/plans/smoke.toml"});
  EXPECT_EQ(gate_plan.exit_code, 2);
  EXPECT_THAT(gate_plan.err, HasSubstr("this is a plan of a gate, not of a study"));
  const ProcessResult nothing = forcegate({"characterize", "--rig", "replay"});
  EXPECT_EQ(nothing.exit_code, 2);
  EXPECT_THAT(nothing.err, HasSubstr("--record"));
}

}  // namespace
}  // namespace forcegate::test
