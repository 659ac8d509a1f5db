#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/support/process.h"

namespace forcegate::test {
namespace {

using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;
using Json = nlohmann::json;

std::vector<std::string> visible_verbs() {
  std::vector<std::string> verbs;
  std::istringstream lines(forcegate({"completion", "--words", "--", ""}).out);
  for (std::string line; std::getline(lines, line);) verbs.push_back(line);
  return verbs;
}

TEST(CommandLine, WithoutAVerbShowsTheVerbsAndFails) {
  const ProcessResult r = forcegate({});
  EXPECT_EQ(r.exit_code, 2);
  EXPECT_EQ(r.out, "");
  EXPECT_THAT(r.err, HasSubstr("stimulus"));
}

TEST(CommandLine, HelpNamesEveryVerbAndEveryExitCode) {
  const ProcessResult r = forcegate({"--help"});
  EXPECT_EQ(r.exit_code, 0);
  EXPECT_EQ(r.err, "");
  const auto verbs = visible_verbs();
  ASSERT_GE(verbs.size(), 8u);
  for (const std::string& verb : verbs) EXPECT_THAT(r.out, HasSubstr("\n  " + verb + " ")) << verb;
  for (const char* code : {"  0 ", "  1 ", "  2 ", "  3 ", "  4 ", "  5 ", "  6 ", "130 "})
    EXPECT_THAT(r.out, HasSubstr(code));
}

TEST(CommandLine, HelpOfEveryVerbTeachesByDescriptionExampleAndExitCodes) {
  for (const std::string& verb : visible_verbs()) {
    const ProcessResult r = forcegate({verb, "--help"});
    EXPECT_EQ(r.exit_code, 0) << verb;
    EXPECT_EQ(r.err, "") << verb;
    for (const char* part : {"Usage:", "Examples:", "Exit codes:", "--json"})
      EXPECT_THAT(r.out, HasSubstr(part)) << verb;
    EXPECT_EQ(forcegate({"help", verb}).out, r.out) << verb;
  }
}

TEST(CommandLine, HelpLinesFitTheScreen) {
  for (const std::string& verb : visible_verbs()) {
    std::istringstream lines(forcegate({verb, "--help"}).out);
    for (std::string line; std::getline(lines, line);)
      if (line.find("forcegate ") == std::string::npos) {
        EXPECT_LE(line.size(), 130u) << verb << ": " << line;
      }
  }
}

TEST(CommandLine, WrongWordsAreUsageErrorsWithASuggestion) {
  struct Case {
    std::vector<std::string> arguments;
    std::string hint;
  };
  for (const Case& c : {Case{{"stimulsu"}, "did you mean \"forcegate stimulus\"?"},
                        Case{{"stimulus", "sine", "--polt", "x.svg"}, "did you mean \"--plot\"?"},
                        Case{{"stimulus", "sin"}, "did you mean \"sine\"?"},
                        Case{{"stimulus", "sine", "f_hz=1"}, "did you mean 'f_Hz'?"},
                        Case{{"doctor", "--color", "alway"}, "did you mean \"always\"?"},
                        Case{{"explain", "margnal"}, "did you mean \"marginal\"?"}}) {
    const ProcessResult r = forcegate(c.arguments);
    EXPECT_EQ(r.exit_code, 2) << c.hint;
    EXPECT_EQ(r.out, "") << c.hint;
    EXPECT_THAT(r.err, HasSubstr("error: ")) << c.hint;
    EXPECT_THAT(r.err, HasSubstr("help: " + c.hint));
  }
}

TEST(CommandLine, ExplainTellsTheFormsOfAnEffect) {
  const ProcessResult r = forcegate({"explain", "static_nonlinearity"});
  EXPECT_EQ(r.exit_code, 0);
  EXPECT_THAT(r.out, ::testing::HasSubstr("saturation: c | F1_N in N, width_N in N"));
  EXPECT_THAT(r.out, ::testing::HasSubstr("power_before_lag: c | tau_s in s, n (where the model has lag)"));
}

TEST(CommandLine, ExplainsEveryMeaningOfAWord) {
  const ProcessResult r = forcegate({"explain", "none"});
  EXPECT_EQ(r.exit_code, 0);
  EXPECT_THAT(r.out, HasSubstr("none (diagnosis)"));
  EXPECT_THAT(r.out, HasSubstr("none (who must act)"));
}

// Verbs that hold nothing are ended at once, and say so.
TEST(CommandLine, CtrlCIsTold) {
  TemporaryFolder folder;
  ASSERT_EQ(run_process({"mkfifo", folder / "pipe.csv"}).exit_code, 0);  // nobody writes into it
  for (const char* verb : {"diagnose", "compare"}) {
    const ProcessOptions interrupted{.folder = folder.path(), .signal_after = std::chrono::milliseconds(500), .signal = 2};
    const ProcessResult text = forcegate({verb, "pipe.csv"}, interrupted);
    EXPECT_EQ(text.exit_code, 130);
    EXPECT_EQ(text.err, "error: interrupted\n");
    const ProcessResult json = forcegate({verb, "pipe.csv", "--json"}, interrupted);
    EXPECT_EQ(json.exit_code, 130);
    EXPECT_THAT(json.out, ::testing::AllOf(::testing::StartsWith("{\n  \"error\": {\n    \"code\": \"cancelled\""), ::testing::EndsWith("}\n")));
    EXPECT_THAT(forcegate({verb, "--help"}).out, HasSubstr("130 "));
  }
}

TEST(CommandLine, CtrlCSaysWhatAJournalHolds) {
  TemporaryFolder folder;
  const ProcessOptions interrupted{.folder = folder.path(), .signal_after = std::chrono::milliseconds(500), .signal = 2};
  const ProcessResult r = forcegate({"-q", "league", "--seed", "5", "--journal", "j"}, interrupted);
  EXPECT_EQ(r.exit_code, 130);
  EXPECT_EQ(r.err, "error: interrupted\n  help: what is finished is kept in j: the same command goes on from there\n");
}

TEST(CommandLine, QuietMeansNoNotes) {
  TemporaryFolder folder;
  std::string text = "F_ref_N,U_V\n";
  for (int i = 0; i < 2000; ++i) text += std::to_string(0.01 * (i % 400)) + "," + std::to_string(0.02 * (i % 400) + 0.001 * (i % 7)) + "\n";
  write_text(folder / "run.csv", text);
  const ProcessOptions here{.folder = folder.path()};
  for (const std::vector<std::string>& words : {std::vector<std::string>{"convert", "run.csv", "run.h5", "--rate", "50", "--force"}, {"diagnose", "run.csv", "--rate", "50"}}) {
    std::vector<std::string> quiet = words;
    quiet.push_back("-q");
    EXPECT_THAT(forcegate(words, here).out, HasSubstr("note: ")) << words.front();
    const ProcessResult r = forcegate(quiet, here);
    EXPECT_EQ(r.exit_code, 0) << r.err;
    EXPECT_THAT(r.out, Not(HasSubstr("note: "))) << words.front();
    EXPECT_NE(r.out, "") << "the answer stays";
  }
}

TEST(CommandLine, MissingAndSuperfluousArgumentsAreNamed) {
  EXPECT_THAT(forcegate({"convert", "a.csv"}).err, HasSubstr("TO is missing"));
  EXPECT_THAT(forcegate({"bench"}).err, HasSubstr("help: one of: list, doctor, scan, serve, park, reset, jog, who, specimens"));
  EXPECT_THAT(forcegate({"version", "now"}).err, HasSubstr("unexpected argument \"now\""));
  EXPECT_THAT(forcegate({"stimulus", "sine", "--csv"}).err, HasSubstr("--csv wants a value FILE"));
  EXPECT_THAT(forcegate({"version", "--json=1"}).err, HasSubstr("--json takes no value"));
  EXPECT_THAT(forcegate({"stimulus", "sine", "--rate", "1k"}).err,
              HasSubstr("--rate wants a number, not \"1k\""));
  EXPECT_THAT(forcegate({"mystery", "--minutes", "-3", "m"}).err, HasSubstr("--minutes is -3, outside of 1 to 60"));
  for (const auto& arguments : std::vector<std::vector<std::string>>{{"convert", "a.csv"},
                                                                     {"version", "now"},
                                                                     {"stimulus", "sine", "--csv"},
                                                                     {"stimulus", "sine", "--rate", "nan"}})
    EXPECT_EQ(forcegate(arguments).exit_code, 2);
}

TEST(CommandLine, HelpIsJsonWhenAsked) {
  const Json all = Json::parse(forcegate({"--help", "--json"}).out, nullptr, false);
  ASSERT_FALSE(all.is_discarded());
  const auto verbs = visible_verbs();
  EXPECT_GE(all["verbs"].size(), verbs.size());
  for (const std::string& verb : verbs) {
    const ProcessResult r = forcegate({verb, "--help", "--json"});
    EXPECT_EQ(r.exit_code, 0) << verb;
    const Json one = Json::parse(r.out, nullptr, false);
    ASSERT_FALSE(one.is_discarded()) << verb << ": " << r.out;
    EXPECT_EQ(one["format"], 1) << verb;
    if (one.contains("verb")) {  // not of a family, as "bench"
      EXPECT_EQ(one["verb"], verb);
      EXPECT_FALSE(one["examples"].empty()) << verb;
    }
  }
}

TEST(CommandLine, ErrorsAreJsonWhenAsked) {
  for (const auto& arguments :
       std::vector<std::vector<std::string>>{{"--json"},
                                             {"bench", "--json"},
                                             {"stimulus", "sin", "--json"},
                                             {"nonsense", "--json"},
                                             {"convert", "/gone.csv", "x.h5", "--json"}}) {
    const ProcessResult r = forcegate(arguments);
    EXPECT_EQ(r.exit_code, 2);
    const Json document = Json::parse(r.out, nullptr, false);
    ASSERT_FALSE(document.is_discarded()) << r.out;
    EXPECT_EQ(document["error"]["exit_code"], 2);
    EXPECT_FALSE(document["error"]["text"].get<std::string>().empty());
    EXPECT_FALSE(document["error"]["help"].get<std::string>().empty());
    EXPECT_EQ(r.err, "");
  }
}

TEST(CommandLine, JsonIsOneDocumentWithAFormatNumber) {
  for (const auto& arguments :
       std::vector<std::vector<std::string>>{{"version"},
                                             {"--version"},
                                             {"man"},
                                             {"completion", "bash"},
                                             {"completion", "--words", "--", "expl"},
                                             {"explain"},
                                             {"explain", "4"},
                                             {"stimulus", "--list"},
                                             {"stimulus", "sine", "f_Hz=0.5", "A_N=1", "m_N=2"},
                                             {"doctor"}}) {
    auto with_json = arguments;
    with_json.insert(with_json.begin(), "--json");
    const ProcessResult r = forcegate(with_json);
    const Json document = Json::parse(r.out, nullptr, false);
    ASSERT_FALSE(document.is_discarded()) << arguments[0] << ": " << r.out;
    EXPECT_EQ(document.value("format", 0), 1) << arguments[0];
  }
}

TEST(CommandLine, ColourObeysOptionThenEnvironmentThenTerminal) {
  const std::string escape = "\033[";
  EXPECT_THAT(forcegate({"--help"}).out, Not(HasSubstr(escape)));
  EXPECT_THAT(forcegate({"--help", "--color", "always"}).out, HasSubstr(escape));
  EXPECT_THAT(forcegate({"--help"}, {.environment = {{"CLICOLOR_FORCE", "1"}}}).out, HasSubstr(escape));
  EXPECT_THAT(forcegate({"--help"}, {.environment = {{"CLICOLOR_FORCE", "0"}}}).out, Not(HasSubstr(escape)));
  EXPECT_THAT(forcegate({"--help"}, {.environment = {{"CLICOLOR_FORCE", "1"}, {"NO_COLOR", "1"}}}).out,
              Not(HasSubstr(escape)));
  EXPECT_THAT(forcegate({"--help", "--color=always"}, {.environment = {{"NO_COLOR", "1"}}}).out,
              HasSubstr(escape));
  EXPECT_THAT(forcegate({"--help", "--color=never"}, {.environment = {{"CLICOLOR_FORCE", "1"}}}).out,
              Not(HasSubstr(escape)));
}

TEST(CommandLine, TheLastLineSaysWhatToDoNextUnlessQuiet) {
  EXPECT_THAT(forcegate({"version"}).out, ContainsRegex("\nnext: [^\n]+\n$"));
  EXPECT_THAT(forcegate({"version", "--quiet"}).out, Not(HasSubstr("next:")));
  EXPECT_THAT(forcegate({"version", "-q"}).out, HasSubstr("forcegate " FORCEGATE_VERSION));
}

TEST(CommandLine, AFullDiskBehindStdoutIsNotSuccess) {
  for (const std::vector<std::string>& line :
       {std::vector<std::string>{"explain"}, {"explain", "--json"}, {"man"}, {"simulate", "nowhere.csv", "--json"}, {"stimulus", "--help"}}) {
    const ProcessResult r = forcegate(line, {.out_file = "/dev/full"});
    EXPECT_EQ(r.exit_code, 2) << line.front();
    EXPECT_THAT(r.err, HasSubstr("cannot write to standard output")) << line.front();
  }
}

TEST(CommandLine, ForeignBytesNeverReachTheTerminalRaw) {
  const ProcessResult r = forcegate({"stimulus", "\033[31mred\x07\xff"});
  EXPECT_EQ(r.exit_code, 2);
  EXPECT_THAT(r.err, Not(HasSubstr("\033")));
  EXPECT_THAT(r.err, Not(HasSubstr("\x07")));
  EXPECT_THAT(r.err, Not(HasSubstr("\xff")));
}

TEST(CommandLine, TheManualPageIsReadByMan) {
  TemporaryFolder folder;
  const ProcessResult page = forcegate({"man"});
  ASSERT_EQ(page.exit_code, 0);
  EXPECT_THAT(page.out, HasSubstr(".SH EXIT STATUS"));
  for (const std::string& verb : visible_verbs())
    EXPECT_THAT(page.out, HasSubstr(".SS forcegate " + verb)) << verb;
  for (const char* line : {"\n ", "\n'"})
    EXPECT_THAT(page.out, Not(HasSubstr(line))) << "roff would read it as its own";
}

TEST(Completion, OffersVerbsOptionsChoicesAndStimuli) {
  const auto words = [](std::vector<std::string> typed) {
    typed.insert(typed.begin(), {"completion", "--words", "--"});
    return forcegate(typed).out;
  };
  EXPECT_EQ(words({"stim"}), "stimulus\n");
  EXPECT_EQ(words({"stimulus", "mult"}), "multisine\n");
  EXPECT_EQ(words({"stimulus", "sine", "--pl"}), "--plot\n");
  EXPECT_EQ(words({"version", "--color", "a"}), "auto\nalways\n");
  EXPECT_EQ(words({"stimulus", "sine", "--csv", ""}), "") << "file names are the shell's business";
  EXPECT_EQ(words({"worker"}), "") << "hidden verbs are not offered";
}

TEST(Completion, TheBashScriptCompletesInBash) {
  const std::string script = "eval \"$(" FORCEGATE_BINARY_DIR
                             "/forcegate completion bash)\"\n"
                             "COMP_WORDS=(" FORCEGATE_BINARY_DIR
                             "/forcegate stimulus chi); COMP_CWORD=2; _forcegate; echo \"${COMPREPLY[*]}\"\n";
  const ProcessResult r = run_process({"bash", "--norc", "-c", script});
  EXPECT_EQ(r.out, "chirp\n") << r.err;
}

TEST(Completion, AnUnknownShellIsAUsageError) {
  const ProcessResult r = forcegate({"completion", "tcsh"});
  EXPECT_EQ(r.exit_code, 2);
  EXPECT_THAT(r.err, HasSubstr("bash, zsh, fish"));
}

TEST(Doctor, SaysForEachMissingThingHowToGetIt) {
  const ProcessResult r = forcegate({"doctor", "--json"}, {.environment = {{"PATH", "/nowhere"}}});
  EXPECT_EQ(r.exit_code, 3) << "qemu is required and not in this PATH";
  const Json document = Json::parse(r.out);
  EXPECT_EQ(document["ready"], false);
  bool seen_qemu = false;
  for (const Json& item : document["items"]) {
    if (item["state"] != "ok") {
      EXPECT_FALSE(item["remedy"].get<std::string>().empty()) << item;
    }
    if (item["name"] == "qemu-system-arm") {
      seen_qemu = true;
      EXPECT_EQ(item["state"], "missing");
      EXPECT_THAT(item["remedy"].get<std::string>(), HasSubstr("apt-get install qemu-system-arm"));
    }
  }
  EXPECT_TRUE(seen_qemu);
}

TEST(Explain, KnowsEveryVerdictDecisionAndExitCode) {
  for (const char* term : {"ACCEPT", "reject", "No-Decision", "pass", "marginal", "fail", "inconclusive",
                           "rig_error", "not_run", "waived", "firmware_runs", "mre_maxima", "conformance", "rig_following",
                           "output_bounded", "golden_firmware", "promise_maxima/four_sines", "0", "1", "2", "3", "4", "5", "6", "130"}) {
    const ProcessResult r = forcegate({"explain", term});
    EXPECT_EQ(r.exit_code, 0) << term;
    EXPECT_THAT(r.out, HasSubstr("What to do:")) << term;
  }
}

}  // namespace
}  // namespace forcegate::test
