// Bundles, goldens, waivers, rig qualification and the fault matrix as a lab uses them.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/support/process.h"

namespace forcegate::test {
namespace {

using ::testing::HasSubstr;
using Json = nlohmann::json;
namespace fs = std::filesystem;

constexpr const char* kGood = FORCEGATE_BINARY_DIR "/firmware/reference.native.so";
constexpr const char* kOff = FORCEGATE_BINARY_DIR "/firmware/mutants/compensation_off.native.so";
constexpr const char* kGain = FORCEGATE_BINARY_DIR "/firmware/mutants/gain_pct@2.native.so";
constexpr const char* kCrash = FORCEGATE_BINARY_DIR "/firmware/mutants/crash_after_min@1.native.so";
const ProcessOptions kHere{.folder = FORCEGATE_SOURCE_DIR, .timeout = std::chrono::minutes(14)};

ProcessResult run(const std::vector<std::string>& line) { return forcegate(line, kHere); }

class Trust : public ::testing::Test {
 protected:
  TemporaryFolder folder;
  std::string gated(const char* image, const std::string& name, std::vector<std::string> more = {}) {
    std::vector<std::string> line{"gate", image, "--plan", "faults", "-o", folder / name};
    line.insert(line.end(), more.begin(), more.end());
    const ProcessResult r = run(line);
    EXPECT_NE(r.exit_code, 2) << r.err;
    return folder / name;
  }
};

TEST_F(Trust, a_stored_run_gives_the_same_result_byte_for_byte_and_can_be_played_again) {
  const std::string stored = gated(kGood, "run");
  const ProcessResult r = run({"check", stored, "--replay"});
  EXPECT_EQ(r.exit_code, 0) << r.out << r.err;
  EXPECT_THAT(r.out, HasSubstr("byte for byte"));
  EXPECT_THAT(r.out, HasSubstr("2 records played again"));
}

TEST_F(Trust, what_a_run_was_compared_with_is_judged_again_too) {
  for (const auto& [image, code] : {std::pair{kGood, 0}, std::pair{kGain, 1}}) {
    const std::string stored = gated(image, "run", {"--accepted", kGood});
    EXPECT_THAT(read_text(fs::path(stored) / "result.json"), HasSubstr("no_worse_maxima/"));
    const ProcessResult r = run({"check", stored});
    EXPECT_EQ(r.exit_code, code) << r.out << r.err;
    EXPECT_THAT(r.out, HasSubstr("byte for byte"));
  }
}

TEST_F(Trust, the_accepted_build_is_no_worse_than_itself) {
  const std::string stored = gated(kGood, "accepted");
  for (const std::string& accepted : {stored, stored + "/result.json"}) {
    const ProcessResult r = forcegate({"gate", kGood, "--plan", "faults", "--accepted", accepted, "-o", folder / "again"}, kHere);
    EXPECT_EQ(r.exit_code, 0) << r.out << r.err;
  }
  write_text(folder / "alone.json", read_text(stored + "/result.json"));
  const ProcessResult values = forcegate({"gate", kGood, "--plan", "faults", "--accepted", folder / "alone.json", "-o", folder / "again"}, kHere);
  EXPECT_EQ(values.exit_code, 0) << values.out << values.err;
}

TEST_F(Trust, an_accepted_run_that_is_none_is_told) {
  const std::string rejected = gated(kOff, "rejected"), accepted = gated(kGood, "accepted");
  const auto notes_beside = [&](const std::string& run) {
    gated(kGood, "new", {"--accepted", run});
    return Json::parse(read_text(folder / "new/result.json"))["notes"].dump();
  };
  EXPECT_THAT(notes_beside(rejected), HasSubstr("which its own gate did not accept: REJECT"));
  EXPECT_THAT(notes_beside(accepted), testing::AllOf(HasSubstr("accepted build: "), testing::Not(HasSubstr("did not accept"))));
}

TEST_F(Trust, a_rig_fault_on_either_side_of_a_comparison_rejects_nobody) {
  const std::string sound = gated(kGood, "sound"), spoiled = gated(kGood, "spoiled", {"--fault", "reference_gain=0.95"});
  Json unstated = Json::parse(read_text(spoiled + "/result.json"));  // a rig tells nobody of its fault
  unstated["environment"].erase("faults");
  write_text(folder / "alone.json", unstated.dump());
  const auto exit_of = [&](const char* image, std::vector<std::string> more) {
    std::vector<std::string> line{"gate", image, "--plan", "faults", "-o", folder / "new"};
    line.insert(line.end(), more.begin(), more.end());
    const ProcessResult r = run(line);
    EXPECT_THAT(r.out, testing::Not(HasSubstr("to act: the firmware"))) << r.out;
    return r.exit_code;
  };
  EXPECT_EQ(exit_of(kGood, {"--fault", "reference_gain=0.95", "--accepted", sound}), 2) << "a fault on one side only";
  EXPECT_EQ(exit_of(kGood, {"--accepted", spoiled}), 2) << "a fault on the other";
  for (const std::string& accepted : {spoiled, std::string(kGain)})
    EXPECT_EQ(exit_of(kGood, {"--fault", "reference_gain=0.95", "--accepted", accepted}), 4) << accepted;
  EXPECT_EQ(run({"check", folder / "new"}).exit_code, 4) << "judged again it is the same";
  EXPECT_EQ(exit_of(kGood, {"--accepted", folder / "alone.json"}), 3);
  EXPECT_THAT(read_text(folder / "new/result.json"), HasSubstr("give a run on a sound rig"));
  EXPECT_EQ(run({"check", folder / "new"}).exit_code, 3) << "judged again it is the same";
}

TEST_F(Trust, a_rejected_run_is_measured_again_from_the_samples_it_kept) {
  const std::string stored = gated(kOff, "run");
  const ProcessResult r = run({"check", stored});
  EXPECT_EQ(r.exit_code, 1) << r.out << r.err;
  EXPECT_THAT(r.out, HasSubstr("measured again from their samples"));
  EXPECT_THAT(r.out, HasSubstr("byte for byte"));
}

TEST_F(Trust, a_changed_file_of_a_bundle_is_named) {
  const std::string stored = gated(kGood, "run");
  std::string records = read_text(fs::path(stored) / "bundle/records.jsonl");
  const std::size_t at = records.find("\"lag\":");
  ASSERT_NE(at, std::string::npos);
  records[at + 6] = '9';
  std::ofstream(fs::path(stored) / "bundle/records.jsonl", std::ios::binary) << records;
  const ProcessResult r = run({"check", stored});
  EXPECT_EQ(r.exit_code, 2) << r.out;
  EXPECT_THAT(r.err, HasSubstr("records.jsonl"));
}

TEST_F(Trust, an_edited_decision_is_told_as_that_and_never_shown_as_a_report) {
  run({"gate", kOff, "--case", "four_sines", "-o", folder / "run"});
  const std::string result = folder / "run/result.json";
  std::string text = read_text(result);
  const std::size_t at = text.find("REJECT");
  ASSERT_NE(at, std::string::npos);
  write_text(result, text.replace(at, 6, "ACCEPT"));
  for (const std::vector<std::string>& line : {std::vector<std::string>{"check", folder / "run"}, {"report", folder / "run"}, {"report", result}}) {
    const ProcessResult r = run(line);
    EXPECT_EQ(r.exit_code, 2) << r.out << r.err;
    EXPECT_THAT(r.err, HasSubstr("the result was changed after the run")) << line[0];
    EXPECT_THAT(r.err, HasSubstr("result.json"));
  }
}

TEST_F(Trust, the_same_records_are_rejected_under_a_tighter_plan) {
  const std::string stored = gated(kGood, "run");
  std::string plan = read_text(fs::path(FORCEGATE_SOURCE_DIR) / "ci/plans/faults.toml");
  const std::size_t at = plan.find("learning_s = 20");  // an error of 3 % might be the calibration's, a start window is the build's alone
  ASSERT_NE(at, std::string::npos);
  plan.replace(at, 15, "learning_s = 5");
  const std::string tight = folder / "tight.toml";
  std::ofstream(tight) << plan;
  const ProcessResult r = run({"check", stored, "--plan", tight});
  EXPECT_EQ(r.exit_code, 1) << r.out << r.err;
  EXPECT_THAT(r.out, HasSubstr("under the limits of the run: ACCEPT"));
}

TEST_F(Trust, diff_shows_what_a_gain_error_does_with_uncertainty) {
  const std::string a = gated(kGood, "a"), b = gated(kGain, "b");
  const ProcessResult r = run({"diff", a, b, "--json"});
  ASSERT_EQ(r.exit_code, 0) << r.err;
  const Json diff = Json::parse(r.out);
  EXPECT_TRUE(diff["same_conditions"].get<bool>());
  bool seen = false;
  for (const Json& c : diff["checks"])
    if (c["check"] == "mre_maxima" && c["case"] == "sine/q50") {
      seen = true;
      EXPECT_GT(std::abs(c["delta"].get<double>()), 0.3);
      EXPECT_GT(c["u"].get<double>(), 0.0);
    }
  EXPECT_TRUE(seen) << r.out;
  EXPECT_THAT(run({"diff", a, b}).out, testing::Not(testing::ContainsRegex("[0-9)] 1 \\("))) << "a number without a unit has none in text";
}

TEST_F(Trust, diff_refuses_a_result_that_was_edited) {
  const std::string a = gated(kGood, "a"), b = gated(kGain, "b");
  std::string text = read_text(b + "/result.json");
  const std::size_t at = text.find("REJECT");
  ASSERT_NE(at, std::string::npos);
  write_text(b + "/result.json", text.replace(at, 6, "ACCEPT"));
  for (const std::vector<std::string>& line : {std::vector<std::string>{"diff", a, b}, {"diff", b, a}, {"diff", a, b + "/result.json"}}) {
    const ProcessResult r = run(line);
    EXPECT_EQ(r.exit_code, 2) << r.out;
    EXPECT_THAT(r.err, HasSubstr("the result was changed after the run"));
  }
}

TEST_F(Trust, diff_shows_a_build_that_crashed) {
  const std::string a = gated(kGood, "a"), b = gated(kCrash, "b");
  const ProcessResult r = run({"diff", a, b});
  ASSERT_EQ(r.exit_code, 0) << r.err;
  EXPECT_THAT(r.out, HasSubstr("only in B"));
  EXPECT_THAT(r.out, HasSubstr("firmware_runs"));
  EXPECT_THAT(r.out, ::testing::Not(HasSubstr("nan")));
  EXPECT_THAT(run({"diff", a, a}).out, HasSubstr("0 checks differ\n"));
}

// Just inside and outside of what the rig's checks let pass, on the plan whose limits are tightest.
TEST_F(Trust, a_small_fault_of_the_rig_rejects_no_good_build) {
  for (const char* fault : {"specimen_swapped=0.95", "specimen_swapped=1.03", "specimen_swapped=1.1", "reference_gain=0.985", "motor_backlash=0.003", "motor_backlash=0.006"}) {
    const ProcessResult r = run({"gate", kGood, "--plan", "smoke", "--fault", fault, "-o", folder / "small"});
    EXPECT_THAT(r.exit_code, ::testing::AnyOf(0, 3, 4)) << fault << '\n' << r.out;
  }
}

// The matrix: no fault of rig, reference, sensor, link or board accepts or rejects a build, and the right party is blamed.
TEST_F(Trust, no_fault_of_the_rig_accepts_or_rejects_a_build) {
  const ProcessResult r = run({"bench", "faults", kGood, "--bad", kOff, "--json"});
  const Json matrix = Json::parse(r.out, nullptr, false);
  ASSERT_FALSE(matrix.is_discarded()) << r.out << r.err;
  EXPECT_EQ(matrix["wrong"].get<int>(), 0);
  for (const Json& row : matrix["faults"])
    EXPECT_EQ(row["wrong"].get<std::string>(), "")
        << row["fault"] << " " << row["magnitude"] << ": " << row["good"]["reason"];
  EXPECT_GE(matrix["faults"].size(), 63u);
  EXPECT_EQ(r.exit_code, 0);
}

TEST_F(Trust, a_golden_is_missing_then_blessed_then_held) {
  std::string plan = read_text(fs::path(FORCEGATE_SOURCE_DIR) / "ci/plans/faults.toml");
  plan.replace(plan.find("\"accuracy\"]"), 11, "\"accuracy\", \"golden\"]");
  plan.replace(plan.find("learning_s"), 0, "goldens = \"goldens/faults\"\n");
  const std::string path = folder / "plan.toml";
  std::ofstream(path) << plan;
  const auto gate = [&](const char* image, const std::string& name) {
    return run({"gate", image, "--plan", path, "--case", "sine", "-o", folder / name});
  };
  const ProcessResult missing = gate(kGood, "first");
  EXPECT_EQ(missing.exit_code, 3) << missing.out;
  EXPECT_THAT(missing.out, HasSubstr("no golden"));

  const std::string goldens = folder / "goldens/faults";
  EXPECT_EQ(
      run({"bless", folder / "first", "--who", "A. Smith", "--reason", " ", "--goldens", goldens}).exit_code,
      2);
  const ProcessResult blessed =
      run({"bless", folder / "first", "--who", "A. Smith", "--reason", "first golden", "--goldens", goldens});
  EXPECT_EQ(blessed.exit_code, 0) << blessed.out << blessed.err;
  EXPECT_THAT(read_text(fs::path(folder / "goldens") / "CHANGES.md"), HasSubstr("first golden"));
  EXPECT_THAT(blessed.out, HasSubstr("\nnext: git add " + goldens + " " + (folder / "goldens/CHANGES.md") + " && git commit -m 'first golden' -- "));

  const ProcessResult held = gate(kGood, "second");
  EXPECT_EQ(held.exit_code, 0) << held.out;
  const ProcessResult changed = gate(kGain, "third");
  EXPECT_EQ(changed.exit_code, 1) << changed.out;
  const ProcessResult again =
      run({"bless", folder / "second", "--who", "B", "--reason", "nothing new", "--goldens", goldens});
  EXPECT_THAT(again.out, HasSubstr("unchanged"));
  EXPECT_THAT(again.out, HasSubstr("\nnext: forcegate check ")) << "a command, and no sentence";
  const std::string golden = goldens + "/sine@q50.golden";
  std::string old = read_text(golden);
  const std::size_t rig = old.find("emulated/");
  ASSERT_NE(rig, std::string::npos) << old.substr(0, 400);
  old.erase(old.find("digest "), std::string("digest ").size() + 65);  // as older versions wrote it
  write_text(golden, old.replace(old.find("emulated/"), 10, "emulated/0"));
  EXPECT_THAT(run({"bless", folder / "second", "--who", "B", "--reason", "another rig", "--goldens", goldens}).out, HasSubstr("instead of emulated/0"));
  EXPECT_EQ(gate(kGood, "fourth").exit_code, 0);
  EXPECT_EQ(run({"bless", folder / "third", "--who", "B", "--reason", "x", "--goldens", goldens}).exit_code,
            2)
      << "a rejected run is never golden";
}

// No retry mends a golden that the plan has left behind: exit 3, and the plan is named, not the rig.
TEST_F(Trust, limits_of_a_plan_that_is_not_shipped_are_blessed_with_its_file) {
  const auto renamed = [](std::string text, const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
  };
  write_text(folder / "mine.toml", renamed(renamed(read_text(FORCEGATE_SOURCE_DIR "/ci/plans/smoke.toml"), "name = \"smoke\"", "name = \"mine\""), "../../golden/limits/smoke.toml", "lim.toml"));
  write_text(folder / "new.toml", renamed(read_text(FORCEGATE_SOURCE_DIR "/golden/limits/smoke.toml"), "plan = \"smoke\"", "plan = \"mine\""));
  const std::vector<std::string> line{"bless", folder / "new.toml", "--who", "B", "--reason", "first limits"};
  EXPECT_THAT(run(line).err, HasSubstr("--plan FOLDER/mine.toml"));
  std::vector<std::string> with = line;
  with.insert(with.end(), {"--plan", folder / "mine.toml"});
  EXPECT_EQ(run(with).exit_code, 0) << run(with).err;
  EXPECT_THAT(read_text(folder / "lim.toml"), HasSubstr("plan = \"mine\""));
  with.back() = "smoke";
  EXPECT_THAT(run(with).err, HasSubstr("not of 'smoke'"));
}

TEST_F(Trust, a_golden_of_another_profile_is_not_the_rigs_fault) {
  for (const auto& [from, to] : {std::pair{"m_N = 2.0, duration_s = 600", "m_N = 2.0, duration_s = 300"}, std::pair{"m_N = 2.0, duration_s = 600", "m_N = 2.15, duration_s = 600"}}) {
    std::string plan = read_text(FORCEGATE_SOURCE_DIR "/ci/plans/smoke.toml");
    const std::size_t at = plan.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    plan.replace(at, std::string(from).size(), to);
    const std::string file = folder / "changed.toml";
    std::ofstream(file) << plan;
    const ProcessResult r = run({"gate", kGood, "--plan", file, "--golden", "golden/traces/smoke", "--limits", "golden/limits/smoke.toml", "--case", "four_sines", "-o", folder / "run"});
    EXPECT_EQ(r.exit_code, 3) << r.out << r.err;
    EXPECT_THAT(r.out, HasSubstr("another profile")) << to;
    EXPECT_THAT(r.out, HasSubstr("to act: the plan")) << to;
  }
}

TEST_F(Trust, the_committed_goldens_of_the_smoke_plan_hold_and_every_margin_is_kept) {
  const ProcessResult r = run({"gate", kGood, "--golden", "golden/traces/smoke", "-o", folder / "run"});
  EXPECT_EQ(r.exit_code, 0) << r.out << r.err;
  for (const char* name :
       {"sine_f0.50_A1.50_m2.70@q50", "four_sines@q50", "hold_after_cycling@q50", "force_control_sine@q50"}) {
    std::ifstream margins(fs::path(folder / "run") / "golden" / (std::string(name) + ".csv"));
    std::string line;
    ASSERT_TRUE(std::getline(margins, line)) << name;
    EXPECT_EQ(line, "curve,where,t_s,golden_N,tested_N,margin_N");
    std::size_t samples = 0;
    for (; std::getline(margins, line); ++samples)
      EXPECT_GE(std::stod(line.substr(line.rfind(',') + 1)), 0.0) << name << ": " << line;
    EXPECT_GT(samples, 200u) << name;
  }
  // Under another seed the rig's truth is still held, the firmware's curve is not comparable.
  const ProcessResult other = run({"gate", kGood, "--golden", "golden/traces/smoke", "--seed", "8", "--case",
                                   "sine_f0.50_A1.50_m2.70", "-o", folder / "run"});
  EXPECT_EQ(other.exit_code, 0) << other.out << other.err;
  EXPECT_THAT(other.out.substr(0, other.out.find('\n')), HasSubstr("firmware against its golden trace was not run: the golden is of another seed (7, this record has 8)"));
  fs::create_directories(folder / "empty");
  EXPECT_EQ(run({"gate", kGood, "--golden", folder / "empty", "--case", "four_sines", "-o", folder / "run"}).exit_code, 3);
  EXPECT_EQ(run({"gate", kGood, "--golden", folder / "nowhere", "--case", "four_sines", "-o", folder / "run"}).exit_code, 2) << "a typing mistake";
}

TEST_F(Trust, a_waiver_holds_until_its_day) {
  const std::string waivers = folder / "waivers.toml";
  std::ofstream(waivers) << "format = 1\n";
  for (const char* check : {"mre_maxima", "mre_minima", "promise_maxima", "promise_minima", "conformance",
                            "prelude_conformance", "hold_amplification"})
    std::ofstream(waivers, std::ios::app)
        << "[[waiver]]\ncase = \"*\"\ncheck = \"" << check
        << "\"\nowner = \"A. Smith\"\nreason = \"known\"\nexpires = \"2026-12-31\"\n";
  const auto on = [&](const std::string& day) {
    return run(
        {"gate", kOff, "--plan", "faults", "--waivers", waivers, "--today", day, "-o", folder / "run"});
  };
  const ProcessResult before = on("2026-12-31"), after = on("2027-01-01");
  EXPECT_EQ(before.exit_code, 0) << before.out;
  EXPECT_THAT(before.out, HasSubstr("waived"));
  EXPECT_EQ(after.exit_code, 1) << after.out;
  EXPECT_EQ(run({"check", folder / "run", "--today", "2026-06-01"}).exit_code, 0);
}

TEST_F(Trust, a_rig_is_found_fit_and_its_visits_are_charted) {
  const std::string history = folder / "bench.jsonl";
  for (int i = 0; i < 9; ++i) {
    const ProcessResult r = run({"bench", "selfcheck", kGood, "--seed", std::to_string(i + 1), "--history",
                                 history, "-o", folder / "s"});
    EXPECT_EQ(r.exit_code, 0) << r.out << r.err;
  }
  const ProcessResult other =
      run({"bench", "selfcheck", kOff, "--seed", "1", "--history", history, "-o", folder / "s", "--json"});
  EXPECT_EQ(other.exit_code, 4) << "a build that is not known to be good";
  EXPECT_EQ(Json::parse(other.out)["visits"].get<int>(), 1) << "the visits of another build are no measure of it";
  const ProcessResult back = run({"bench", "selfcheck", kGood, "--seed", "10", "--history", history, "-o", folder / "s", "--json"});
  EXPECT_EQ(back.exit_code, 0) << back.out << back.err;
  EXPECT_EQ(Json::parse(back.out)["visits"].get<int>(), 10);
  EXPECT_EQ(Json::parse(back.out)["left_out"].get<int>(), 1);
}

TEST_F(Trust, repeatability_writes_only_limits_that_the_rig_resolves) {
  const std::string limits = folder / "limits.toml";
  const ProcessResult r = run({"bench", "repeatability", kGood, "--count", "6", "-o", limits});
  EXPECT_THAT(r.out, HasSubstr("%GRR"));
  EXPECT_THAT(read_text(limits), HasSubstr("rig = \"emulated/1 emulated-flexiforce\""));
  EXPECT_TRUE(r.exit_code == 0 || r.exit_code == 3) << r.err;
  const ProcessResult own = run({"gate", kGood, "--plan", "selfcheck", "--limits", limits, "-o", folder / "own"});
  EXPECT_EQ(own.exit_code, 0) << "the build that the limits are made of passes them by its uncertainty\n" << own.out;
}

}  // namespace
}  // namespace forcegate::test
