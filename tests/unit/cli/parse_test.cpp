#include "hil/cli/parse.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/base/rng.h"
#include "hil/cli/completion.h"
#include "hil/cli/help.h"

namespace forcegate {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

const std::vector<Command>& table() {
  static const std::vector<Command> kTable = {
      {.name = "play",
       .group = "Test",
       .summary = "plays",
       .description = "Plays.",
       .positionals = {{.name = "PIECE", .doc = "What to play."},
                       {.name = "MORE", .doc = "And then.", .required = false, .repeatable = true}},
       .options =
           {{.name = "speed", .value_name = "HZ", .doc = "How fast.", .fallback = "2.5", .letter = 's'},
            {.name = "tone",
             .value_name = "NAME",
             .doc = "Which tone.",
             .choices =
                 [] {
                   return std::vector<std::string>{"low", "high"};
                 }},
            {.name = "map", .value_name = "A=B", .doc = "Maps.", .repeatable = true},
            {.name = "score", .value_name = "FILE", .doc = "Notes.", .names = Names::input},
            {.name = "loud", .value_name = "", .doc = "Louder.", .letter = 'l'}},
       .run = [](const Invocation&) -> Result<int> { return 0; }},
      {.name = "piano tune",
       .group = "Test",
       .summary = "tunes",
       .description = "Tunes.",
       .positionals = {{.name = "KEY", .doc = "Which key."}},
       .run = [](const Invocation&) -> Result<int> { return 0; }},
      {.name = "piano move",
       .group = "Test",
       .summary = "moves",
       .description = "Moves.",
       .run = [](const Invocation&) -> Result<int> { return 0; }}};
  return kTable;
}

ParsedLine parse(const std::vector<std::string>& arguments) { return parse_command_line(arguments, table()); }

Invocation invocation(const ParsedLine& line, Console& console) {
  Invocation in(*line.command, console);
  for (const auto& [name, value] : line.values) in.set(name, value);
  in.set_command_line(line.words);
  return in;
}

TEST(Parse, TakesValuesInEveryNotation) {
  for (const auto& arguments :
       std::vector<std::vector<std::string>>{{"play", "fugue", "--speed", "3", "--loud"},
                                             {"play", "--loud", "--speed=3", "fugue"},
                                             {"play", "-l", "-s", "3", "fugue"}}) {
    const ParsedLine line = parse(arguments);
    ASSERT_FALSE(line.error) << line.error->to_text();
    Console console({});
    const Invocation in = invocation(line, console);
    EXPECT_EQ(in.text("PIECE"), "fugue");
    EXPECT_TRUE(in.flag("loud"));
    EXPECT_EQ(in.number("speed", 0, 10).value(), 3.0);
  }
}

TEST(Parse, AnOptionTakesTheNextWordWhateverItLooksLikeAndTwoDashesEndTheOptions) {
  const ParsedLine line = parse({"play", "--speed", "-3", "--", "--loud", "-x"});
  ASSERT_FALSE(line.error);
  Console console({});
  const Invocation in = invocation(line, console);
  EXPECT_EQ(in.number("speed", -10, 10).value(), -3.0);
  EXPECT_EQ(in.text("PIECE"), "--loud");
  EXPECT_THAT(in.texts("MORE"), ElementsAre("-x"));
  EXPECT_FALSE(in.flag("loud"));
}

TEST(Parse, FallbacksStandWhereNothingWasGivenAndDoNotCountAsGiven) {
  const ParsedLine line = parse({"play", "fugue"});
  Console console({});
  const Invocation in = invocation(line, console);
  EXPECT_EQ(in.text("speed"), "2.5");
  EXPECT_FALSE(in.given("speed"));
  EXPECT_TRUE(in.texts("map").empty());
}

TEST(Parse, RepeatableOptionsKeepAll) {
  const ParsedLine line = parse({"play", "x", "--map", "a=b", "--map=c=d"});
  Console console({});
  const Invocation in = invocation(line, console);
  EXPECT_THAT(in.texts("map"), ElementsAre("a=b", "c=d"));
}

TEST(Parse, AnOptionWithAValueThatIsNotRepeatableIsGivenOnce) {
  for (const auto& twice : std::vector<std::vector<std::string>>{{"play", "x", "-s", "1", "--speed=2"},
                                                                 {"play", "--speed", "2", "x", "--speed", "2"}}) {
    const ParsedLine line = parse(twice);
    ASSERT_TRUE(line.error);
    EXPECT_EQ(line.error->code, ErrorCode::usage);
    EXPECT_EQ(line.error->where, "forcegate play");
    EXPECT_THAT(line.error->text, HasSubstr("--speed is given twice"));
    EXPECT_FALSE(line.error->hint.empty());
  }
  EXPECT_FALSE(parse({"play", "x", "-l", "--loud", "-q", "-q", "--color=never", "--color=auto"}).error);
}

TEST(Parse, NumbersAreCheckedWithRangeAndWithoutLocale) {
  Console console({});
  for (const char* wrong : {"", "x", "1,5", "1.5x", "nan", "inf", "11", " 1", "0x10", "1e999"}) {
    const auto number = invocation(parse({"play", "x", "--speed", wrong}), console).number("speed", 0, 10);
    ASSERT_FALSE(number.has_value()) << wrong;
    EXPECT_EQ(number.error().code, ErrorCode::usage);
    EXPECT_THAT(number.error().hint, HasSubstr("from 0 to 10"));
  }
  const auto seed = [&](const char* text) {
    return invocation(parse({"play", "x", "--speed", text}), console).seed("speed");
  };
  EXPECT_EQ(seed("18446744073709551615").value(), ~0ULL);
  EXPECT_EQ(seed("0xff").value(), 255u);
  for (const char* wrong : {"-1", "18446744073709551616", "0x", "1.0"})
    EXPECT_FALSE(seed(wrong).has_value()) << wrong;
}

TEST(Parse, TheCommandLineOfARunCanBePastedIntoAShell) {
  Console console({});
  const ParsedLine line = parse({"play", "my file", "--map", "it's=1"});
  EXPECT_EQ(invocation(line, console).command_line(), "forcegate play 'my file' --map 'it'\\''s=1'");
  EXPECT_EQ(shell_quoted(""), "''");
}

TEST(Parse, AnOptionIsLeftOutOfTheCommandLineHoweverItWasWritten) {
  Console console({});
  for (const auto& arguments : std::vector<std::vector<std::string>>{{"play", "fugue", "--speed", "3", "--loud"},
                                                                     {"play", "--speed=3", "fugue", "--loud"},
                                                                     {"play", "fugue", "-s", "3", "--loud"},
                                                                     {"play", "fugue", "--loud", "--speed", "3"}}) {
    const ParsedLine line = parse(arguments);
    EXPECT_EQ(invocation(line, console).command_line_without("speed"), "forcegate play fugue --loud");
  }
  const ParsedLine value = parse({"play", "fugue", "--map", "--speed", "--", "--speed"});
  EXPECT_EQ(invocation(value, console).command_line_without("speed"), "forcegate play fugue --map --speed -- --speed");
}

TEST(Parse, AFileBehindTheEndOfTheOptionsIsSaidSoThatTheLineMayGoOn) {
  Console console({});
  const std::vector<Command> reads = {{.name = "load", .group = "Test", .summary = "loads", .description = "Loads.", .positionals = {{.name = "FILE", .doc = "Which.", .names = Names::input}}, .run = [](const Invocation&) -> Result<int> { return 0; }}};
  const std::vector<std::string> words{"load", "--", "-q.csv"};
  const ParsedLine line = parse_command_line(words, reads);
  EXPECT_EQ(invocation(line, console).command_line(), "forcegate load ./-q.csv");
}

TEST(Parse, AnyArgumentsGiveALineOrAnErrorWithHelp) {
  const std::vector<std::string> words = {"play", "--speed",  "-s", "--",     "-",      "--loud=", "=",
                                          "--=x", "\xff\x01", "",   "--tone", "low",    "--json",  "--color",
                                          "help", "--help",   "-q", "---",    "--map=", "x"};
  Rng rng(5);
  for (int trial = 0; trial < 20000; ++trial) {
    std::vector<std::string> arguments;
    for (std::uint64_t n = rng.below(7); n > 0; --n) arguments.push_back(words[rng.below(words.size())]);
    const ParsedLine line = parse(arguments);
    if (line.error) {
      EXPECT_FALSE(line.error->text.empty());
      EXPECT_FALSE(line.error->hint.empty()) << line.error->text;
    } else if (line.command != nullptr && !line.help) {
      EXPECT_FALSE(line.values.empty()) << "PIECE is required";
    }
    (void)completions(arguments, table());
  }
}

TEST(Parse, AVerbOfTwoWordsIsFoundByBoth) {
  const ParsedLine tune = parse({"piano", "tune", "a4"});
  ASSERT_FALSE(tune.error);
  EXPECT_EQ(tune.command->name, "piano tune");
  EXPECT_EQ(tune.values.front().second, "a4");
  const ParsedLine alone = parse({"piano"});
  ASSERT_TRUE(alone.error);
  EXPECT_THAT(alone.error->hint, HasSubstr("piano move"));
  const ParsedLine typo = parse({"piano", "tone"});
  ASSERT_TRUE(typo.error);
  EXPECT_THAT(typo.error->hint, HasSubstr("forcegate piano tune"));
  const ParsedLine help = parse({"piano", "--help"});
  EXPECT_FALSE(help.error);
  EXPECT_EQ(help.family, "piano");
}

TEST(Completion, OffersTheSecondWordAfterTheFirst) {
  const std::vector<std::string> first{"p"}, second{"piano", ""}, option{"piano", "tune", "--j"};
  EXPECT_THAT(completions(first, table()), ElementsAre("play", "piano"));
  EXPECT_THAT(completions(second, table()), ElementsAre("tune", "move"));
  EXPECT_THAT(completions(option, table()), ElementsAre("--json"));
}

TEST(Help, WrapsAtTheColumnAndKeepsIndentedLines) {
  EXPECT_EQ(wrapped("one two three", 2, 10), "  one two\n  three\n");
  EXPECT_EQ(wrapped("  table  row that is longer than the width", 0, 10),
            "  table  row that is longer than the width\n");
  EXPECT_EQ(wrapped("a\n\nb", 0, 10), "a\n\nb\n");
}

TEST(ExitCodes, EveryErrorCodeHasADocumentedOne) {
  for (int code = 0; code <= static_cast<int>(ErrorCode::internal); ++code)
    EXPECT_NE(exit_code_text(exit_code_of(static_cast<ErrorCode>(code))), "") << code;
}

TEST(Parse, AnOptionThatNamesAFileIsNotGivenAnEmptyName) {
  for (const std::vector<std::string>& line : {std::vector<std::string>{"play", "x", "--score", ""}, {"play", "x", "--score="}}) {
    const ParsedLine parsed = parse_command_line(line, table());
    ASSERT_TRUE(parsed.error);
    EXPECT_THAT(parsed.error->text, HasSubstr("--score names nothing"));
    EXPECT_THAT(parsed.error->hint, HasSubstr("give FILE, or leave the option out"));
  }
  EXPECT_FALSE(parse_command_line(std::vector<std::string>{"play", "x", "--map", ""}, table()).error);
}

}  // namespace
}  // namespace forcegate
