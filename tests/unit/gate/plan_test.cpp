#include "hil/gate/plan.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "hil/base/read_file.h"

namespace forcegate {
namespace {

const std::string kGood = R"(format = 1
name = "small"
[panel]
specimens = ["q50"]
[calibration]
level = "static"
[[case]]
name = "a_sine"
stimulus = { name = "sine", f_Hz = 0.5, A_N = 1, m_N = 2, duration_s = 60 }
checks = ["accuracy"]
)";

std::string with(const std::string& from, const std::string& to) {
  std::string text = kGood;
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

Error error_of(const std::string& text) {
  const auto plan = parse_plan(text, "p.toml");
  EXPECT_FALSE(plan) << text;
  return plan ? Error{} : plan.error();
}

TEST(Plan, reads_what_it_says) {
  const auto plan = parse_plan(kGood, "p.toml");
  ASSERT_TRUE(plan) << plan.error().to_text();
  EXPECT_EQ(plan->cases.size(), 1u);
  EXPECT_EQ(plan->cases[0].checks, unsigned{kCheckAccuracy});
  EXPECT_EQ(plan->cases[0].controller, "open_loop");
  EXPECT_EQ(plan->sha256.size(), 64u);
}

TEST(Plan, refuses_an_unknown_key_with_position_and_suggestion) {
  const Error e = error_of(with("checks =", "cheks ="));
  EXPECT_EQ(e.code, ErrorCode::config);
  EXPECT_EQ(e.where, "p.toml:10:1");
  EXPECT_NE(e.hint.find("checks"), std::string::npos);
}

TEST(Plan, tells_a_misspelt_key_before_the_one_that_is_missing_for_it) {
  const Error e = error_of(with("checks = [\"accuracy\"]", "loop = \"closed\"\nchecks = [\"promise\"]\nmaxima_ptc = 4.5\nminima_pct = 7.5\nlimit_source = \"ours\""));
  EXPECT_EQ(e.where, "p.toml:12:1");
  EXPECT_NE(e.text.find("'maxima_ptc'"), std::string::npos) << e.text;
  EXPECT_NE(e.hint.find("maxima_pct"), std::string::npos) << e.hint;
}

TEST(Plan, names_the_stimulus_parameter_that_is_wrong) {
  EXPECT_NE(error_of(with("A_N = 1,", "A_N = -1,")).text.find("A_N"), std::string::npos);
  EXPECT_NE(error_of(with("f_Hz", "f_hz")).hint.find("f_Hz"), std::string::npos);
  EXPECT_NE(error_of(with("\"sine\"", "\"sin\"")).hint.find("sine"), std::string::npos);
}

TEST(Plan, says_how_to_mend_what_it_refuses) {
  std::string many = "specimens = [";
  for (int i = 0; i < 1001; ++i) many += "\"s" + std::to_string(i) + "\",";
  for (const auto& [text, hint] : {std::pair{with("\"small\"", "\"sm/all\""), "letters, digits"}, {with("[\"q50\"]", "[]"), "specimens = [\"q50\"]"},
                                   {with("specimens = [\"q50\"", many), "the panel"}, {with("f_Hz = 0.5", "f_Hz = true"), "a number"},
                                   {with("[calibration]", "[calibration]\nsweep_s = \"60\""), "leave the quotes out: sweep_s = 60"},
                                   {with("name = \"sine\"", "name = 1"), "name = \"sine\""}, {with("level = \"static\"", "level = 1"), "write level = \"...\""}})
    EXPECT_NE(error_of(text).hint.find(hint), std::string::npos) << hint << "\n" << error_of(text).to_text();
}

TEST(Plan, refuses_two_cases_of_one_name) {
  EXPECT_NE(error_of(kGood + kGood.substr(kGood.find("[[case]]"))).text.find("two cases"), std::string::npos);
}

TEST(Plan, refuses_a_limit_without_its_source) {
  EXPECT_NE(error_of(kGood + "maxima_pct = 5\n").hint.find("limit_source"), std::string::npos);
}

TEST(Plan, refuses_an_output_limit_that_nothing_passes) {
  EXPECT_NE(error_of(kGood + "[limits]\noutput_max_N = 0\n").text.find("passes no firmware"), std::string::npos);
  EXPECT_TRUE(parse_plan(kGood + "[limits]\noutput_max_N = 8\n", "p.toml"));
}

TEST(Plan, refuses_the_promise_in_open_loop) {
  EXPECT_NE(error_of(with("[\"accuracy\"]", "[\"promise\"]")).text.find("closed loop"), std::string::npos);
}

TEST(Plan, refuses_to_average_an_extremum_over_much_of_its_period) {
  EXPECT_NE(error_of(with("checks = [", "half_width_ms = 300\nchecks = [")).text.find("half_width_ms"), std::string::npos);
  EXPECT_TRUE(parse_plan(with("checks = [", "half_width_ms = 60\nchecks = ["), "p.toml"));
}

TEST(Plan, needs_a_record_to_identify_a_specimen) {
  EXPECT_NE(error_of(with("\"static\"", "\"identified\"")).text.find("identification"), std::string::npos);
}

TEST(Plan, refuses_a_force_at_which_a_record_is_stopped) {
  const std::string limit = kGood + "[safety]\nforce_max_N = ";
  const Error profile = error_of(with("A_N = 1, m_N = 2", "A_N = 2, m_N = 3.2"));
  EXPECT_EQ(profile.where, "p.toml:9:1") << "5 N without [safety]";
  EXPECT_NE(profile.text.find("5.2 N"), std::string::npos) << profile.text;
  const Error sweep = error_of(limit + "3.5\n");
  EXPECT_NE(sweep.text.find("sweep"), std::string::npos) << sweep.text;
  EXPECT_EQ(sweep.where, "p.toml:5:2");
  EXPECT_TRUE(parse_plan(limit + "4.1\n", "p.toml"));
  std::string nominal = limit + "3.5\n";
  nominal.replace(nominal.find("static"), 6, "nominal");
  EXPECT_TRUE(parse_plan(nominal, "p.toml")) << "sweeps that nobody plays";
}

TEST(Plan, refuses_a_controller_that_contradicts_the_loop_or_that_nobody_has) {
  const Error force = error_of(kGood + "controller = \"force_integral\"\n");
  EXPECT_EQ(force.where, "p.toml:11:1");
  EXPECT_NE(force.text.find("the loop is open"), std::string::npos) << force.text;
  EXPECT_NE(error_of(kGood + "loop = \"closed\"\ncontroller = \"open_loop\"\n").text.find("the loop is closed"), std::string::npos);
  EXPECT_NE(error_of(kGood + "controller = \"open_lop\"\n").hint.find("open_loop"), std::string::npos);
  EXPECT_TRUE(parse_plan(kGood + "loop = \"closed\"\ncontroller = \"force_integral\"\n", "p.toml"));
}

TEST(Plan, refuses_names_that_are_paths) {
  error_of(with("\"a_sine\"", "\"../x\""));
  error_of(with("\"a_sine\"", "\"\""));
}

TEST(Plan, refuses_a_newer_format) { error_of(with("format = 1", "format = 2")); }

TEST(Plan, all_committed_plans_are_good) {
  int n = 0;
  for (const auto& entry : std::filesystem::directory_iterator(FORCEGATE_SOURCE_DIR "/ci/plans")) {
    if (entry.path().extension() != ".toml") continue;
    const auto plan = read_plan(entry.path());
    if (entry.path().stem() == "smoke" || entry.path().stem() == "nightly" ||
        entry.path().stem() == "bench" || entry.path().stem() == "replay") {
      EXPECT_TRUE(plan) << plan.error().to_text();
      ++n;
    }
  }
  EXPECT_EQ(n, 4);
}

TEST(Plan, the_page_of_plans_names_every_committed_plan) {
  const auto page = read_file(FORCEGATE_SOURCE_DIR "/docs/plan.md");
  ASSERT_TRUE(page) << page.error().to_text();
  for (const auto& entry : std::filesystem::directory_iterator(FORCEGATE_SOURCE_DIR "/ci/plans"))
    if (entry.path().extension() == ".toml") {
      EXPECT_NE(page->find("`" + entry.path().stem().string() + "`"), std::string::npos) << entry.path();
    }
}

TEST(Plan, nightly_holds_the_paper_s_twenty_sines_and_a_panel_of_nine) {
  const auto plan = read_plan(FORCEGATE_SOURCE_DIR "/ci/plans/nightly.toml");
  ASSERT_TRUE(plan);
  EXPECT_GE(plan->panel.size(), 9u);
  int sines = 0, closed = 0;
  for (const PlanCase& c : plan->cases) {
    sines += c.source == "Lebosse 2011, Table II";
    closed += c.loop == LoopMode::closed && c.checks & kCheckPromise;
  }
  EXPECT_EQ(sines, 20);
  EXPECT_EQ(closed, 2);
}

}  // namespace
}  // namespace forcegate
