// What a decision stands on: records that were played, of the plan that it names, by an image that repeats itself; and what a run leaves
// of others.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/support/process.h"

namespace forcegate::test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using Json = nlohmann::json;
namespace fs = std::filesystem;

constexpr const char* kGood = FORCEGATE_BINARY_DIR "/firmware/reference.native.so";
constexpr const char* kUart = FORCEGATE_BINARY_DIR "/firmware/reference.uart.elf";
constexpr const char* kCrash = FORCEGATE_BINARY_DIR "/firmware/mutants/crash_after_min@1.native.so";
const ProcessOptions kHere{.folder = FORCEGATE_SOURCE_DIR, .timeout = std::chrono::minutes(10)};

constexpr const char* kPlan = R"(format = 1
name = "fast"
seed = 7
[panel]
specimens = ["q25", "q50"]
[calibration]
level = "static"
[safety]
force_max_N = 5.2
[[case]]
name = "slow"
checks = ["accuracy"]
stimulus = { name = "sine", f_Hz = 2, A_N = 1.05, m_N = 2.15, duration_s = 90, ramp_s = 2 }
maxima_pct = 95
minima_pct = 95
limit_source = "ours"
[[case]]
name = "fast"
checks = ["accuracy"]
stimulus = { name = "sine", f_Hz = 3, A_N = 1.05, m_N = 2.15, duration_s = 90, ramp_s = 2 }
maxima_pct = 95
minima_pct = 95
limit_source = "ours"
)";

// An image of the native port around the inside of its process function.
constexpr const char* kImage = R"(#include <string.h>
#include <time.h>
#ifdef __cplusplus
#include <vector>
extern "C" {
#endif
#include "ports/native.h"
static float gain, offset;
uint32_t forcegate_native_abi(void) { return FORCEGATE_NATIVE_ABI; }
int32_t forcegate_native_open(uint32_t nonce, const ForcegateNativeCalibration* in, ForcegateNativeInfo* info) {
  memset(info, 0, sizeof *info);
  info->nonce = nonce, info->protocol_major = 1, info->rate_Hz = 1000, info->calibration = *in;
  memcpy(info->board, "native", 6), memcpy(info->algorithm_id, "clock/1", 7);
  memcpy(info->build_id, "0123456789012345678901234567890123456789", 40);
  gain = in->gain_N_per_V * in->v_range_V / (float)((1u << in->adc_bits) - 1u), offset = in->offset_N;
  return 0;
}
int32_t forcegate_native_process(uint32_t first, uint32_t n, const uint16_t* adc, float* force_N, uint8_t* flags) {
PROCESS}
void forcegate_native_close(void) {}
#ifdef __cplusplus
}
#endif
)";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size()) text.replace(at, from.size(), to);
  return text;
}

class GateEvidence : public ::testing::Test {
 protected:
  GateEvidence() { write_text(plan, kPlan); }
  ProcessResult run(std::vector<std::string> line, const ProcessOptions& options = kHere) { return forcegate(std::move(line), options); }
  ProcessResult gate(const std::string& image, const std::string& name, const std::vector<std::string>& more = {}, const ProcessOptions& options = kHere) {
    std::vector<std::string> line{"gate", image, "--plan", plan, "-o", folder / name};
    line.insert(line.end(), more.begin(), more.end());
    return run(line, options);
  }
  /// "clock.c" or "clock.cpp": the image of the port with this inside of its process function.
  std::string built(const std::string& name, const std::string& process) {
    const std::string source = folder / name, image = source + ".so";
    write_text(source, replaced(kImage, "PROCESS", process));
    const ProcessResult made = run_process({name.ends_with(".c") ? "cc" : "c++", "-shared", "-fPIC", "-O1", "-I", FORCEGATE_SOURCE_DIR "/rigs/firmware", "-o", image, source});
    EXPECT_EQ(made.exit_code, 0) << made.err;
    return image;
  }
  Json result(const std::string& name) { return Json::parse(read_text(folder / (name + "/result.json"))); }

  TemporaryFolder folder;
  std::string plan = folder / "plan.toml";
};

TEST_F(GateEvidence, AnImageThatDoesNotRepeatItselfIsRejectedForIt) {
  const std::string image = built("clock.c", R"(  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  for (uint32_t i = 0; i < n; ++i) force_N[i] = gain * (float)adc[i] + offset + 1e-6f * (float)(now.tv_nsec % 1000), flags[i] = 0;
  return 0;
)");
  const ProcessResult r = gate(image, "run");
  EXPECT_EQ(r.exit_code, 1) << r.out << r.err;
  const Json stored = result("run");
  EXPECT_THAT(stored["decision"]["reason"].get<std::string>(), HasSubstr("does not repeat"));
  EXPECT_EQ(stored["decision"]["blame"], "firmware");
  for (const char* more : {"--threads=1", "--replay"}) {
    const ProcessResult again = run({"check", folder / "run", more});
    EXPECT_EQ(again.exit_code, 1) << again.out << again.err;
    EXPECT_THAT(again.out, HasSubstr("byte for byte"));
  }
  // In doubt: every record is played again with a recorder, and samples that are of no record do not stay.
  write_text(plan, replaced(kPlan, "_pct = 95", "_pct = 1"));
  gate(image, "doubt");
  EXPECT_THAT(result("doubt")["checks"].dump(), HasSubstr("firmware_repeats"));
  EXPECT_TRUE(!fs::exists(folder / "doubt/traces") || fs::is_empty(folder / "doubt/traces"));
}

TEST_F(GateEvidence, AnImageThatThrowsIsRejectedForWhatItThrows) {
  const auto thrown_by = [&](const std::string& name, const std::string& process) {
    const ProcessResult r = gate(built(name + ".cpp", process), name);
    EXPECT_EQ(r.exit_code, 1) << r.out << r.err;
    const Json decision = result(name)["decision"];
    EXPECT_EQ(decision["blame"], "firmware");
    return decision["reason"].get<std::string>();
  };
  const std::string answer = "  for (uint32_t i = 0; i < n; ++i) force_N[i] = gain * (float)adc[i] + offset, flags[i] = 0;\n";
  EXPECT_THAT(thrown_by("number", answer + "  if (first >= 30000) throw 1;\n  return 0;\n"), HasSubstr("the image throws a C++ exception in the block of"));
  EXPECT_THAT(thrown_by("range", answer + "  static std::vector<int> three(3);\n  return first < 30000 ? 0 : three.at(first);\n"), HasSubstr("vector::_M_range_check"));
  // Within the loader no exception can be caught.
  EXPECT_THAT(thrown_by("loaded", answer + "  struct Thrower { Thrower() { throw 1; } };\n  return 0;\n}\nstruct AtStart { AtStart() { throw 1; } } at_start;\nstatic void unused() {\n"),
              HasSubstr("ABRT"));
}

TEST_F(GateEvidence, APartOfAPlanIsToldAsOneAndNoSpecimenCountsTwice) {
  EXPECT_EQ(gate(kGood, "whole").exit_code, 0);
  EXPECT_THAT(result("whole")["notes"].dump(), Not(HasSubstr("of the plan are played")));
  EXPECT_EQ(gate(kGood, "part", {"--case", "slow", "--specimen", "q50"}).exit_code, 0);
  EXPECT_THAT(result("part")["notes"].dump(), HasSubstr("1 of 2 cases and 1 of 4 records of the plan are played: what else it asks for was not judged; specimens left out: q25"));
  EXPECT_EQ(gate(kGood, "other", {"--case", "slow", "--specimen", "q75"}).exit_code, 0);
  EXPECT_THAT(result("other")["notes"].dump(), HasSubstr("1 of 2 cases and 0 of 4 records of the plan are played: what else it asks for was not judged; records beside it: 1; specimens left out: q25, q50; "
                                                         "specimens that the plan does not name: q75"));
  const ProcessResult twice = gate(kGood, "twice", {"--specimen", "q50", "--specimen", "q50"});
  EXPECT_EQ(twice.exit_code, 2) << twice.out;
  EXPECT_THAT(twice.err, HasSubstr("specimen 'q50' is named twice"));
}

TEST_F(GateEvidence, ARecordIsTheSameWhicheverOthersArePlayed) {
  ASSERT_EQ(gate(kGood, "whole").exit_code, 0);
  ASSERT_EQ(gate(kGood, "part", {"--case", "fast", "--accepted", folder / "whole"}).exit_code, 0);
  const auto digest = [&](const std::string& run, const std::string& id) {
    const Json stored = result(run);
    for (const Json& c : stored["cases"])
      if (c["id"] == id) return c["digest"].get<std::string>();
    return std::string();
  };
  EXPECT_FALSE(digest("part", "fast/q50").empty());
  EXPECT_EQ(digest("part", "fast/q50"), digest("whole", "fast/q50"));
}

TEST_F(GateEvidence, ABuildIsNotWorseThanItselfUnderOtherConditions) {
  ASSERT_EQ(gate(kGood, "accepted").exit_code, 0);
  write_text(folder / "cal.toml", "gain_N_per_V = 0.62\noffset_N = 0.1\nid = \"mine\"\n");
  const std::vector<std::pair<std::vector<std::string>, const char*>> others = {
      {{"--fault", "reference_gain=1.01"}, "other faults: none (here reference_gain=1.01)"},
      {{"--rig-option", "hidden=creep:strong"}, "other options of the rig: none (here hidden=creep:strong)"},
      {{"--calibration", "nominal"}, "another calibration in slow/q25: level static and nominal"},
      {{"--cal", folder / "cal.toml", "--specimen", "q25"}, "another calibration in slow/q25"}};
  for (const auto& [more, what] : others) {
    std::vector<std::string> line = more;
    line.insert(line.end(), {"--accepted", folder / "accepted"});
    const ProcessResult r = gate(kGood, "new", line);
    EXPECT_EQ(r.exit_code, 2) << r.out << r.err;
    EXPECT_THAT(r.err, HasSubstr(what));
  }
  ASSERT_NE(gate(kGood, "nominal", {"--calibration", "nominal"}).exit_code, 2);
  const ProcessResult diff = run({"diff", folder / "accepted", folder / "nominal"});
  EXPECT_THAT(diff.out, HasSubstr("NOT the same conditions"));
  EXPECT_THAT(diff.out, HasSubstr("calibration of 4 records: slow/q25 level static and nominal"));
}

TEST_F(GateEvidence, ACalibrationThatIsGivenIsOfOneSpecimenAndHasItsLevelInItsFile) {
  write_text(folder / "cal.toml", "gain_N_per_V = 0.62\noffset_N = 0.15\nb_scale = 1.2\nq_scale = 0.8\nlevel = \"identified\"\n");
  const ProcessResult all = gate(kGood, "all", {"--cal", folder / "cal.toml"});
  EXPECT_EQ(all.exit_code, 2) << all.out;
  EXPECT_THAT(all.err, HasSubstr("a calibration is of one specimen, and 2 would be judged by it: q25, q50"));
  for (const char* level : {"nominal", "static", "identified"}) {
    const ProcessResult both = gate(kGood, "both", {"--cal", folder / "cal.toml", "--specimen", "q50", "--calibration", level});
    EXPECT_EQ(both.exit_code, 2) << both.out;
    EXPECT_THAT(both.err, HasSubstr("its level is in its file"));
  }
  const ProcessResult other = run({"gate", kGood, "--plan", "smoke", "--specimen", "q50", "--case", "sine_f0.50_A1.50_m2.70", "--cal", folder / "cal.toml", "-o", folder / "other"});
  EXPECT_EQ(other.exit_code, 3) << other.out << other.err;
  EXPECT_THAT(other.out, HasSubstr("NO-DECISION"));
  EXPECT_THAT(other.out, Not(HasSubstr("to act: the firmware")));
}

TEST_F(GateEvidence, AnImageThatIsCutShortIsToldBeforeAnythingMoves) {
  for (const char* image : {kGood, kUart}) {
    const std::string whole = read_text(image);
    write_text(folder / "cut", whole.substr(0, whole.size() - 1000));  // with what tells its lane
    const ProcessResult r = gate(folder / "cut", "cut-run");
    EXPECT_EQ(r.exit_code, 2) << r.out;
    EXPECT_THAT(r.err, HasSubstr("cut short or damaged: it has " + std::to_string(whole.size() - 1000) + " bytes"));
    EXPECT_THAT(r.err, Not(HasSubstr("%"))) << "no progress of a calibration";
  }
}

TEST_F(GateEvidence, UnderAnotherPlanWhatWasNotPlayedIsMissingAndOldLimitsAreGone) {
  ASSERT_EQ(gate(kGood, "part", {"--case", "slow"}).exit_code, 0);
  const ProcessResult part = run({"check", folder / "part", "--plan", plan, "-o", folder / "judged.json"});
  EXPECT_EQ(part.exit_code, 3) << part.out << part.err;
  EXPECT_THAT(part.out, HasSubstr("the run has no fast of q25"));
  write_text(folder / "other.toml", replaced(kPlan, "name = \"fast\"\nseed", "name = \"other\"\nseed"));
  EXPECT_EQ(run({"check", folder / "part", "--plan", folder / "other.toml", "-o", folder / "judged.json"}).exit_code, 3);
  EXPECT_EQ(Json::parse(read_text(folder / "judged.json"))["plan_name"], "other");
  write_text(folder / "longer.toml", replaced(kPlan, "duration_s = 90", "duration_s = 120"));
  const ProcessResult longer = run({"check", folder / "part", "--plan", folder / "longer.toml"});
  EXPECT_EQ(longer.exit_code, 2) << longer.out;
  EXPECT_THAT(longer.err, HasSubstr("is another profile than the run played"));
  // limits of the run are not those of a plan that has none
  const std::string none = replaced(kPlan, "maxima_pct = 95\nminima_pct = 95\nlimit_source = \"ours\"\n", "");
  write_text(folder / "derived.toml", replaced(none, "[safety]", "[limits]\nderived = \"lim.toml\"\n[safety]"));
  std::string limits = "format = 2\nplan = \"fast\"\nfirmware_sha256 = \"ab\"\nrig = \"emulated/1\"\ndate = \"2026-01-02\"\n";
  for (const char* name : {"slow", "fast"})
    for (const char* check : {"mre_maxima", "mre_minima"})
      limits += std::string("[[limit]]\ncase = \"") + name + "\"\ncheck = \"" + check + "\"\np99_upper = 93\nsd = 1\nvalue = 95\nunit = \"%\"\nn = 300\n";
  write_text(folder / "lim.toml", limits);
  write_text(folder / "none.toml", none);
  ASSERT_EQ(run({"gate", kGood, "--plan", folder / "derived.toml", "-o", folder / "limited"}).exit_code, 0);
  const ProcessResult old = run({"check", folder / "limited", "--plan", folder / "none.toml"});
  EXPECT_EQ(old.exit_code, 3) << old.out << old.err;
  EXPECT_THAT(old.out, HasSubstr("there is no limit for"));
}

TEST_F(GateEvidence, WithoutARecordOfTheAcceptedBuildTheStoredDecisionStands) {
  ASSERT_EQ(gate(kGood, "run", {"--accepted", kCrash}).exit_code, 3);
  const ProcessResult r = run({"check", folder / "run"});
  EXPECT_EQ(r.exit_code, 3) << r.out << r.err;
  EXPECT_THAT(r.out, HasSubstr("byte for byte"));
}

TEST_F(GateEvidence, ARunThatCannotBeginLeavesTheOlderResultItsName) {
  ASSERT_EQ(gate(kGood, "run").exit_code, 0);
  const std::string before = read_text(folder / "run/result.json");
  ProcessOptions bare = kHere;
  bare.environment["PATH"] = "/nonexistent";
  const ProcessResult r = gate(kUart, "run", {}, bare);
  EXPECT_EQ(r.exit_code, 2) << r.out << r.err;
  EXPECT_EQ(read_text(folder / "run/result.json"), before);
}

TEST_F(GateEvidence, NamesThatOnlyLookLikeThoseOfARunAreNotTouched) {
  for (const char* name : {"run.part-B", "run.part-1st", "run.older-monday", "run.older-999999999"}) {
    fs::create_directories(folder / name);
    write_text(folder / (std::string(name) + "/recording.csv"), "t_s\n");
  }
  ASSERT_EQ(gate(kGood, "run").exit_code, 0);
  for (const char* name : {"run.part-B", "run.part-1st", "run.older-monday", "run.older-999999999"})
    EXPECT_EQ(read_text(folder / (std::string(name) + "/recording.csv")), "t_s\n") << name;
}

TEST_F(GateEvidence, AClosedTerminalEndsARunAsCtrlCDoes) {
  ProcessOptions options = kHere;
  options.signal_after = std::chrono::milliseconds(700);
  options.signal = 1;
  const ProcessResult r = run({"gate", kGood, "--plan", "nightly", "-o", folder / "run"}, options);
  EXPECT_EQ(r.exit_code, 130) << r.out << r.err;
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), {}), 1) << "the plan alone is there";
}

TEST_F(GateEvidence, EditedLimitsAreNotBlessed) {
  const auto mine = [](const std::string& text) { return replaced(replaced(replaced(text, "name = \"smoke\"", "name = \"mine\""), "plan = \"smoke\"", "plan = \"mine\""), "../../golden/limits/smoke.toml", "lim.toml"); };
  write_text(folder / "mine.toml", mine(read_text(FORCEGATE_SOURCE_DIR "/ci/plans/smoke.toml")));
  const std::string limits = mine(read_text(FORCEGATE_SOURCE_DIR "/golden/limits/smoke.toml"));
  for (const auto& [text, exit_code] : {std::pair{limits, 0}, std::pair{replaced(limits, "value = 9.1684", "value = 99.0"), 2}}) {
    write_text(folder / "new.toml", text);
    const ProcessResult r = run({"bless", folder / "new.toml", "--plan", folder / "mine.toml", "--reason", "r", "--who", "w"});
    EXPECT_EQ(r.exit_code, exit_code) << r.out << r.err;
    EXPECT_EQ(r.err.find("is not the derived one") != std::string::npos, exit_code != 0) << r.err;
  }
}

TEST_F(GateEvidence, PowerClaimsNoAcceptanceOfWhatIsNotThere) {
  fs::create_directories(folder / "firmware/mutants");
  fs::copy_file(FORCEGATE_BINARY_DIR "/firmware/mutants/gain_pct.mutant", folder / "firmware/mutants/gain_pct.mutant");
  const ProcessResult r = run({"power", "--firmware", folder / "firmware", "--seeds", "59", "-q"});
  EXPECT_EQ(r.exit_code, 2) << r.out;
  EXPECT_THAT(r.err, HasSubstr("there is no reference image"));
  EXPECT_EQ(run({"power", "--firmware", folder / "firmware", "--seeds", "0", "-q"}).exit_code, 1);
}

TEST_F(GateEvidence, ALimitsFileThatIsNotThereIsToldBeforeAnythingIsPlayed) {
  const std::string none = replaced(kPlan, "maxima_pct = 95\nminima_pct = 95\nlimit_source = \"ours\"\n", "");
  write_text(plan, replaced(none, "[safety]", "[limits]\nderived = \"nosuch.toml\"\n[safety]"));
  const ProcessResult r = gate(kGood, "run");
  EXPECT_EQ(r.exit_code, 2) << r.out << r.err;
  EXPECT_THAT(r.err, HasSubstr("nosuch.toml"));
  EXPECT_THAT(r.err, HasSubstr("where: " + plan + ":9:1"));
  EXPECT_THAT(r.err, HasSubstr("forcegate limits GOOD --plan " + plan));
  EXPECT_FALSE(fs::exists(folder / "run"));
  const ProcessResult planned = run({"plan", plan});
  EXPECT_THAT(planned.out, HasSubstr(plan + ":9:1): forcegate gate refuses it"));
  EXPECT_THAT(planned.out, HasSubstr("next: mend the plan"));
  // the way in which the file comes to be, and a plan whose cases have limits of their own until then
  EXPECT_EQ(run({"limits", kGood, "--plan", plan, "--count", "10", "-o", folder / "new.toml"}).exit_code, 0);
  EXPECT_EQ(run({"gate", kGood, "--plan", plan, "--limits", folder / "new.toml", "-o", folder / "limited"}).exit_code, 0);
  write_text(plan, replaced(kPlan, "[safety]", "[limits]\nderived = \"nosuch.toml\"\n[safety]"));
  EXPECT_EQ(gate(kGood, "own").exit_code, 0);
}

TEST_F(GateEvidence, WhoBlessesARunThatHadNoGoldensIsToldToGateWithThem) {
  ASSERT_EQ(gate(kGood, "run").exit_code, 0);
  fs::create_directories(folder / "goldens");
  const ProcessResult r = run({"bless", folder / "run", "--reason", "first", "--who", "A. Smith", "--goldens", folder / "goldens"});
  EXPECT_EQ(r.exit_code, 2) << r.out;
  EXPECT_THAT(r.err, HasSubstr("help: gate with --golden " + (folder / "goldens") + " and bless that run"));
  EXPECT_THAT(gate(kGood, "none", {"--golden", folder / "nowhere"}).err, HasSubstr("gate with --golden"));
  const ProcessResult first = run({"bless", folder / "run", "--reason", "first", "--who", "A. Smith", "--goldens", folder / "new"});
  EXPECT_THAT(first.err, HasSubstr("help: make the folder (mkdir " + (folder / "new") + "), gate with --golden " + (folder / "new")));
  EXPECT_THAT(run({"bless", folder / "run", "--reason", "first", "--who", "A. Smith"}).err, HasSubstr("help: make a folder (mkdir FOLDER), gate with --golden FOLDER"));
}

TEST_F(GateEvidence, ALimitsFileThatIsNotThereIsNoMissingFolder) {
  const ProcessResult r = run({"bless", folder / "nofile.toml", "--reason", "first", "--who", "A. Smith"});
  EXPECT_EQ(r.exit_code, 2);
  EXPECT_THAT(r.err, HasSubstr("there is no such file of limits"));
  EXPECT_THAT(r.err, HasSubstr("forcegate limits -o"));
}

TEST_F(GateEvidence, APlanThatTheGateRefusesIsNotRecommendedToIt) {
  write_text(plan, replaced(kPlan, "checks = [\"accuracy\"]", "checks = []"));
  const ProcessResult refused = run({"plan", plan});
  EXPECT_THAT(refused.out, HasSubstr("forcegate gate refuses it"));
  EXPECT_THAT(refused.out, Not(HasSubstr("next: forcegate gate")));
  EXPECT_THAT(refused.out, HasSubstr("next: mend the plan"));
  write_text(plan, replaced(replaced(kPlan, "checks = [\"accuracy\"]", "checks = [\"golden\"]"), "[safety]", "[limits]\ngoldens = \"nowhere\"\n[safety]"));
  EXPECT_THAT(run({"plan", plan}).out, HasSubstr("nowhere, and without a golden there is no decision"));
}

TEST_F(GateEvidence, WhatAPlanCannotPassOrNeverJudgesIsToldBeforeItIsPlayed) {
  const auto told = [&](const std::string& from, const std::string& to) {
    write_text(plan, replaced(kPlan, from, to));
    const ProcessResult r = run({"plan", plan});
    return std::pair(r.exit_code, r.out + r.err);
  };
  EXPECT_THAT(told("[safety]", "[limits]\nlag_s = 0\n[safety]"), testing::Pair(2, testing::AllOf(HasSubstr("lag_s = 0 passes no firmware"), HasSubstr("plan.toml:"))));
  EXPECT_THAT(told("maxima_pct = 95", "maxima_pct = 0"), testing::Pair(2, HasSubstr("maxima_pct = 0 passes no firmware")));
  EXPECT_THAT(told("[safety]", "[limits]\nlag_s = 50\n[safety]"), testing::Pair(0, HasSubstr("case slow: the lag is never decided, half a period of 0.25 s")));
  EXPECT_THAT(told("minima_pct = 95\n", ""), testing::Pair(0, HasSubstr("case slow asks for an accuracy and has no limit for its minima (mre_minima)")));
  EXPECT_THAT(told("maxima_pct = 95\n", "maxima_pct = 95\ntail_s = 5000\n"), testing::Pair(0, HasSubstr("tail_s = 5000 s is no less than the record's 90 s")));
  EXPECT_THAT(told("maxima_pct = 95\n", "maxima_pct = 95\ntail_s = 0.5\n"), testing::Pair(0, HasSubstr("tail_s = 0.5 s holds fewer than two periods")));
  EXPECT_THAT(told("maxima_pct", "maxima_pct"), testing::Pair(0, Not(HasSubstr("note: "))));
}

TEST_F(GateEvidence, AGateThatAlwaysEndsUndecidedIsARemarkOfThePlan) {
  const auto told = [&](const std::string& from, const std::string& to) {
    write_text(plan, replaced(kPlan, from, to));
    return run({"plan", plan}).out;
  };
  const std::string few = "extrema that stand out by ";
  EXPECT_THAT(told("A_N = 1.05", "A_N = 0.02"), HasSubstr("case slow: its profile has 0 " + few + "0.05 N"));
  EXPECT_THAT(told("A_N = 1.05", "A_N = 0"), HasSubstr("its profile has 0 " + few));
  EXPECT_THAT(told("maxima_pct = 95\n", "maxima_pct = 95\nprominence_N = 3\n"), HasSubstr("its profile has 0 " + few + "3 N"));
  EXPECT_THAT(told("f_Hz = 2,", "f_Hz = 0.015,"), HasSubstr("case slow: its profile has 2 " + few + "0.2625 N (prominence_N), an accuracy needs 4"));
  EXPECT_THAT(told("f_Hz = 2,", "f_Hz = 40,"), HasSubstr("case slow: the wheel is commanded every 10 ms and does not follow 40 Hz, at most 25 Hz"));
  EXPECT_THAT(told("\"accuracy\"", "\"hold\""), HasSubstr("case slow asks for 'hold', and its profile holds no force for more than 30 s"));
  const std::string golden = told("\"accuracy\"", "\"golden\"");
  EXPECT_THAT(golden, HasSubstr("[limits] names no folder of them (goldens = "));
  EXPECT_THAT(golden, Not(HasSubstr("no folder ,")));
}

}  // namespace
}  // namespace forcegate::test
