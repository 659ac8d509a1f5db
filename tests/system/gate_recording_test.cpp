// `forcegate gate --record`: which files and columns it takes, and what it says of those that it cannot.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/support/process.h"

namespace forcegate::test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using Json = nlohmann::json;

constexpr const char* kNative = FORCEGATE_BINARY_DIR "/firmware/reference.native.so";
const ProcessOptions kHere{.folder = FORCEGATE_SOURCE_DIR, .timeout = std::chrono::minutes(10)};

class GateRecording : public ::testing::Test {
 protected:
  TemporaryFolder folder;

  std::string sine(const std::string& name, const std::string& force, double newton_per_unit) {
    std::string text = "t_s," + force + ",U_V\n";
    for (int i = 0; i < 20000; ++i) {
      const double load_N = 2.5 - 1.5 * std::cos(0.5 * 2.0 * 3.14159265 * 0.001 * i);
      text += std::to_string(0.001 * i) + "," + std::to_string(load_N / newton_per_unit) + "," + std::to_string(load_N / 0.5) + "\n";
    }
    const std::string path = folder / name;
    write_text(path, text);
    return path;
  }
  Json checks(std::vector<std::string> record) {
    record.insert(record.begin(), {"gate", kNative, "-o", folder / "run", "--record"});
    const ProcessResult r = forcegate(record, kHere);
    EXPECT_NE(r.exit_code, 2) << r.err;
    const Json result = Json::parse(read_text(folder / "run/result.json"), nullptr, false);
    return result.is_object() ? result["cases"][0]["checks"] : Json();
  }
};

// A hold is told by the set-point, which a recording of ours has; without that column it is said, and nobody is asked for a longer one.
TEST_F(GateRecording, OfAHoldIsJudgedByItsSetPointAndWithoutOneSaysSo) {
  const std::string csv = folder / "hold.csv", cal = folder / "cal.toml";
  write_text(cal, "gain_N_per_V = 0.54196\noffset_N = 0.103906\nb_scale = 1.04885\nq_scale = 0.98853\nlevel = \"identified\"\n");
  const ProcessResult kept = forcegate({"gate", kNative, "--plan", "smoke", "--case", "hold_after_cycling", "--keep", "-o", folder / "kept"}, kHere);
  ASSERT_EQ(kept.exit_code, 0) << kept.out << kept.err;
  ASSERT_EQ(forcegate({"convert", folder / "kept/traces/hold_after_cycling@q50.h5", csv}, kHere).exit_code, 0);
  const auto hold = [&](std::vector<std::string> line) {
    line.insert(line.end(), {"--plan", "smoke", "--case", "hold_after_cycling", "--cal", cal});
    for (const Json& check : checks(line))
      if (check["id"] == "hold_amplification") return check;
    return Json();
  };
  const Json judged = hold({csv});
  EXPECT_EQ(judged["verdict"], "pass") << judged;
  const Json untold = hold({csv, "--map", "F_cmd_N=unused"});
  EXPECT_EQ(untold["verdict"], "not_run") << untold;
  EXPECT_THAT(untold["evidence"].get<std::string>(), HasSubstr("no set-point (F_cmd_N)"));
}

TEST_F(GateRecording, IsTheSameAsCsvHdf5AndMat) {
  const std::string csv = sine("run.csv", "F_ref_N", 1.0), h5 = folder / "run.h5", mat = folder / "run.mat";
  for (const std::string& to : {h5, mat}) ASSERT_EQ(forcegate({"convert", csv, to}, kHere).exit_code, 0);
  const Json from_csv = checks({csv});
  ASSERT_FALSE(from_csv.empty());
  EXPECT_EQ(checks({h5}), from_csv);
  EXPECT_EQ(checks({mat}), from_csv);
}

TEST_F(GateRecording, InAnotherUnitThanItsHeaderSaysIsRefusedWithTheProbableOne) {
  std::string text = "t_s,F_ref_N,U_V\n", force = text;
  for (int i = 0; i < 20000; ++i) {
    const double load_N = 2.5 - 1.5 * std::cos(0.5 * 2.0 * 3.14159265 * 0.001 * i);
    const std::string t_s = std::to_string(0.001 * i) + ",";
    text += t_s + std::to_string(load_N) + "," + std::to_string(load_N / 0.5 * 1000.0) + "\n";
    force += t_s + std::to_string(load_N / 9.80665e-3) + "," + std::to_string(load_N / 0.5) + "\n";
  }
  write_text(folder / "mv.csv", text);
  const ProcessResult mv = forcegate({"gate", kNative, "--record", folder / "mv.csv", "-o", folder / "run"}, kHere);
  EXPECT_EQ(mv.exit_code, 2) << mv.err;
  EXPECT_THAT(mv.err, HasSubstr("U reaches 8000 V, the converter's range is 10 V"));
  EXPECT_THAT(mv.err, HasSubstr("probably in mV"));
  write_text(folder / "gf.csv", force);
  const ProcessResult gf = forcegate({"gate", kNative, "--record", folder / "gf.csv", "-o", folder / "run"}, kHere);
  EXPECT_EQ(gf.exit_code, 2) << gf.err;
  EXPECT_THAT(gf.err, HasSubstr("reaches 407.9 N"));
  EXPECT_THAT(gf.err, HasSubstr("4 N if it is in gf"));
}

TEST_F(GateRecording, SaysThatTheUncertaintyOfTheAtiIsNotDeclaredAndHowToDeclareIt) {
  const std::string file = sine("run.csv", "F_ref_N", 1.0), plan = folder / "mine.toml";
  const auto said = [&](const std::vector<std::string>& more) {
    std::vector<std::string> line{"gate", kNative, "-o", folder / "run", "--record", file};
    line.insert(line.end(), more.begin(), more.end());
    const ProcessResult r = forcegate(line, kHere);
    const Json notes = Json::parse(read_text(folder / "run/result.json"))["notes"];
    EXPECT_EQ(r.out.find("uncertainty of the ATI's calibration counts as 0") != std::string::npos, notes.dump().find("calibration counts as 0") != std::string::npos);
    return notes.dump();
  };
  EXPECT_THAT(said({}), HasSubstr("declare it: reference_rel in [uncertainty] of a plan (--plan)"));
  write_text(plan, read_text(FORCEGATE_SOURCE_DIR "/ci/plans/replay.toml") + "\n[uncertainty]\nreference_rel = 0.005\n");
  EXPECT_THAT(said({"--plan", plan}), Not(HasSubstr("counts as 0")));
}

TEST_F(GateRecording, ASpikeBeyondTheConvertersRangeIsCutOffAndSaid) {
  const std::string csv = sine("spike.csv", "F_ref_N", 1.0);
  std::string text = read_text(csv);
  const std::size_t at = text.find("\n5.000000,") + 1;
  text.replace(at, text.find('\n', at) - at, "5.000000,2.5,5000");
  write_text(csv, text);
  ASSERT_FALSE(checks({csv}).empty());
  EXPECT_THAT(read_text(folder / "run/result.json"), HasSubstr("U reaches 5000 V, the converter's range is 10 V: 1 rows were cut off"));
}

TEST_F(GateRecording, SaysWhatItLeftOutOfTheFile) {
  const std::string csv = sine("cut.csv", "F_ref_N", 1.0);
  write_text(csv, read_text(csv) + "20.000,1.2");
  ASSERT_FALSE(checks({csv}).empty());
  EXPECT_THAT(read_text(folder / "run/result.json"), HasSubstr("the last line is cut short"));
}

TEST_F(GateRecording, MapsAForeignColumnAsItsAdviceSays) {
  const std::string csv = sine("run.csv", "kgf", 9.80665);
  const ProcessResult none = forcegate({"gate", kNative, "--record", csv, "-o", folder / "run"}, kHere);
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_THAT(none.err, HasSubstr("--map kgf=F_ref_kgf"));
  EXPECT_FALSE(checks({csv, "--map", "kgf=F_ref_kgf"}).empty());
  EXPECT_EQ(forcegate({"check", folder / "run"}, kHere).exit_code, forcegate({"gate", kNative, "--record", csv, "--map", "kgf=F_ref_kgf", "-o", folder / "run"}, kHere).exit_code);
  const ProcessResult emulated = forcegate({"gate", kNative, "--map", "kgf=F_ref_kgf", "-o", folder / "run"}, kHere);
  EXPECT_EQ(emulated.exit_code, 2);
  EXPECT_THAT(emulated.err, HasSubstr("--record"));
}

TEST_F(GateRecording, IsCodedByTheConverterThatItsCalibrationStates) {
  const std::string csv = sine("run.csv", "F_ref_N", 1.0), cal = folder / "cal.toml";
  const auto judged = [&](const std::string& converter, std::vector<std::string> options) {
    write_text(cal, "gain_N_per_V = 0.5\noffset_N = 0\n" + converter);
    options.insert(options.begin(), {csv, "--cal", cal});
    const Json judged_checks = checks(options);
    EXPECT_FALSE(judged_checks.empty());
    for (const Json& check : judged_checks)
      if (check["id"] == "rig_calibration_fits" || check["id"] == "conformance") {
        EXPECT_EQ(check["verdict"], "pass") << converter << check;
      }
    return Json::parse(read_text(folder / "run/result.json"), nullptr, false);
  };
  const Json bits = judged("adc_bits = 12\n", {});
  EXPECT_EQ(bits["rig"]["adc_bits"], 12);
  EXPECT_EQ(bits["firmware"]["adc_bits"], 12);
  EXPECT_EQ(judged("v_range_V = 20\n", {})["rig"]["v_range_V"], 20);
  const Json told = judged("adc_bits = 12\n", {"--rig-option", "adc_bits=14"});
  EXPECT_EQ(told["rig"]["adc_bits"], 14);
  EXPECT_EQ(told["firmware"]["adc_bits"], 14);
  EXPECT_THAT(told["notes"].dump(), HasSubstr("adc_bits = 14 as --rig-option says; the calibration states 12"));
}

TEST_F(GateRecording, ACalibrationThatNoImageTakesIsChargedToNone) {
  const std::string csv = sine("run.csv", "F_ref_N", 1.0), cal = folder / "cal.toml";
  for (const char* text : {"gain_N_per_V = 500\noffset_N = 0\n", "gain_N_per_V = 0.5\noffset_N = 80\n", "gain_N_per_V = 0.5\noffset_N = 0\nv_range_V = 500\n"}) {
    write_text(cal, text);
    const ProcessResult r = forcegate({"gate", kNative, "--record", csv, "--cal", cal, "-o", folder / "run"}, kHere);
    EXPECT_EQ(r.exit_code, 2) << text << r.out;
    EXPECT_THAT(r.err, HasSubstr("where: " + cal + ":")) << text;
  }
}

TEST_F(GateRecording, IsOneRecordOfOneSpecimenAndOfTheProfileThatItsCaseHas) {
  const std::string csv = sine("run.csv", "F_ref_N", 1.0);
  const auto gate = [&](std::vector<std::string> with) {
    with.insert(with.begin(), {"gate", kNative, "--record", csv, "-o", folder / "run"});
    return forcegate(with, kHere);
  };
  const ProcessResult all = gate({"--plan", "smoke"});
  EXPECT_EQ(all.exit_code, 2) << all.out;
  EXPECT_THAT(all.err, HasSubstr("a recording is one case, and this plan has 3"));
  const ProcessResult other = gate({"--plan", "smoke", "--case", "hold_after_cycling"});
  EXPECT_EQ(other.exit_code, 2) << other.out;
  EXPECT_THAT(other.err, HasSubstr("this is no recording of the case 'hold_after_cycling'"));
  gate({"--plan", "smoke", "--case", "sine_f0.50_A1.50_m2.70"});
  EXPECT_EQ(Json::parse(read_text(folder / "run/result.json"), nullptr, false)["cases"].size(), 1U);
  EXPECT_THAT(gate({"--specimen", "q25", "--specimen", "q50"}).err, HasSubstr("a recording is of one specimen, not of 2"));
  EXPECT_THAT(gate({"--calibration", "identified"}).err, HasSubstr("a recording cannot be calibrated"));
}

TEST_F(GateRecording, OfTheSameRowsTwoBuildsDifferByNothing) {
  const std::string csv = sine("run.csv", "F_ref_N", 1.0);
  for (const Json& check : checks({csv, "--accepted", kNative}))
    if (check["id"].get<std::string>().starts_with("no_worse")) {
      EXPECT_EQ(check["u"], 0.0) << check;
      EXPECT_EQ(check["verdict"], "pass") << check;
    }
}

TEST_F(GateRecording, WithAGapIsToBeRecordedAnewAndNotToBePlayedAgain) {
  const std::string csv = sine("run.csv", "F_ref_N", 1.0);
  std::string text = read_text(csv);
  const std::size_t from = text.find("\n8.000000,") + 1;
  text.erase(from, text.find("\n10.000000,") + 1 - from);
  write_text(csv, text);
  const ProcessResult r = forcegate({"gate", kNative, "--record", csv, "-o", folder / "run"}, kHere);
  EXPECT_EQ(r.exit_code, 3) << r.out;
  EXPECT_THAT(r.out, HasSubstr("to act: the recording"));
  EXPECT_THAT(r.out, Not(HasSubstr("0 gaps in time")));
}

TEST_F(GateRecording, BeyondTheConvertersRangeIsMendedAsItsHelpSays) {
  std::string text = "t_s,F_ref_N,U_V\n";
  for (int i = 0; i < 20000; ++i) {
    const double load_N = 2.5 - 1.5 * std::cos(0.5 * 2.0 * 3.14159265 * 0.001 * i);
    text += std::to_string(0.001 * i) + "," + std::to_string(load_N) + "," + std::to_string(load_N / 0.25) + "\n";
  }
  write_text(folder / "wide.csv", text);
  write_text(folder / "cal.toml", "gain_N_per_V = 0.25\noffset_N = 0\n");
  const std::vector<std::string> words{"gate", kNative, "--record", folder / "wide.csv", "--cal", folder / "cal.toml", "-o", folder / "run"};
  const ProcessResult narrow = forcegate(words, kHere);
  EXPECT_EQ(narrow.exit_code, 2);
  EXPECT_THAT(narrow.err, HasSubstr("U reaches 16 V, the converter's range is 10 V"));
  EXPECT_THAT(narrow.err, HasSubstr("v_range_V in --cal FILE"));
  EXPECT_THAT(narrow.err, Not(HasSubstr("in mV")));
  write_text(folder / "cal.toml", "gain_N_per_V = 0.25\noffset_N = 0\nv_range_V = 20\n");
  const ProcessResult wide = forcegate(words, kHere);
  EXPECT_NE(wide.exit_code, 2) << wide.err;
}

TEST_F(GateRecording, LimitsReadCountsWithTheBitsOfTheCalibration) {
  write_text(folder / "cal.toml", "gain_N_per_V = 0.5\noffset_N = 0\nadc_bits = 12\n");
  std::vector<std::string> words{"limits", kNative, "--cal", folder / "cal.toml"};
  for (int k = 0; k < 5; ++k) {
    std::string text = "t_s,F_ref_N,U_counts\n";
    for (int i = 0; i < 40000; ++i) {
      const double load_N = 2.5 + 0.001 * k - 1.5 * std::cos(0.5 * 2.0 * 3.14159265 * 0.001 * i);
      text += std::to_string(0.001 * i) + "," + std::to_string(load_N) + "," + std::to_string(std::lround(load_N / 0.5 / 10.0 * 4095.0)) + "\n";
    }
    words.insert(words.end(), {"--record", folder / (std::to_string(k) + ".csv")});
    write_text(words.back(), text);
  }
  const ProcessResult r = forcegate(words, kHere);
  EXPECT_EQ(r.exit_code, 0) << r.err;
  const ProcessResult none = forcegate({"limits", kNative, "--cal", folder / "cal.toml"}, kHere);
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_THAT(none.err, HasSubstr("it is for --record FILE"));
}

TEST_F(GateRecording, LimitsAreOfThePlanThatIsGiven) {
  std::vector<std::string> words{"limits", kNative, "--cal", folder / "cal.toml"};
  write_text(folder / "cal.toml", "gain_N_per_V = 0.5\noffset_N = 0\n");
  for (int k = 0; k < 5; ++k) {
    std::string text = "t_s,F_ref_N,U_V\n";
    for (int i = 0; i < 40000; ++i) {
      const double load_N = 2.5 + 0.001 * k - 1.5 * std::cos(0.5 * 2.0 * 3.14159265 * 0.001 * i);
      text += std::to_string(0.001 * i) + "," + std::to_string(load_N) + "," + std::to_string(load_N / 0.5) + "\n";
    }
    words.insert(words.end(), {"--record", folder / (std::to_string(k) + ".csv")});
    write_text(words.back(), text);
  }
  const auto limits = [&](const std::vector<std::string>& more, const ProcessOptions& options = kHere) {
    std::vector<std::string> line = words;
    line.insert(line.end(), more.begin(), more.end());
    return forcegate(line, options);
  };
  const ProcessResult no_plan = limits({"--plan", "nosuchplan"});
  EXPECT_EQ(no_plan.exit_code, 2) << no_plan.out;
  EXPECT_THAT(no_plan.err, HasSubstr("nosuchplan"));
  std::string mine = read_text(FORCEGATE_SOURCE_DIR "/ci/plans/replay.toml");
  mine.replace(mine.find("name = \"replay\""), 15, "name = \"mine\"");
  write_text(folder / "mine.toml", mine);
  const ProcessResult r = limits({"--plan", folder / "mine.toml", "-o", folder / "limits.toml"}, {.folder = folder.path()});
  EXPECT_EQ(r.exit_code, 0) << r.err;
  EXPECT_THAT(read_text(folder / "limits.toml"), HasSubstr("plan = \"mine\""));
  EXPECT_THAT(r.out, HasSubstr(" --record NEW.csv"));
  EXPECT_THAT(r.out, HasSubstr(" --plan " + (folder / "mine.toml") + " --limits "));
  const ProcessResult several = limits({"--plan", "smoke"});
  EXPECT_EQ(several.exit_code, 2);
  EXPECT_THAT(several.err, HasSubstr("--case"));
  const ProcessResult replay = limits({"-o", folder / "replay.toml"});
  EXPECT_EQ(replay.exit_code, 0) << replay.err;
  EXPECT_THAT(read_text(folder / "replay.toml"), HasSubstr("plan = \"replay\""));
  EXPECT_THAT(replay.out, Not(HasSubstr(" --plan ")));
}

TEST_F(GateRecording, ARigWithAnotherConverterThanTheCalibrationIsToldBeforeAnythingIsPlayed) {
  const std::string bits = folder / "bits.toml", range = folder / "range.toml";
  write_text(bits, "gain_N_per_V = 0.5\noffset_N = 0\nadc_bits = 12\n");
  write_text(range, "gain_N_per_V = 0.5\noffset_N = 0\nv_range_V = 5\n");
  for (const std::vector<std::string>& words : {std::vector<std::string>{"gate", kNative, "-o", folder / "run"}, {"bench", "selfcheck", kNative}})
    for (const std::string& cal : {bits, range}) {
      std::vector<std::string> line = words;
      line.insert(line.end(), {"--cal", cal});
      const ProcessResult r = forcegate(line, kHere);
      EXPECT_EQ(r.exit_code, 2) << r.out;
      EXPECT_THAT(r.err, HasSubstr(cal == bits ? "adc_bits = 12, that of the rig emulated has adc_bits = 16" : "v_range_V = 5, that of the rig emulated has v_range_V = 10"));
      EXPECT_THAT(r.err, HasSubstr("where: " + cal));
      EXPECT_THAT(r.err, HasSubstr("give the calibration of this rig"));
    }
  const ProcessResult bench = forcegate({"gate", FORCEGATE_BINARY_DIR "/firmware/reference.uart.elf", "--rig", "rigs/twin.toml", "--plan", "twin", "--cal", bits, "-o", folder / "run"}, kHere);
  EXPECT_EQ(bench.exit_code, 2) << bench.out;
  EXPECT_THAT(bench.err, HasSubstr("mend adc_bits of [board] in the bench file, or of the calibration"));
  const ProcessResult narrow = forcegate({"gate", kNative, "--case", "four_sines", "--cal", bits, "--rig-option", "adc_bits=12", "-o", folder / "run"}, kHere);
  EXPECT_NE(narrow.exit_code, 2) << narrow.err;
}

}  // namespace
}  // namespace forcegate::test
