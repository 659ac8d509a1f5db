#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <pugixml.hpp>
#include <sstream>

#include "hil/base/text.h"
#include "hil/interface/reporter.h"
#include "hil/report/console.h"
#include "hil/report/judged.h"
#include "tests/support/sample_run.h"

namespace forcegate {
namespace {

using sample::Variant;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

std::string render(const std::string& name, const RunResult& result) {
  const ReporterKind* kind = Registry<ReporterKind>::instance().find(name);
  return kind == nullptr ? "no reporter " + name : kind->render(result);
}

std::string name_of(Variant v) {
  switch (v) {
    case Variant::accept: return "accept";
    case Variant::reject: return "reject";
    case Variant::no_decision: return "no_decision";
    case Variant::rig_fault: return "rig_fault";
  }
  return "";
}

/// FORCEGATE_UPDATE_GOLDEN=1 rewrites the file instead of comparing (docs/report.md); never set where builds
/// are judged.
void expect_golden(const std::string& file, const std::string& text) {
  const std::string path = FORCEGATE_SOURCE_DIR "/tests/data/report/" + file;
  if (const char* update = std::getenv("FORCEGATE_UPDATE_GOLDEN");
      update != nullptr && std::string(update) == "1") {
    ASSERT_EQ(std::getenv("CI"), nullptr) << "goldens are not rewritten on a CI server";
    std::ofstream(path, std::ios::binary) << text;
    GTEST_SKIP() << "rewrote " << path;
  }
  std::ifstream in(path, std::ios::binary);
  ASSERT_TRUE(in) << path;
  std::ostringstream golden;
  golden << in.rdbuf();
  EXPECT_EQ(text, golden.str()) << file;
}

class View : public testing::TestWithParam<Variant> {
 protected:
  RunResult result_ = sample::run(GetParam(), 60.0);
};

TEST_P(View, console_is_as_approved) {
  expect_golden("console_" + name_of(GetParam()) + ".txt", render("console", result_));
}

TEST_P(View, markdown_is_as_approved) {
  expect_golden("summary_" + name_of(GetParam()) + ".md", render("markdown", result_));
}

TEST_P(View, junit_is_as_approved) {
  expect_golden("junit_" + name_of(GetParam()) + ".xml", render("junit", result_));
}

TEST_P(View, annotations_are_as_approved) {
  expect_golden("github_" + name_of(GetParam()) + ".txt", render("github", result_));
}

TEST_P(View, first_line_is_decision_and_reason_everywhere) {
  const std::string decision(to_string(result_.decision.kind));
  for (const char* view : {"console", "markdown", "github"}) {
    const std::string text = render(view, result_);
    std::string first = text.substr(0, text.find('\n'));
    std::erase(first, '\\');  // Markdown protects underscores
    EXPECT_THAT(first, HasSubstr(decision)) << view;
    EXPECT_THAT(first, HasSubstr(result_.decision.reason.substr(0, 20))) << view;
  }
}

INSTANTIATE_TEST_SUITE_P(Variants, View,
                         testing::Values(Variant::accept, Variant::reject, Variant::no_decision,
                                         Variant::rig_fault),
                         [](const auto& tested) { return name_of(tested.param); });

TEST(Console, uses_colour_only_when_asked) {
  const RunResult r = sample::run(Variant::reject, 60.0);
  EXPECT_EQ(render_console(r, {}).find('\x1b'), std::string::npos);
  EXPECT_THAT(render_console(r, {.colour = true}), StartsWith("\x1b[31;1m"));
}

TEST(Console, has_an_ascii_form) {
  for (const char c : render_console(sample::run(Variant::no_decision, 60.0), {.ascii = true}))
    ASSERT_LT(static_cast<unsigned char>(c), 0x80);
}

TEST(Console, says_how_many_rows_are_left_out) {
  RunResult r = sample::run(Variant::reject, 60.0);
  const std::size_t all = rows_to_look_at(r).size();
  EXPECT_THAT(render_console(r, {.max_rows = 2}), HasSubstr("and " + std::to_string(all - 2) + " more"));
}

TEST(Console, lets_no_control_byte_of_a_firmware_through) {
  const std::string text = render("console", sample::hostile());
  for (const char c : text) ASSERT_FALSE(static_cast<unsigned char>(c) < 0x20 && c != '\n');
}

TEST(JUnit, counts_what_it_holds_and_maps_the_verdicts) {
  const RunResult r = sample::run(Variant::rig_fault, 60.0);
  pugi::xml_document doc;
  ASSERT_TRUE(doc.load_string(render("junit", r).c_str()));
  int tests = 0, failures = 0, errors = 0, skipped = 0;
  for (const auto suite : doc.child("testsuites"))
    for (const auto test : suite) {
      ++tests;
      failures += !test.child("failure").empty();
      errors += !test.child("error").empty();
      skipped += !test.child("skipped").empty();
    }
  const auto root = doc.child("testsuites");
  EXPECT_EQ(root.attribute("tests").as_int(), tests);
  EXPECT_EQ(root.attribute("failures").as_int(), failures);
  EXPECT_EQ(root.attribute("errors").as_int(), errors);
  EXPECT_EQ(root.attribute("skipped").as_int(), skipped);
  EXPECT_EQ(failures, 0);  // a rig fault is never charged to the build
  EXPECT_EQ(errors, 1 + 5 + 1);
  EXPECT_EQ(tests, static_cast<int>(judged_rows(r).size()) + 1);
}

TEST(JUnit, what_is_marginal_is_no_passed_test_where_the_rule_does_not_accept_it) {
  RunResult r = sample::run(Variant::no_decision, 60.0);
  r.cases[0].checks[1].verdict = Verdict::marginal;
  const auto type = [&](const std::string& rule) {
    r.decision_rule = rule + ": accept when ...";
    pugi::xml_document doc;
    EXPECT_TRUE(doc.load_string(render("junit", r).c_str()));
    for (const auto suite : doc.child("testsuites"))
      for (const auto test : suite)
        if (test.find_node([](const auto& n) { return n.attribute("value").as_string() == std::string("marginal"); })) return std::string(test.child("error").attribute("type").as_string());
    return std::string("no such test");
  };
  EXPECT_EQ(type("guarded"), "marginal");
  EXPECT_EQ(type("simple"), "");
}

TEST(JUnit, does_not_turn_red_for_a_check_that_is_not_required) {
  RunResult r = sample::run(Variant::accept, 60.0);
  r.cases[0].checks[1].verdict = Verdict::fail;
  r.cases[0].checks[1].required = false;
  const std::string xml = render("junit", r);
  EXPECT_THAT(xml, Not(HasSubstr("<failure")));
  EXPECT_THAT(xml, HasSubstr("<skipped"));
}

TEST(JUnit, is_well_formed_with_hostile_texts) {
  const std::string xml = render("junit", sample::hostile());
  pugi::xml_document doc;
  EXPECT_TRUE(doc.load_string(xml.c_str()));
  EXPECT_THAT(xml, Not(HasSubstr("<script")));
  EXPECT_THAT(xml, Not(HasSubstr("]]>")));
  for (const char c : xml) ASSERT_FALSE(static_cast<unsigned char>(c) < 0x20 && c != '\n' && c != '\t');
}

TEST(Markdown, stays_below_sixty_kilobytes_and_says_what_is_missing) {
  RunResult r = sample::run(Variant::reject, 60.0);
  const CaseResult one = r.cases[0];
  for (int i = 0; i < 3000; ++i) {
    r.cases.push_back(one);
    r.cases.back().id += std::to_string(i);
    r.notes.push_back(std::string(300, 'n'));
  }
  r.command_line = std::string(100000, 'c');
  const std::string text = render("markdown", r);
  EXPECT_LT(text.size(), 60000u);
  EXPECT_THAT(text, HasSubstr("more rows in result.json"));
  EXPECT_THAT(text, HasSubstr("### Reproduce"));
}

TEST(Markdown, makes_no_tag_no_mention_and_no_table_cell_of_hostile_texts) {
  const std::string text = render("markdown", sample::hostile());
  std::istringstream lines(text);
  std::string line;
  while (std::getline(lines, line)) {
    if (line.rfind("| ", 0) == 0) {
      std::size_t bars = 0;
      for (std::size_t i = 0; i < line.size(); ++i) bars += line[i] == '|' && (i == 0 || line[i - 1] != '\\');
      EXPECT_EQ(bars, 7u) << line;
    }
    if (line.find("`") == std::string::npos) {
      EXPECT_THAT(line, Not(HasSubstr("<script")));
      EXPECT_THAT(line, Not(HasSubstr("@all")));
    }
  }
}

TEST(Annotations, are_at_most_ten_and_the_worst_come_first) {
  RunResult r = sample::run(Variant::reject, 60.0);
  const CaseResult one = r.cases[2];
  for (int i = 0; i < 30; ++i) r.cases.push_back(one);
  const std::string text = render("github", r);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 10);
  EXPECT_THAT(text.substr(text.find('\n') + 1), HasSubstr("fail%3A conformance"));
}

TEST(Annotations, a_hard_failure_of_a_count_comes_before_marks_that_are_not_required) {
  RunResult r = sample::run(Variant::accept, 60.0);
  Check mark, count;
  mark.id = "mark", mark.required = false, mark.verdict = Verdict::marginal, mark.value = 1.0;
  mark.limit = {Limit::Kind::upper, 0.5, ""};
  count.id = "finite", count.required = true, count.verdict = Verdict::fail, count.value = 5.0;
  count.limit = {Limit::Kind::upper, 0.0, ""};
  r.checks.assign(12, mark);
  r.cases.front().checks.push_back(count);
  EXPECT_THAT(render("github", r), HasSubstr("fail%3A finite"));
}

TEST(Annotations, cannot_be_injected) {
  const std::string text = render("github", sample::hostile());
  std::istringstream lines(text);
  std::string line;
  while (std::getline(lines, line))
    EXPECT_THAT(line, testing::MatchesRegex("::(error|warning|notice) title=[^:]*::.*"));
}

TEST(Ratio, is_above_one_exactly_outside_the_limit) {
  Check c;
  c.limit = {Limit::Kind::upper, 0.0, ""};
  c.value = 5.0;
  EXPECT_EQ(ratio_to_limit(c), INFINITY);
  c.value = 0.0;
  EXPECT_TRUE(std::isnan(ratio_to_limit(c)));
  c.limit = {Limit::Kind::upper, 4.5, ""};
  c.value = 9.0;
  EXPECT_DOUBLE_EQ(ratio_to_limit(c), 2.0);
  c.limit = {Limit::Kind::lower, 10.0, ""};
  c.value = 20.0;
  EXPECT_DOUBLE_EQ(ratio_to_limit(c), 0.5);
  c.limit.kind = Limit::Kind::equal;
  EXPECT_TRUE(std::isnan(ratio_to_limit(c)));
  c.limit.kind = Limit::Kind::upper;
  c.value = std::nan("");
  EXPECT_TRUE(std::isnan(ratio_to_limit(c)));
}

TEST(Values, carry_their_uncertainty_or_say_that_there_is_none) {
  Check c;
  c.value = 6.1;
  c.u = 0.4;
  c.unit = "%";
  EXPECT_EQ(value_text(c, Glyphs::unicode), "6.1(4) %");
  c.u = std::nan("");
  EXPECT_EQ(value_text(c, Glyphs::unicode), "6.1 % (u n/a)");
  c.u = 0.0;
  EXPECT_EQ(value_text(c, Glyphs::unicode), "6.1 %");
  c.value = -0.5;
  c.unit = "1";
  EXPECT_EQ(value_text(c, Glyphs::ascii), "-0.5");
  EXPECT_EQ(value_text(c, Glyphs::unicode), "\u22120.5");
}

TEST(ConsoleView, leaves_notes_out_where_nobody_wants_them) {
  RunResult result = sample::run(Variant::accept, 60.0);
  result.notes = {"the older run is kept"};
  EXPECT_THAT(render_console(result, {}), HasSubstr("note: the older run is kept"));
  EXPECT_THAT(render_console(result, {.notes = false}), Not(HasSubstr("note: ")));
  EXPECT_THAT(render_console(result, {.notes = false}), HasSubstr("reproduce: "));
}

}  // namespace
}  // namespace forcegate
