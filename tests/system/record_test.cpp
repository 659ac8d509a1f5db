// `forcegate record` that did not come to its end: what is kept, what is told, and how it goes on.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>

#include "tests/support/process.h"

namespace forcegate::test {
namespace {

using ::testing::HasSubstr;
namespace fs = std::filesystem;

constexpr const char* kPlan = R"(format = 1
name = "two"
doc = "a short and a long record"
seed = 1
[rule]
name = "guarded"
alpha = 0.01
[panel]
specimens = ["nominal"]
[calibration]
level = "nominal"
[safety]
force_max_N = 5.2
[limits]
learning_s = 20
lag_s = 0.05
output_max_N = 10
[[case]]
name = "short"
source = "ours"
loop = "open"
checks = ["conformance"]
stimulus = { name = "sine", f_Hz = 0.5, A_N = 1.05, m_N = 2.15, duration_s = 20, ramp_s = 2 }
[[case]]
name = "long"
source = "ours"
loop = "open"
checks = ["conformance"]
stimulus = { name = "sine", f_Hz = 0.5, A_N = 1.05, m_N = 2.15, duration_s = DURATION, ramp_s = 2 }
)";

class Record : public ::testing::Test {
 protected:
  TemporaryFolder folder;
  std::string plan(const std::string& duration_s) {
    std::string text = kPlan;
    text.replace(text.find("DURATION"), 8, duration_s);
    write_text(folder / "two.toml", text);
    return folder / "two.toml";
  }
  // The limit on the size of a file stands for the full disk.
  ProcessResult with_room(const char* kilobytes, std::vector<std::string> words) {
    words.insert(words.begin(), {"bash", "-c", "trap '' XFSZ; ulimit -f \"$0\"; exec \"$@\"", kilobytes, FORCEGATE_BINARY_DIR "/forcegate", "record"});
    return run_process(words);
  }
};

TEST_F(Record, LeavesNoEmptyFolderWhenItsFirstRecordCannotBeWritten) {
  const std::string out = folder / "mine";
  const ProcessResult full = with_room("8", {"--plan", plan("40"), "-o", out});
  EXPECT_EQ(full.exit_code, 2) << full.out;
  EXPECT_THAT(full.err, HasSubstr("r01_short.csv"));
  EXPECT_FALSE(fs::exists(out));
  const ProcessResult unknown = forcegate({"record", "--plan", plan("40"), "--specimen", "nobody", "-o", out});
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_FALSE(fs::exists(out));
}

TEST_F(Record, GoesOnAfterALaterRecordFailedAndMakesTheSameCampaign) {
  const std::string file = plan("400"), whole = folder / "whole", out = folder / "mine";
  ASSERT_EQ(forcegate({"record", "--plan", file, "-o", whole}).exit_code, 0);
  const ProcessResult full = with_room("400", {"--plan", file, "-o", out});
  EXPECT_EQ(full.exit_code, 2) << full.out;
  EXPECT_THAT(full.err, HasSubstr("1 of 2 records are kept in " + out));
  EXPECT_THAT(full.err, HasSubstr("--continue"));
  const ProcessResult again = forcegate({"record", "--plan", file, "-o", out});
  EXPECT_EQ(again.exit_code, 2);
  EXPECT_THAT(again.err, HasSubstr("with 1 of the 2 records"));
  EXPECT_THAT(again.err, HasSubstr("--continue"));
  const ProcessResult other = forcegate({"record", "--plan", file, "--seed", "5", "--continue", "-o", out});
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_THAT(other.err, HasSubstr("another campaign already: seed 1 there, 5 asked\n"));
  write_text(out + "/r02_long.csv.part2147483647", "half");  // of a killed run: no process has that number
  write_text(out + "/r02_long.csv.part" + std::to_string(::getpid()), "half");  // the number lives, as that of a killed process does until its parent asks
  write_text(out + "/mine.part2147483647", "of somebody else");
  const ProcessResult rest = forcegate({"record", "--plan", file, "--continue", "-o", out});
  EXPECT_FALSE(fs::exists(out + "/r02_long.csv.part2147483647"));
  EXPECT_FALSE(fs::exists(out + "/r02_long.csv.part" + std::to_string(::getpid())));
  EXPECT_TRUE(fs::exists(out + "/mine.part2147483647"));
  EXPECT_EQ(rest.exit_code, 0) << rest.err;
  EXPECT_THAT(rest.out, HasSubstr("beside 1 that were there"));
  std::string continued = read_text(out + "/campaign.json");
  continued.replace(continued.find("\"mine\""), 6, "\"whole\"");
  EXPECT_EQ(continued, read_text(whole + "/campaign.json"));
  EXPECT_EQ(read_text(out + "/r02_long.csv"), read_text(whole + "/r02_long.csv"));
  EXPECT_EQ(forcegate({"record", "--plan", file, "--continue", "-o", out}).exit_code, 2) << "nothing is missing";
}

TEST_F(Record, RecordsTheFilesAgainThatACampaignHasLost) {
  const std::string file = plan("40"), out = folder / "mine", first = out + "/r01_short.csv";
  const std::vector<std::string> line{"record", "--plan", file, "-o", out}, go_on{"record", "--plan", file, "--continue", "-o", out};
  ASSERT_EQ(forcegate(line).exit_code, 0);
  const std::string made = read_text(first), list = read_text(out + "/campaign.json");
  write_text(first, made.substr(0, made.size() / 2));
  const ProcessResult cut = forcegate(go_on);
  EXPECT_EQ(cut.exit_code, 2);
  EXPECT_THAT(cut.err, HasSubstr("the file of a record is cut off"));
  EXPECT_THAT(cut.err, HasSubstr("help: rm " + first + ", and --continue records it again"));
  fs::remove(first);
  EXPECT_THAT(forcegate(line).err, HasSubstr("with 1 of the 2 records"));
  const ProcessResult again = forcegate(go_on);
  EXPECT_EQ(again.exit_code, 0) << again.err;
  EXPECT_THAT(again.out, HasSubstr("beside 1 that were there"));
  EXPECT_EQ(read_text(first), made);
  EXPECT_EQ(read_text(out + "/campaign.json"), list);
}

TEST_F(Record, KeepsWhatInstrumentsSaidOfAFileThatABenchHasLost) {
  const std::string file = plan("40"), out = folder / "mine", bench = FORCEGATE_SOURCE_DIR "/rigs/twin.toml";
  const ProcessResult made = forcegate({"record", "--plan", file, "--case", "short", "--rig", bench, "-o", out});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_THAT(read_text(out + "/campaign.json"), HasSubstr("\"rig_id\": \"twin-tcp\""));
  const std::vector<std::string> go_on{"record", "--plan", file, "--case", "short", "--rig", bench, "--continue", "-o", out};
  fs::remove(out + "/r01_short.csv");
  const ProcessResult kept = forcegate(go_on);
  EXPECT_EQ(kept.exit_code, 2);
  EXPECT_THAT(kept.err, HasSubstr("the file r01_short.csv of a listed record is gone"));
  EXPECT_THAT(kept.err, HasSubstr("where: " + out + "/r01_short.h5"));
  fs::rename(out + "/r01_short.h5", folder / "elsewhere.h5");
  const ProcessResult again = forcegate(go_on);
  EXPECT_EQ(again.exit_code, 0) << again.err;
  EXPECT_TRUE(fs::exists(out + "/r01_short.csv"));
  const ProcessResult other = forcegate({"record", "--plan", file, "--case", "short", "--rig", FORCEGATE_SOURCE_DIR "/rigs/twin_rtu.toml", "--continue", "-o", out});
  EXPECT_THAT(other.err, HasSubstr("bench twin-tcp there, "));
}

TEST_F(Record, DoesNotBeginACampaignThatItWasToGoOnWith) {
  const ProcessResult r = forcegate({"record", "--plan", plan("40"), "--continue", "-o", folder / "mistyped"});
  EXPECT_EQ(r.exit_code, 2) << r.out;
  EXPECT_THAT(r.err, HasSubstr("there is no campaign to go on with"));
  EXPECT_THAT(r.err, HasSubstr("without --continue a campaign begins there"));
  EXPECT_FALSE(fs::exists(folder / "mistyped"));
}

TEST_F(Record, SaysAllThatDiffersFromTheCampaignThatIsThere) {
  const std::string file = plan("40"), out = folder / "mine";
  ASSERT_EQ(forcegate({"record", "--plan", file, "-o", out}).exit_code, 0);
  const auto asked = [&](std::vector<std::string> words) {
    words.insert(words.begin(), {"record", "--plan", file, "--continue", "-o", out});
    const ProcessResult r = forcegate(words);
    EXPECT_EQ(r.exit_code, 2) << r.out;
    return r.err;
  };
  EXPECT_THAT(asked({"--seed", "2", "--specimen", "q25", "--rate", "100"}),
              HasSubstr("already: specimen q50 there, q25 asked; seed 1 there, 2 asked; rate 200 Hz there, 100 Hz asked\n  where: " + out + "\n  help: choose another folder with -o"));
  EXPECT_THAT(asked({"--case", "long"}), HasSubstr("already: records 2 there, 1 asked; record 1 r01_short.csv there, r01_long.csv asked\n"));
  EXPECT_THAT(asked({"--rig", FORCEGATE_SOURCE_DIR "/rigs/twin.toml"}), HasSubstr("already: rig emulated there, bench asked\n"));
  write_text(out + "/campaign.json", "{\"records\": []}");
  EXPECT_THAT(asked({}), HasSubstr("already: forcegate record did not make it\n"));
}

TEST_F(Record, DoesNotGoOnWithAnotherRigOption) {
  const std::string file = plan("40"), out = folder / "mine";
  ASSERT_EQ(forcegate({"record", "--plan", file, "-o", out}).exit_code, 0);
  const auto asked = [&](const std::string& option) {
    const ProcessResult r = forcegate({"record", "--plan", file, "--continue", "--rig-option", option, "-o", out});
    EXPECT_EQ(r.exit_code, 2) << r.out;
    return r.err;
  };
  for (const auto& [option, told] : {std::pair{"sensor=fsr", "sensor flexiforce there, fsr asked"}, {"hidden=creep:strong", "hidden another there"},
                                     {"adc_bits=10", "adc_bits 16 there, 10 asked"}, {"noise=0", "noise on there, off asked"}})
    EXPECT_THAT(asked(option), HasSubstr(std::string("already: rig option ") + told + "\n"));
  EXPECT_THAT(asked("rate_Hz=500"), HasSubstr("rig option rate_Hz 1000 there, 500 asked"));
  EXPECT_THAT(asked("hidden=none"), HasSubstr("there is a campaign already, with 2 of the 2 records"));
  EXPECT_THAT(asked("adc_bits=16"), HasSubstr("there is a campaign already, with 2 of the 2 records")) << "it has 16 anyway";
}

TEST_F(Record, IsRefusedInAFolderThatAnotherRunFills) {
  const std::string out = folder / "mine";
  fs::create_directories(out);
  for (const std::vector<std::string>& words : {std::vector<std::string>{"record", "--plan", plan("40")}, {"characterize", "--specimen", "q50", "--sessions", "1"}}) {
    // the lock is held by the shell, whose child would be the second to write
    std::vector<std::string> line{"bash", "-c", "exec 9<\"$0\"; flock 9; exec \"$@\"", out, FORCEGATE_BINARY_DIR "/forcegate"};
    line.insert(line.end(), words.begin(), words.end());
    line.insert(line.end(), {"-o", out});
    const ProcessResult r = run_process(line, {.timeout = std::chrono::seconds(60)});
    EXPECT_EQ(r.exit_code, 2) << r.out << r.err;
    EXPECT_THAT(r.err, HasSubstr("another run is writing there now"));
    EXPECT_TRUE(fs::is_empty(out));
  }
}

TEST_F(Record, TellsTheTrueRateOfItsRows) {
  const std::vector<std::string> line{"record", "--plan", plan("40"), "--rate", "600", "-o", folder / "mine"};
  const ProcessResult r = forcegate(line);
  ASSERT_EQ(r.exit_code, 0) << r.err;
  EXPECT_THAT(r.out, HasSubstr("note: 500 rows a second instead of 600: "));
  EXPECT_THAT(r.out, HasSubstr("--rate 1000, 500, 333.333, 250"));
  const std::string campaign = read_text(folder / "mine/campaign.json");
  EXPECT_THAT(campaign, HasSubstr("\"fs_Hz\": 500.0"));
  EXPECT_THAT(campaign, HasSubstr("\"rate_Hz\": 500.0"));
  std::vector<std::string> again = line;
  again.push_back("--continue");
  EXPECT_THAT(forcegate(again).err, HasSubstr("there is a campaign already, with 2 of the 2 records")) << "the same campaign";
}

TEST_F(Record, SaysWhatIsKeptAfterCtrlC) {
  const ProcessResult r = forcegate({"record", "--plan", plan("86000"), "--rate", "1", "-o", folder / "mine"}, {.signal_after = std::chrono::milliseconds(1000), .signal = SIGINT});
  EXPECT_EQ(r.exit_code, 130) << r.out << r.err;
  EXPECT_THAT(r.err, HasSubstr("1 of 2 records are kept in"));
  EXPECT_THAT(r.err, HasSubstr("--continue"));
}

TEST_F(Record, NeverWritesOverTheJournalOfAnEarlierAttempt) {
  fs::create_directories(folder / "mine");
  write_text(folder / "mine/r01_short.fgj", "what an instrument said");
  const ProcessResult r = forcegate({"record", "--plan", plan("40"), "-o", folder / "mine"});
  EXPECT_EQ(r.exit_code, 2);
  EXPECT_THAT(r.err, HasSubstr("forcegate recover"));
  EXPECT_EQ(read_text(folder / "mine/r01_short.fgj"), "what an instrument said");
}

TEST_F(Record, HidesNoRecordingsThatTheFolderHolds) {
  fs::create_directories(folder / "mine");
  write_text(folder / "mine/Rampe.csv", "t_s,F_ref_N,U_V\n0,1,2\n");
  const ProcessResult r = forcegate({"record", "--plan", plan("40"), "-o", folder / "mine"});
  EXPECT_EQ(r.exit_code, 2);
  EXPECT_THAT(r.err, HasSubstr("hides them: Rampe.csv"));
  EXPECT_THAT(r.err, HasSubstr("choose another folder with -o"));
  EXPECT_FALSE(fs::exists(folder / "mine/campaign.json"));
}

}  // namespace
}  // namespace forcegate::test
