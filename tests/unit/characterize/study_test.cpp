// A study as a whole: plans are read strictly, the answer does not depend on the threads, the panel lies in the windows
// of the paper, limits are kept or broken, golden traces hold.

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "golden/compare/tube.h"
#include "hil/report/characterization/golden_traces.h"
#include "hil/report/characterization/paper_claims.h"
#include "hil/report/characterization/study_json.h"
#include "tests/unit/characterize/study.h"

namespace forcegate::test {
namespace {

using namespace characterize;

std::string read(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return std::move(text).str();
}

std::string minimal(const std::string& more) {
  return "format = 1\nkind = \"characterize\"\nname = \"x\"\n[population]\nspecimens = [\"q50\"]\nsessions = 1\n[procedures]\nflexiforce = [\"static_calibration\"]\n" +
         more;
}

TEST(StudyPlan, names_the_place_of_a_mistake_and_how_to_mend_it) {
  ASSERT_TRUE(parse_study_plan(minimal(""), "p.toml").has_value());
  const auto misspelt = parse_study_plan(minimal("[profiles]\nrecord = 5\n"), "p.toml");
  ASSERT_FALSE(misspelt.has_value());
  EXPECT_EQ(misspelt.error().code, ErrorCode::config);
  EXPECT_NE(misspelt.error().where.find("p.toml:10"), std::string::npos) << misspelt.error().where;
  std::string unknown = minimal("");
  unknown.replace(unknown.find("static_calibration"), 18, "static_calibartion");
  const auto procedure = parse_study_plan(unknown, "p.toml");
  ASSERT_FALSE(procedure.has_value());
  EXPECT_NE(procedure.error().hint.find("static_calibration"), std::string::npos) << procedure.error().hint;
  for (const char* bad :
       {"[harmonic]\nf_Hz = [1]\nA_N = [1, 2]\nm_N = [3]\n", "[harmonic]\nf_Hz = [1]\nA_N = [2]\nm_N = [1]\n",
        "[[limit]]\nkey = \"x\"\nsource = \"y\"\n", "[profiles]\nrecord_s = \"long\"\n",
        "[profiles]\nrecovery_s = [0]\n"})
    EXPECT_FALSE(parse_study_plan(minimal(bad), "p.toml").has_value()) << bad;
  EXPECT_FALSE(parse_study_plan("format = 1\nkind = \"gate\"\nname = \"x\"\n", "p.toml").has_value());
}

StudyPlan short_plan() {
  StudyPlan plan = plan_of_the_paper();
  plan.specimens = {"seed:3", "seed:4"};
  plan.identification = {"seed:3"};
  plan.sessions = 2;
  plan.exemplar.clear();
  plan.record_s = 120.0;
  plan.harmonic = {{0.5, 1.5, 2.7}, {1.0, 0.8, 2.4}, {2.0, 1.2, 2.4}};
  plan.flexiforce = {"static_calibration", "step_response", "harmonic_series", "rest_drift"};
  plan.fsr = {"static_calibration", "erratic_maxima"};
  return plan;
}

TEST(Study, gives_the_same_bytes_whatever_the_number_of_threads) {
  StudyRequest request = request_of(short_plan(), {"flexiforce", "fsr"});
  request.threads = 1;
  const std::string one = study_json(run(request), request.plan);
  request.threads = 3;
  EXPECT_EQ(study_json(run(request), request.plan), one);
  EXPECT_NE(one.find("\"static.gain\""), std::string::npos);
}

TEST(Study, says_what_a_rig_did_and_keeps_the_failed_session_out_of_the_statistics) {
  StudyPlan plan = short_plan();
  plan.specimens = {"seed:3", "no-such-specimen"};
  plan.flexiforce = {"static_calibration"};
  const auto studies = run(request_of(plan, {"flexiforce"}));
  ASSERT_EQ(studies[0].sheets.size(), 4U);
  EXPECT_FALSE(studies[0].sheets[0].failure.has_value());
  ASSERT_TRUE(studies[0].sheets[2].failure.has_value());
  EXPECT_NE(studies[0].sheets[2].failure->text.find("no-such-specimen"), std::string::npos);
  EXPECT_EQ(studies[0].find("static.gain")->specimens, 1U);
}

TEST(Study, refuses_a_procedure_that_needs_a_calibration_before_there_is_one) {
  StudyPlan plan = short_plan();
  plan.flexiforce = {"rest_drift", "static_calibration"};
  const auto studies = run(request_of(plan, {"flexiforce"}));
  ASSERT_TRUE(studies[0].sheets[0].failure.has_value());
  EXPECT_NE(studies[0].sheets[0].failure->hint.find("static_calibration"), std::string::npos);
}

TEST(Study, limits_are_judged_on_the_worst_session_and_a_quantity_that_nobody_measured_is_not_kept) {
  StudyPlan plan = short_plan();
  plan.flexiforce = {"static_calibration"};
  plan.limits = {{"static.linearity", -INFINITY, 3.0, "maker"},
                 {"static.gain", 10.0, INFINITY, "absurd"},
                 {"static.nothing", 0.0, 1.0, "x"}};
  const auto results = check_limits(run(request_of(plan, {"flexiforce"})), plan);
  ASSERT_EQ(results.size(), 3U);
  EXPECT_TRUE(results[0].kept);
  EXPECT_EQ(results[0].sessions, 4U);
  EXPECT_FALSE(results[1].kept);
  EXPECT_EQ(results[1].outside, 4U);
  EXPECT_FALSE(results[2].kept);
}

TEST(Study, a_limit_on_what_is_measured_once_asks_the_session_that_measured_it) {
  StudyPlan plan = short_plan();
  plan.flexiforce = {"static_calibration", "step_response"};
  plan.once = {"step_response"};
  plan.sessions = 2;
  const auto studies = run(request_of(plan, {"flexiforce"}));
  const auto& values = studies[0].sheets[0].values;
  const auto step = std::ranges::find_if(values, [](const Measurement& m) { return m.key.starts_with("step."); });
  ASSERT_NE(step, values.end());
  plan.limits = {{step->key, -INFINITY, INFINITY, "all"}, {"static.linearity", -INFINITY, INFINITY, "all"}};
  const auto results = check_limits(studies, plan);
  ASSERT_EQ(results.size(), 2U);
  EXPECT_TRUE(results[0].kept);
  EXPECT_EQ(results[0].outside, 0U);
  EXPECT_EQ(2 * results[0].sessions, results[1].sessions);
}

// Every figure of the paper that has a window, on part of the fixed panel; the whole population is in docs/paper.md.
TEST(Study, of_panel_specimens_lies_in_every_window_of_the_paper) {
  StudyPlan plan = plan_of_the_paper();
  plan.specimens = {"q15", "q50", "q85"};
  plan.identification = {"q15", "q50"};
  plan.sessions = 1;
  plan.exemplar.clear();
  plan.recovery_s = {300.0, 7200.0};
  std::erase_if(plan.flexiforce,
                [](const std::string& name) { return name == "two_sines" || name == "validation_sines"; });
  const auto studies = run(request_of(plan, {"flexiforce", "fsr"}));
  std::size_t windows = 0;
  for (const PaperClaim& c : compare_with_paper(studies)) {
    if (!c.low && !c.high) continue;
    ++windows;
    ASSERT_TRUE(std::isfinite(c.ours)) << c.subject;
    EXPECT_TRUE(c.inside()) << c.place << " " << c.sensor << " " << c.subject << ": " << c.ours << " "
                            << c.unit << " (" << c.paper << ")";
  }
  EXPECT_GE(windows, 20U);
}

TEST(GoldenTraces, of_the_paper_are_those_of_the_rig) {
  const std::filesystem::path folder = FORCEGATE_SOURCE_DIR "/golden/traces/paper";
  StudyPlan plan = plan_of_the_paper();
  plan.specimens.clear();
  const auto studies = run(request_of(plan, {"flexiforce", "fsr"}));
  std::size_t compared = 0;
  for (const SensorStudy& study : studies)
    for (const GoldenTrace& now : golden_traces(study, plan)) {
      const std::filesystem::path path = folder / (now.name + ".csv");
      ASSERT_TRUE(std::filesystem::exists(path))
          << path << " is missing: forcegate characterize --golden golden/traces/paper";
      const GoldenTrace golden = value_or_abort(parse_golden(read(path), path.string()));
      ASSERT_EQ(golden.curve.columns, now.curve.columns) << now.name;
      EXPECT_EQ(golden.provenance, now.provenance) << now.name;
      for (std::size_t k = 1; k < golden.curve.data.size(); ++k) {
        const auto tube = value_or_abort(compare_tube(
            {0.0, 1.0, golden.curve.data[k]}, {0.0, 1.0, now.curve.data[k]},
            {.absolute = golden.absolute, .relative = golden.relative, .lag_limit_s = INFINITY}));
        EXPECT_EQ(tube.state, TubeState::inside) << now.name << " " << golden.curve.columns[k] << ": "
                                                 << tube.cause << ", worst margin " << tube.worst_margin;
      }
      ++compared;
    }
  const auto files = static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder), {}));
  EXPECT_EQ(compared, files);
  EXPECT_GE(compared, 60U);
}

TEST(GoldenTraces, are_read_as_they_were_written_and_damage_is_named_by_line) {
  GoldenTrace g;
  g.name = "x";
  g.unit = "V";
  g.absolute = 0.01;
  g.relative = 0.002;
  g.provenance = {{"plan", "p"}};
  g.curve = {"x", {"t_s", "maximum"}, {{0.5F, 1.0F}, {2.25F, 3.5F}}};
  const std::string text = golden_text(g);
  const GoldenTrace back = value_or_abort(parse_golden(text, "x.csv"));
  EXPECT_EQ(golden_text(back), text);
  EXPECT_EQ(back.curve.data, g.curve.data);
  const auto cut = parse_golden(text.substr(0, text.size() - 8), "x.csv");
  ASSERT_FALSE(cut.has_value());
  EXPECT_NE(cut.error().where.find("x.csv:"), std::string::npos);
  for (const char* bad :
       {"", "t_s,maximum\n1,2\n", "# format = 2\n", "# name = \"x\"\nt_s,v\n1,nan\n", "# absolute = -1\n"})
    EXPECT_FALSE(parse_golden(bad, "x.csv").has_value()) << bad;
}

TEST(Tms, force_on_a_moving_head_stays_below_5_newtons_and_the_head_really_leaves) {
  StudyPlan plan = value_or_abort(read_study_plan(FORCEGATE_SOURCE_DIR "/ci/plans/tms.toml"));
  plan.exemplar.clear();
  const auto results = check_limits(run(request_of(plan, {"fsr"})), plan);
  ASSERT_EQ(results.size(), plan.limits.size());
  for (const LimitResult& r : results)
    EXPECT_TRUE(r.kept) << r.title << ": worst " << r.worst << " " << r.unit << " (" << r.specimen << ")";
}

}  // namespace
}  // namespace forcegate::test
