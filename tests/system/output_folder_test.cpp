// Where a verb writes: a folder that one stands in, symbolic links, and goldens beside a plan of one's own.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/process.h"

namespace forcegate::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
namespace fs = std::filesystem;

constexpr const char* kPlan = R"(format = 1
name = "gold"
seed = 7
[panel]
specimens = ["q50"]
[calibration]
level = "static"
[safety]
force_max_N = 5.2
[limits]
goldens = "mygold"
[[case]]
name = "s"
checks = ["conformance", "golden"]
stimulus = { name = "sine", f_Hz = 0.5, A_N = 1.5, m_N = 2.7, duration_s = 120, ramp_s = 2 }
)";

class OutputFolder : public ::testing::Test {
 protected:
  OutputFolder() {
    write_text(folder / "gold.toml", kPlan);
    fs::create_symlink(FORCEGATE_BINARY_DIR "/firmware/reference.native.so", folder / "image.so");
    fs::create_directory(folder / "empty");
  }
  ProcessResult in(const std::string& name, const std::vector<std::string>& line) { return forcegate(line, {.folder = folder / name}); }
  TemporaryFolder folder;
};

TEST_F(OutputFolder, TheFolderOneStandsInIsRefusedBeforeTheRunAndStays) {
  for (const char* output : {".", "..", "../empty"}) {
    const ProcessResult r = in("empty", {"gate", "../image.so", "--plan", "../gold.toml", "-o", output});
    EXPECT_EQ(r.exit_code, 2) << output << r.out;
    EXPECT_THAT(r.err, AllOf(HasSubstr("the folder that the command is given in"), HasSubstr("\n  where: "), HasSubstr("\n  help: "), Not(HasSubstr("%"))));
    EXPECT_TRUE(fs::is_directory(folder / "empty")) << output;
  }
}

TEST_F(OutputFolder, ThatHoldsWhatTheRunReadsIsRefusedAndStays) {
  in("", {"gate", "image.so", "--plan", "gold.toml", "-o", "run"});
  const std::string before = read_text(folder / "run/bundle.json");
  for (const std::vector<std::string>& line : {std::vector<std::string>{"gate", "run/bundle/firmware", "--plan", "gold.toml", "-o", "run"}, {"gate", "image.so", "--plan", "run/bundle/plan.toml", "-o", "run"}}) {
    const ProcessResult r = in("", line);
    EXPECT_EQ(r.exit_code, 2) << r.out;
    EXPECT_THAT(r.err, AllOf(HasSubstr("a file of the folder that it replaces"), HasSubstr("run/bundle/"), Not(HasSubstr("%"))));
    EXPECT_EQ(read_text(folder / "run/bundle.json"), before);
  }
}

TEST_F(OutputFolder, ALinkStaysAndItsTargetIsWritten) {
  fs::create_symlink("empty", folder / "link");
  for (int time = 0; time < 2; ++time) {  // the second one replaces an older run
    EXPECT_NE(in("", {"gate", "image.so", "--plan", "gold.toml", "-o", "link"}).exit_code, 2);
    EXPECT_TRUE(fs::is_symlink(folder / "link"));
    EXPECT_TRUE(fs::exists(folder / "empty/result.json"));
  }
  for (const auto& entry : fs::directory_iterator(folder.path())) EXPECT_THAT(entry.path().filename().string(), Not(HasSubstr("-"))) << "nothing is left aside";
}

TEST_F(OutputFolder, ALinkThatLeadsNowhereIsRefusedBeforeTheRunByEveryVerb) {
  fs::create_symlink("nowhere", folder / "link");
  for (const std::vector<std::string>& line : std::vector<std::vector<std::string>>{{"gate", "image.so", "--plan", "gold.toml", "-o", "link"},
                                                                                    {"gate", "image.so", "--plan", "gold.toml", "-o", "link/"},
                                                                                    {"record", "--plan", "selfcheck", "-o", "link"},
                                                                                    {"mystery", "--seed", "4", "link"},
                                                                                    {"stimulus", "sine", "f_Hz=0.5", "A_N=1", "m_N=2", "--plot", "link"}}) {
    const ProcessResult r = in("", line);
    EXPECT_EQ(r.exit_code, 2) << line.front() << r.out << r.err;
    EXPECT_THAT(r.err, AllOf(HasSubstr("leads nowhere: nowhere"), HasSubstr("\n  help: "))) << line.front();
    EXPECT_FALSE(fs::exists(folder / "nowhere")) << line.front();
  }
}

TEST_F(OutputFolder, AFileIsWrittenThroughItsLink) {
  write_text(folder / "real.svg", "");
  fs::create_symlink("real.svg", folder / "link.svg");
  const ProcessResult r = in("", {"stimulus", "sine", "f_Hz=0.5", "A_N=1", "m_N=2", "--plot", "link.svg"});
  EXPECT_EQ(r.exit_code, 0) << r.err;
  EXPECT_TRUE(fs::is_symlink(folder / "link.svg"));
  EXPECT_THAT(read_text(folder / "real.svg"), HasSubstr("<svg"));
}

TEST_F(OutputFolder, GoldensOfAPlanOfOnesOwnAreBlessedAsTheGateSays) {
  const ProcessResult missing = in("", {"gate", "image.so", "--plan", "gold.toml", "-o", "g1"});
  EXPECT_EQ(missing.exit_code, 3) << missing.out;
  EXPECT_THAT(missing.out, HasSubstr("forcegate bless RUN --reason ... --who ..."));
  EXPECT_EQ(in("", {"bless", "g1", "--reason", "first", "--who", "me"}).exit_code, 0);
  EXPECT_TRUE(fs::exists(folder / "mygold/s@q50.golden"));

  const std::vector<std::string> elsewhere{"bless", "../g1", "--reason", "first", "--who", "me"};
  const ProcessResult lost = in("empty", elsewhere);
  EXPECT_EQ(lost.exit_code, 2);
  EXPECT_THAT(lost.err, AllOf(HasSubstr("gold.toml"), HasSubstr("--plan")));
  std::vector<std::string> told = elsewhere;
  told.insert(told.end(), {"--plan", "../gold.toml"});
  EXPECT_THAT(in("empty", told).out, HasSubstr("unchanged"));
  told.back() = FORCEGATE_SOURCE_DIR "/ci/plans/smoke.toml";
  EXPECT_THAT(in("empty", told).err, HasSubstr("the run is of the plan 'gold', not of 'smoke'"));
}

TEST_F(OutputFolder, ARunWithAFaultIsNeverGoldenAndOptionsOfTheRigAreNamed) {
  in("", {"gate", "image.so", "--plan", "gold.toml", "--fault", "reference_gain=1.001", "-o", "faulty"});
  const ProcessResult refused = in("", {"bless", "faulty", "--reason", "first", "--who", "me"});
  EXPECT_EQ(refused.exit_code, 2) << refused.out;
  EXPECT_THAT(refused.err, HasSubstr("injected faults: reference_gain=1.001"));
  EXPECT_FALSE(fs::exists(folder / "mygold"));
  in("", {"gate", "image.so", "--plan", "gold.toml", "--rig-option", "hidden=creep:weak", "-o", "creeping"});
  EXPECT_EQ(in("", {"bless", "creeping", "--reason", "first", "--who", "me"}).exit_code, 0);
  EXPECT_THAT(read_text(folder / "CHANGES.md"), HasSubstr("(hidden=creep:weak)"));
}

}  // namespace
}  // namespace forcegate::test
