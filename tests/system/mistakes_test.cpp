// Mistakes that a first-time user makes: each is told with where it is and how to mend it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>

#include "tests/support/process.h"

namespace forcegate::test {
namespace {

using ::testing::AnyOf;
using ::testing::HasSubstr;
using Json = nlohmann::json;

constexpr const char* kNative = FORCEGATE_BINARY_DIR "/firmware/reference.native.so";
const ProcessOptions kHere{.folder = FORCEGATE_SOURCE_DIR, .timeout = std::chrono::minutes(2)};

TEST(Mistakes, InNamesAreToldAlsoWhereNothingWouldBeDoneWithThem) {
  TemporaryFolder folder;
  std::string text = "t_s,F_ref_N,U_V\n";
  for (int i = 0; i < 400; ++i) text += std::to_string(0.1 * i) + "," + std::to_string(0.01 * (i % 100)) + "," + std::to_string(0.02 * (i % 100)) + "\n";
  write_text(folder / "run.csv", text);
  const std::string run = folder / "run.csv";
  const std::vector<std::pair<std::vector<std::string>, std::string>> told = {
      {{"next", run, "--run", "--rig", "nosuchrig"}, "there is no rig named 'nosuchrig'"},
      {{"next", run, "--record", "nosuch.csv"}, "there is no such file\n  where: nosuch.csv"},
      {{"next", run, "--rig", "nosuch.toml"}, "there is no such file\n  where: nosuch.toml"},
      {{"league", "--only", "lag,nosuch"}, "there is no effect \"nosuch\""},
      {{"league", "--only", "none", "--controls", "1", "--engine", "false"}, "the engine answered none of 1 campaigns: the engine printed nothing"},
      {{"diagnose", run, "--html", "-"}, "\"-\" names no file: what goes to standard output is the answer\n  where: --html -"},
      {{"diagnose", run, "--map", "U_V=U_foo"}, "help: \"U_foo\" of --map U_V=U_foo is no name that means anything here"},
      {{"diagnose", run, "--map", "U_V=F_ref_N"}, "there are F_ref_N, U_V"},
      {{"gate", kNative, "--lane", "block"}, "help: this image runs with --lane native: leave --lane out"},
      {{"history", "nix.toml"}, "there is no such model file"},
      {{"compare", run, "--model", "nix"}, "there is no such model file"},
      {{"export", "nix"}, "there is no such model file"},
      {{"check", "nix"}, "there is no such folder"},
      {{"report", "nix"}, "there is no such file or folder"},
      {{"diff", "nix", "nix"}, "there is no such file or folder"},
      {{"bench", "serve", "rigs/twin.toml", "--folder", "/proc/nix"}, "cannot publish a port"},
      {{"bench", "faults", FORCEGATE_BINARY_DIR "/firmware/mutants/compensation_off.native.so", "--fault", "clock_jump"}, "without any fault the build is no known-good one"},
  };
  for (const auto& [words, what] : told) {
    const ProcessResult r = forcegate(words, kHere);
    EXPECT_EQ(r.exit_code, 2) << what << r.out;
    EXPECT_THAT(r.err, HasSubstr(what));
    EXPECT_THAT(r.err, HasSubstr("\n  help: ")) << what;
  }
}

// Straight, 40 s: enough for an answer.
std::string write_run(const TemporaryFolder& folder) {
  std::string text = "t_s,F_ref_N,U_V\n";
  for (int i = 0; i < 2000; ++i) text += std::to_string(0.02 * i) + "," + std::to_string(0.01 * (i % 400)) + "," + std::to_string(0.02 * (i % 400) + 0.001 * (i % 7)) + "\n";
  write_text(folder / "run.csv", text);
  return folder / "run.csv";
}

TEST(Mistakes, InPlacesThatCannotBeWrittenAreToldBeforeTheWorkWithTheReason) {
  TemporaryFolder folder;
  const std::string run = write_run(folder), file = folder / "file.toml", model = folder / "better.toml";
  write_text(file, "");
  const std::vector<std::pair<std::vector<std::string>, std::string>> told = {
      {{"diagnose", run, "--pictures", "/proc/nowhere/pictures"}, "cannot make"},
      {{"diagnose", run, "--pictures", file}, "a file has that name"},
      {{"diagnose", run, "--html", folder.path()}, "Is a directory"},
      {{"add", "creep", "--fit", run, "-o", model, "--html", file + "/page.html"}, "a file has that name"},
      {{"simulate", run, "-o", file}, "a file has that name"},
      {{"mystery", "/proc/nowhere/m"}, "cannot make the folder"},
      {{"mystery", file + "/m"}, "a file has that name"},
  };
  for (const auto& [words, what] : told) {
    const ProcessResult r = forcegate(words, kHere);
    EXPECT_EQ(r.exit_code, 2) << what << r.out;
    EXPECT_THAT(r.err, HasSubstr(what)) << words.front();
    EXPECT_THAT(r.err, HasSubstr("\n  help: ")) << words.front();
    EXPECT_EQ(r.out, "") << words.front();
  }
  EXPECT_FALSE(std::filesystem::exists(model)) << "nothing was begun";
}

TEST(Mistakes, InThePageOfAnAnswerDoNotTakeTheAnswer) {
  TemporaryFolder folder;
  const ProcessResult r = forcegate({"diagnose", write_run(folder), "--html", "/dev/full"}, kHere);
  EXPECT_EQ(r.exit_code, 2);
  EXPECT_THAT(r.out, HasSubstr("verdict: "));
  EXPECT_THAT(r.err, HasSubstr("No space left on device"));
}

// The limit on the size of a file stands for the full disk.
TEST(Mistakes, InThePageOfAnAnswerLeaveOneDocumentOnStdout) {
  TemporaryFolder folder;
  const std::string run = write_run(folder), page = folder / "page.html";
  for (const std::string& words : {"diagnose " + run + " --html " + page, "add creep --fit " + run + " --html " + page}) {
    const ProcessResult r = run_process({"bash", "-c", "trap '' XFSZ; ulimit -f 8; exec " FORCEGATE_BINARY_DIR "/forcegate " + words + " --json"}, kHere);
    EXPECT_EQ(r.exit_code, 2) << words;
    const auto document = nlohmann::json::parse(r.out, nullptr, false);
    ASSERT_FALSE(document.is_discarded()) << words << r.out;
    EXPECT_TRUE(document.contains("error")) << words;
  }
}

TEST(Mistakes, InTheNameOfAnEffectSayWhereEquationsAreNamed) {
  TemporaryFolder folder;
  const std::string run = write_run(folder);
  const ProcessResult own = forcegate({"add", "mine", "--fit", run}, kHere);
  EXPECT_EQ(own.exit_code, 2);
  EXPECT_THAT(own.err, HasSubstr("no effect \"mine\""));
  EXPECT_THAT(own.err, HasSubstr("\n  help: an equation of your own stands in a model file: name that with --model FILE"));
  EXPECT_THAT(forcegate({"add", "hysteresi", "--fit", run}, kHere).err, HasSubstr("did you mean \"hysteresis\"?"));
}

TEST(Mistakes, InTheSizeOfADiskLeaveNoHalfMystery) {
  TemporaryFolder folder;
  const ProcessResult r = run_process({"bash", "-c", "ulimit -f 100; " + std::string(FORCEGATE_BINARY_DIR) + "/forcegate mystery --seed 3 " + (folder / "m")}, kHere);
  EXPECT_EQ(r.exit_code, 2) << r.out;
  EXPECT_FALSE(std::filesystem::exists(folder / "m"));
}

TEST(Mistakes, InALimitOnTheSizeOfFilesAreAFailedWriteAndNoSilentEnd) {
  TemporaryFolder folder;
  const std::string gate = std::string(FORCEGATE_BINARY_DIR) + "/forcegate gate " + kNative + " --case four_sines --specimen q50 -o " + (folder / "run");
  const ProcessResult r = run_process({"bash", "-c", "ulimit -f 100; " + gate}, kHere);
  EXPECT_EQ(r.exit_code, 2) << r.out << r.err;
  EXPECT_EQ(r.signal, 0);
  EXPECT_THAT(r.err, HasSubstr("cannot write"));
  EXPECT_FALSE(std::filesystem::exists(folder / "run"));
}

TEST(Mistakes, InWhereAProgramStandsAreToldByDoctorBeforeTheGate) {
  TemporaryFolder folder;
  std::filesystem::copy_file(FORCEGATE_BINARY_DIR "/forcegate", folder / "forcegate");
  std::filesystem::create_directory_symlink(FORCEGATE_BINARY_DIR "/firmware", folder / "firmware");
  const ProcessResult r = run_process({folder / "forcegate", "doctor"}, {.folder = folder.path()});
  EXPECT_EQ(r.exit_code, 3) << r.out;
  EXPECT_THAT(r.out, HasSubstr("there is no plan 'smoke'"));
  EXPECT_THAT(r.out, HasSubstr("not ready"));
  const ProcessResult here = run_process({folder / "forcegate", "doctor"}, kHere);
  EXPECT_THAT(here.out, ::testing::Not(HasSubstr("there is no plan"))) << here.out;
}

TEST(Mistakes, InThePathOfAPlanAreToldAsAFileThatIsNotThere) {
  TemporaryFolder folder;
  const std::string mine = folder / "my_plan.toml", wrong = folder / "my_plam.toml", far = folder / "elsewhere/x.toml", out = folder / "run";
  std::filesystem::copy_file(FORCEGATE_SOURCE_DIR "/ci/plans/smoke.toml", mine);
  for (const std::vector<std::string>& words : {std::vector<std::string>{"plan"}, {"record", "-o", out, "--plan"}, {"gate", kNative, "-o", out, "--plan"}}) {
    const auto asked = [&](const std::string& plan) {
      std::vector<std::string> line = words;
      line.push_back(plan);
      const ProcessResult r = forcegate(line, kHere);
      EXPECT_EQ(r.exit_code, 2) << r.out;
      return r.err;
    };
    EXPECT_THAT(asked(wrong), HasSubstr("error: there is no such plan file\n  where: " + wrong + "\n  help: did you mean '" + mine + "'?"));
    EXPECT_THAT(asked(far), HasSubstr("there is no folder " + (folder / "elsewhere") + " either: mend the path, or give the name of a plan in ci/plans (bench, "));
    EXPECT_THAT(asked("smoke.toml"), HasSubstr("did you mean the plan 'smoke' of ci/plans?"));
    EXPECT_THAT(asked("ci/plans"), HasSubstr("the plan is a folder"));
  }
}

TEST(Mistakes, InTheDeviceOfAWireFaultAreNoFaultThatWasSurvived) {
  TemporaryFolder folder;
  const std::string bench = read_text(std::string(FORCEGATE_SOURCE_DIR) + "/rigs/twin.toml");
  for (const auto& [device, kind] : {std::pair{"reference", "exception"}, {"board", "wrong_slave"}, {"motor", "saturation"}}) {
    write_text(folder / "bench.toml", bench + "\n[[twins.fault]]\ndevice = \"" + device + "\"\nkind = \"" + kind + "\"\nat_s = 30.0\n");
    const ProcessResult r = forcegate({"gate", kNative, "--rig", folder / "bench.toml", "--plan", "twin", "-o", folder / "run"}, kHere);
    EXPECT_EQ(r.exit_code, 2) << kind << r.out << r.err;
    EXPECT_THAT(r.err, HasSubstr(std::string("the device '") + device + "' has no fault '" + kind + "'"));
    EXPECT_THAT(r.err, HasSubstr("bench.toml:"));
  }
}

TEST(Mistakes, InTheTimeOfAWireFaultAreNoFaultThatWasSurvived) {
  TemporaryFolder folder;
  const std::string bench = read_text(std::string(FORCEGATE_SOURCE_DIR) + "/rigs/twin.toml"), file = folder / "bench.toml";
  const auto with = [&](const std::string& when) { write_text(file, bench + "\n[[twins.fault]]\ndevice = \"board\"\nkind = \"drop\"\n" + when); };
  const auto gated = [&] {
    const ProcessResult r = forcegate({"gate", kNative, "--rig", file, "--plan", "twin", "--calibration", "nominal", "-o", folder / "run"}, kHere);
    EXPECT_EQ(r.exit_code, 2) << r.out << r.err;
    return r.err;
  };
  for (const auto& [when, told] : {std::pair{"at_s = -5\n", "at_s"}, {"at_s = 10\nfor_s = 1\ncount = 3\n", "for_s and count are given together"}}) {
    with(when);
    EXPECT_THAT(gated(), HasSubstr(told));
    const ProcessResult listed = forcegate({"bench", "list", file}, kHere);
    EXPECT_EQ(listed.exit_code, 2) << when << listed.out;
    EXPECT_THAT(listed.out, HasSubstr(told));
    const ProcessResult asked = forcegate({"bench", "doctor", file}, kHere);  // the same help as there
    const std::size_t help = asked.err.find("help: ");
    ASSERT_NE(help, std::string::npos) << asked.err;
    EXPECT_THAT(listed.out, HasSubstr(asked.err.substr(help, asked.err.find('\n', help) - help)));
  }
  with("at_s = 99999\n");
  EXPECT_THAT(gated(), ::testing::AllOf(HasSubstr("begins at 99999 s"), HasSubstr("bench.toml:")));
  EXPECT_EQ(forcegate({"bench", "list", file}, kHere).exit_code, 0);
}

TEST(Mistakes, InAPortAreToldWithThePort) {
  const ProcessResult r = forcegate({"bench", "doctor", "rigs/lab_small.toml"}, kHere);
  EXPECT_NE(r.exit_code, 0) << r.out << r.err;
  EXPECT_THAT(r.out + r.err, HasSubstr("cannot open the serial port /dev/"));
}

TEST(Mistakes, OfOneInstrumentDoNotHideTheOthers) {
  const ProcessResult r = forcegate({"bench", "doctor", "rigs/lab_small.toml", "--json"}, kHere);
  EXPECT_EQ(r.exit_code, 4) << r.out << r.err;
  const Json document = Json::parse(r.out);
  std::map<std::string, std::string> found;
  for (const Json& item : document["items"])
    if (item["good"] == false) found[item["name"].get<std::string>()] = item["found"].get<std::string>();
  ASSERT_EQ(found.size(), 3U) << r.out;
  EXPECT_THAT(found["reference"], HasSubstr("UART_ATI"));
  EXPECT_THAT(found["board"], HasSubstr("Arduino_Due"));
  EXPECT_THAT(found["motor"], HasSubstr("UART_DRIVE"));
  TemporaryFolder folder;
  const ProcessResult gate = forcegate({"gate", kNative, "--rig", "rigs/lab_small.toml", "--arm", "-o", folder / "run"}, kHere);
  EXPECT_EQ(gate.exit_code, 4) << gate.out << gate.err;
  EXPECT_THAT(gate.out, HasSubstr("to act: the ATI reference"));
}

TEST(Mistakes, InAFileNameThePageThatListsItsKeys) {
  TemporaryFolder folder;
  write_text(folder / "wrong.toml", "nothing = 3\n");
  const std::string wrong = folder / "wrong.toml", out = folder / "out";
  for (const char* option : {"--limits", "--cal", "--waivers", "--plan"}) {
    const ProcessResult r = forcegate({"gate", kNative, option, wrong, "-o", out}, kHere);
    EXPECT_EQ(r.exit_code, 2) << option;
    const std::size_t at = r.err.find("help: docs/");
    ASSERT_NE(at, std::string::npos) << option << r.err;
    const std::string page = r.err.substr(at + 6, r.err.find(' ', at + 6) - at - 6);
    const std::string key = r.err.substr(r.err.find("key '") + 5, r.err.find('\'', r.err.find("key '") + 5) - r.err.find("key '") - 5);
    EXPECT_THAT(read_text(FORCEGATE_SOURCE_DIR "/" + page), AnyOf(HasSubstr("`" + key + "`"), HasSubstr("\n    " + key + " = "))) << option << r.err;
  }
}

TEST(Mistakes, OfAnImageOrALaneAreToldBeforeAnythingIsPlayed) {
  TemporaryFolder folder;
  const std::string out = folder / "out";
  const ProcessResult program = forcegate({"gate", "/bin/ls", "-o", out}, kHere), option = forcegate({"gate", kNative, "--lane-option", "foo=1", "-o", out}, kHere);
  for (const ProcessResult& r : {program, option}) {
    EXPECT_EQ(r.exit_code, 2) << r.err;
    EXPECT_TRUE(r.err.starts_with("error: ")) << r.err;
  }
  EXPECT_THAT(option.err, HasSubstr("the native lane has no option 'foo'"));
  EXPECT_THAT(forcegate({"plan", "nowhere"}, kHere).err, testing::Not(HasSubstr("--plan")));
}

TEST(Mistakes, InAPlanThatJudgesNothingOrStopsItselfAreToldBeforeAnythingIsPlayed) {
  TemporaryFolder folder;
  const std::string plan = "format = 1\nname = \"mine\"\n[panel]\nspecimens = [\"q50\"]\n[calibration]\nlevel = \"nominal\"\n[[case]]\nname = \"sine\"\n"
                           "stimulus = { name = \"sine\", f_Hz = 0.5, A_N = 1, m_N = 2, duration_s = 60 }\n";
  write_text(folder / "none.toml", plan);
  write_text(folder / "stop.toml", plan + "checks = [\"conformance\"]\n[safety]\nforce_max_N = 2.5\n");
  write_text(folder / "lane.toml", plan + "checks = [\"conformance\"]\nlane = \"ukrt\"\n");
  const auto gate = [&](const std::string& name) { return forcegate({"gate", kNative, "--plan", folder / name, "-o", folder / "out"}, kHere); };
  for (const char* name : {"none.toml", "stop.toml", "lane.toml"}) EXPECT_EQ(gate(name).exit_code, 2) << name;
  EXPECT_THAT(gate("none.toml").err, HasSubstr("asks for no check"));
  for (const auto& [name, where] : {std::pair{"stop.toml", "stop.toml:9:1"}, std::pair{"lane.toml", "lane.toml:11:1"}}) {
    EXPECT_THAT(gate(name).err, HasSubstr(where));
    const ProcessResult planned = forcegate({"plan", folder / name}, kHere);
    EXPECT_EQ(planned.exit_code, 2) << name;
    EXPECT_THAT(planned.err, HasSubstr(where));
  }
}

TEST(Mistakes, InThePlanThatOnlyAGateWouldShowAreRemarksOfThePlan) {
  TemporaryFolder folder;
  write_text(folder / "mine.toml", "format = 1\nname = \"mine\"\n[panel]\nspecimens = [\"q51x\"]\n[calibration]\nlevel = \"nominal\"\n[safety]\nforce_max_N = 9\n[limits]\nderived = \"none.toml\"\n"
                                   "[[case]]\nname = \"sine\"\nchecks = [\"accuracy\"]\nstimulus = { name = \"sine\", f_Hz = 0.5, A_N = 2, m_N = 5, duration_s = 10 }\n");
  const ProcessResult r = forcegate({"plan", folder / "mine.toml"}, kHere);
  EXPECT_EQ(r.exit_code, 0) << r.err;
  for (const char* remark : {"none.toml", "q51x", "goes to 7 N", "has no limit", "start window", "1 case, 1 record,"}) EXPECT_THAT(r.out, HasSubstr(remark));
  for (const char* plan : {"smoke", "nightly", "panel", "power", "campaign"}) EXPECT_THAT(forcegate({"plan", plan}, kHere).out, testing::Not(HasSubstr("note: "))) << plan;
}

TEST(Mistakes, InWordsOfTheCommandLineAreToldAsWhatTheyAre) {
  const auto err = [](const std::vector<std::string>& words) {
    const ProcessResult r = forcegate(words, kHere);
    EXPECT_EQ(r.exit_code, 2) << words[0];
    return r.err;
  };
  EXPECT_THAT(err({"stimulus", "sine", "f_Hz=0,5", "A_N=1", "m_N=2"}), HasSubstr("\"0,5\" in \"f_Hz=0,5\" is not a number"));
  EXPECT_THAT(err({"stimulus", "sine", "f_Hz=0.5", "f_Hz=0.6", "A_N=1", "m_N=2"}), HasSubstr("f_Hz is given twice"));
  EXPECT_THAT(err({"export", "flexiforce", "-o", "fit.h"}), HasSubstr("the header is --c FILE"));
  EXPECT_THAT(err({"compare", "film.csv", "--model", ""}), HasSubstr("--model names nothing: its value is empty\n  where: forcegate compare\n  help: give MODEL, or leave the option out"));
  EXPECT_THAT(err({"explain", "7"}), HasSubstr("exit codes: 0, "));
  EXPECT_THAT(forcegate({"stimulus", "sine", "f_Hz=0.5", "A_N=3", "m_N=4"}, kHere).err, HasSubstr("the wheel of the bench ends at 5.5 N"));
  EXPECT_THAT(forcegate({"explain", "rig error"}, kHere).out, HasSubstr("self-check"));
  EXPECT_THAT(forcegate({"explain", "marginal"}, kHere).out, HasSubstr("NO-DECISION"));
  for (const char* check : {"accuracy_maxima", "waiver_valid", "record"}) EXPECT_EQ(forcegate({"explain", check}, kHere).exit_code, 0) << check;
}

TEST(Mistakes, InTheRateOfAProfileAreToldBeforeTheFileShowsAnotherOne) {
  TemporaryFolder folder;
  const auto answer = [&](const std::string& rate) { return forcegate({"stimulus", "sine", "f_Hz=2", "A_N=1", "m_N=2", "--rate", rate, "--csv", folder / ("at_" + rate + ".csv")}, kHere); };
  EXPECT_EQ(answer("3").exit_code, 2);
  EXPECT_THAT(answer("3").err, HasSubstr("3 samples a second cannot show 2 Hz"));
  EXPECT_THAT(answer("3").err, HasSubstr("give at least 20"));
  EXPECT_FALSE(std::filesystem::exists(folder / "at_3.csv"));
  EXPECT_EQ(answer("10").exit_code, 0);
  EXPECT_THAT(answer("10").err, HasSubstr("5 samples in a cycle of 2 Hz"));
  EXPECT_THAT(answer("20").err, ::testing::Not(HasSubstr("samples in a cycle")));
}

TEST(Mistakes, InTheRateOfARecordingBlameNoRig) {
  TemporaryFolder folder;
  std::string slow = "t_s,F_ref_N,U_V\n";
  for (int i = 0; i < 600; ++i) slow += std::to_string(0.02 * i) + "," + std::to_string(i % 50 * 0.1) + "," + std::to_string(i % 50 * 0.2) + "\n";
  write_text(folder / "slow.csv", slow);
  const ProcessResult r = forcegate({"gate", kNative, "--record", folder / "slow.csv", "-o", folder / "out"}, kHere);
  EXPECT_THAT(r.err, HasSubstr("the image runs at 1000 Hz, what it is to follow at 50 Hz"));
}

TEST(Mistakes, InAShortRecordingAreToldWithItsFile) {
  TemporaryFolder folder;
  write_text(folder / "one.csv", "t_s,U_V\n0,1\n");
  std::string few = "t_s,F_ref_N,U_V\n";
  for (int i = 0; i < 24; ++i) few += std::to_string(i) + "," + std::to_string(i % 7) + "," + std::to_string(2 * (i % 7)) + "\n";
  write_text(folder / "few.csv", few);
  const ProcessResult one = forcegate({"diagnose", folder / "one.csv"}, kHere);
  EXPECT_THAT(one.err, HasSubstr("only 1 sample\n  where: " + (folder / "one.csv")));
  write_text(folder / "row.csv", "t_s,F_ref_N,U_V\n0,1,2\n");
  for (const std::vector<std::string>& words : std::vector<std::vector<std::string>>{{"compare", folder / "row.csv"}, {"fit", folder / "row.csv"}, {"characterize", "--record", folder / "row.csv"}}) {
    const ProcessResult r = forcegate(words, kHere);
    EXPECT_THAT(r.err, HasSubstr("the record has only 1 sample")) << words[0];
    EXPECT_THAT(r.err, HasSubstr("where: " + (folder / "row.csv"))) << words[0];
  }
  for (const std::vector<std::string>& command : std::vector<std::vector<std::string>>{{"diagnose", folder / "few.csv"}, {"fit", folder / "few.csv"}, {"characterize", "--record", folder / "few.csv"}}) {
    const ProcessResult r = forcegate(command, kHere);
    EXPECT_NE(r.exit_code, 0) << command[0];
    EXPECT_THAT(r.err, HasSubstr("where: " + (folder / "few.csv"))) << command[0];
  }
}

TEST(Mistakes, AreToldWithTheirPlaceAndALineOfHelp) {
  TemporaryFolder folder;
  const std::string out = folder / "out", nowhere = folder / "nowhere";
  const std::vector<std::pair<std::vector<std::string>, std::string>> told = {
      {{"gate", kNative, "--limits", nowhere, "-o", out}, nowhere},
      {{"gate", kNative, "--cal", nowhere, "-o", out}, nowhere},
      {{"gate", kNative, "--waivers", nowhere, "-o", out}, nowhere},
      {{"gate", kNative, "--record", nowhere, "-o", out}, nowhere},
      {{"gate", kNative, "--rig", nowhere + ".toml", "-o", out}, nowhere},
      {{"gate", kNative, "--rig", "nobody", "-o", out}, "--rig"},
      {{"gate", kNative, "--lane", "nobody", "-o", out}, "forcegate gate"},
      {{"gate", kNative, "--plan", "nowhere", "-o", out}, "looked in"},
      {{"gate", kNative, "--specimen", "nobody", "-o", out}, "rig emulated"},
      {{"gate", kNative, "--specimen", "seed:x", "-o", out}, "rig emulated"},
      {{"gate", kNative, "--fault", "nothing=1", "-o", out}, "rig emulated"},
      {{"gate", kNative, "--rig-option", "nothing=1", "-o", out}, "rig emulated"},
      {{"gate", kNative, "--rig-option", "nothing", "-o", out}, "--rig-option"},
      {{"gate", kNative, "--rig-option", "adc_bits=40", "-o", out}, "rig emulated"},
      {{"gate", kNative, "--rig-option", "noise=maybe", "-o", out}, "rig emulated"},
      {{"gate", kNative, "--rig-option", "hidden=creep:huge", "-o", out}, "rig emulated"},
      {{"record", "--plan", "nowhere", "-o", out}, "looked in"},
      {{"record", "--specimen", "nobody", "-o", out}, "rig emulated"},
      {{"plan", "nowhere"}, "looked in"},
      {{"report", nowhere}, nowhere},
      {{"diff", nowhere, nowhere}, nowhere},
      {{"check", nowhere}, nowhere},
      {{"recover", nowhere + ".fgj"}, nowhere},
      {{"convert", nowhere + ".csv", out}, nowhere},
      {{"compare", ""}, "\"\""},
      {{"compare", nowhere}, nowhere},
      {{"diagnose", nowhere}, nowhere},
  };
  for (const auto& [words, place] : told) {
    std::string line;
    for (const std::string& word : words) line += word + " ";
    const ProcessResult r = forcegate(words, kHere);
    EXPECT_EQ(r.exit_code, 2) << line << r.out;
    EXPECT_THAT(r.err, HasSubstr("\n  where: ")) << line;
    EXPECT_THAT(r.err.substr(std::min(r.err.size(), r.err.find("where:"))), HasSubstr(place)) << line;
    EXPECT_THAT(r.err, HasSubstr("\n  help: ")) << line;
  }
}

TEST(Mistakes, OfARecordingThatIsGivenTwiceAreNotJudgedByTheLast) {
  const ProcessResult r = forcegate({"gate", kNative, "--record", "nowhere.csv", "--record", "k.csv"}, kHere);
  EXPECT_EQ(r.exit_code, 2) << r.out;
  EXPECT_THAT(r.err, HasSubstr("--record is given twice\n  where: forcegate gate\n  help: give it once"));
}

TEST(Mistakes, InTheWordThatExplainIsAskedAreToldAlsoWhereThereIsNone) {
  for (const char* nothing : {"", " "}) {
    const ProcessResult r = forcegate({"explain", nothing}, kHere);
    EXPECT_EQ(r.exit_code, 2) << r.out;
    EXPECT_THAT(r.err, HasSubstr("TERM is empty"));
  }
}

}  // namespace
}  // namespace forcegate::test
