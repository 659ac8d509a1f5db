#include "hil/app/power/power_gatings.h"

#include <gtest/gtest.h>

#include <fstream>

#include "adapters/transport/private_folder.h"
#include "hil/app/power/power.h"

namespace forcegate {
namespace {

TEST(PowerGatings, a_gating_comes_out_of_its_line_as_it_went_in) {
  Gated g;
  g.kind = DecisionKind::reject;
  g.failed = {"conformance", "promise_maxima"};
  g.conformance_known = true;
  g.blind = DecisionKind::accept;
  g.reason = "maxima \"53 %\"";
  const auto back = gated_from_json(to_json_line("power/1/x", g));
  ASSERT_TRUE(back) << back.error().to_text();
  EXPECT_EQ(back->kind, g.kind);
  EXPECT_EQ(back->failed, g.failed);
  EXPECT_EQ(back->conformance_known, g.conformance_known);
  EXPECT_EQ(back->blind, g.blind);
  EXPECT_EQ(back->reason, g.reason);
}

TEST(PowerGatings, a_line_that_is_no_gating_is_refused) {
  for (const char* line :
       {"", "[]", "{}",
        R"({"kind":"MAYBE","failed":[],"conformance_known":true,"blind":"ACCEPT","reason":""})",
        R"({"kind":"ACCEPT","failed":1,"conformance_known":true,"blind":"ACCEPT","reason":""})"})
    EXPECT_FALSE(gated_from_json(line)) << line;
}

TEST(ResumeJournal, goes_on_where_it_stopped_and_drops_a_line_cut_short) {
  auto folder = PrivateFolder::make();
  ASSERT_TRUE(folder);
  const auto path = folder->path() / "journal.jsonl";
  {
    auto journal = ResumeJournal::open(path, R"({"job":1})");
    ASSERT_TRUE(journal) << journal.error().to_text();
    journal->keep(R"({"id":"a","x":1})");
    journal->keep(R"({"id":"b","x":2})");
    EXPECT_TRUE(journal->status());
  }
  std::filesystem::resize_file(path, std::filesystem::file_size(path) - 5);
  auto again = ResumeJournal::open(path, R"({"job":1})");
  ASSERT_TRUE(again) << again.error().to_text();
  ASSERT_NE(again->find("a"), nullptr);
  EXPECT_EQ(*again->find("a"), R"({"id":"a","x":1})");
  EXPECT_EQ(again->find("b"), nullptr);
  again->keep(R"({"id":"b","x":3})");
  auto third = ResumeJournal::open(path, R"({"job":1})");
  ASSERT_TRUE(third);
  ASSERT_NE(third->find("b"), nullptr);
  EXPECT_NE(third->find("b")->find("3"), std::string::npos);
}

TEST(ResumeJournal, of_another_job_is_refused_with_the_way_out) {
  auto folder = PrivateFolder::make();
  ASSERT_TRUE(folder);
  const auto path = folder->path() / "journal.jsonl";
  ASSERT_TRUE(ResumeJournal::open(path, R"({"job":1})"));
  const auto other = ResumeJournal::open(path, R"({"job":2})");
  ASSERT_FALSE(other);
  EXPECT_EQ(other.error().code, ErrorCode::config);
  EXPECT_FALSE(other.error().hint.empty());
}

TEST(ResumeJournal, of_a_file_that_is_none_is_refused_and_leaves_it) {
  auto folder = PrivateFolder::make();
  ASSERT_TRUE(folder);
  const auto path = folder->path() / "recording.csv";
  for (const char* text : {"t_s,F_ref_N\n0,1\n", "a line without its end"}) {
    std::ofstream(path) << text;
    const auto none = ResumeJournal::open(path, R"({"job":1})");
    ASSERT_FALSE(none) << text;
    EXPECT_EQ(none.error().text, "this file is no journal");
    std::ifstream kept(path);
    EXPECT_EQ(std::string(std::istreambuf_iterator<char>(kept), {}), text);
  }
  std::ofstream(path) << R"({"jo)";  // cut short in its first line
  EXPECT_TRUE(ResumeJournal::open(path, R"({"job":1})"));
}

MutantOutcome level_of(double level, std::size_t rejected) {
  MutantOutcome o;
  o.mutant.name = "gain_pct";
  o.mutant.family = "gain_pct";
  o.mutant.unit = "%";
  o.mutant.level = level;
  o.mutant.seen_by = {"conformance"};
  o.runs = 20;
  o.rejected = rejected;
  o.accepted = 20 - rejected;
  return o;
}

TEST(Power, the_smallest_defect_found_is_the_level_from_which_on_19_of_20_are_rejected) {
  PowerResult r;
  r.outcomes = {level_of(0.1, 20), level_of(1, 10), level_of(2, 19), level_of(5, 20)};
  const auto families = r.families();
  ASSERT_EQ(families.size(), 1u);
  EXPECT_EQ(families[0].smallest, 2.0);
  const std::string page = power_markdown(r);
  EXPECT_NE(page.find("| 2 % | 1/20 [0.1, 24.9] % |"), std::string::npos) << page;
  EXPECT_NE(page.find("0.1: 20, 1: 10, 2: 19, 5: 20"), std::string::npos) << page;
}

TEST(Power, a_mutant_without_a_run_is_not_accepted) {
  PowerResult r;
  r.outcomes = {level_of(5, 20)};
  EXPECT_FALSE(r.nothing_played());
  r.outcomes.back().runs = r.outcomes.back().rejected = 0;
  EXPECT_TRUE(r.nothing_played());
  EXPECT_NE(power_text(r).find("not played"), std::string::npos) << power_text(r);
  EXPECT_EQ(power_text(r).find("accepted 0x"), std::string::npos);
}

TEST(Power, the_page_names_the_command_that_makes_it_again) {
  PowerResult r;
  EXPECT_NE(power_markdown(r).find(" --markdown docs/power.md`;"), std::string::npos) << power_markdown(r);
  r.request.only = {"gain_pct"};
  r.request.quick = true;
  r.request.firmware = "other/firmware";
  r.request.markdown = "mine.md";
  EXPECT_NE(power_markdown(r).find(" --mutant gain_pct --quick --firmware other/firmware --markdown mine.md`;"), std::string::npos) << power_markdown(r);
}

TEST(Power, what_was_never_played_is_no_good_gate) {
  PowerResult r;
  r.outcomes = {level_of(5, 20)};
  EXPECT_TRUE(r.good());
  r.outcomes.push_back(level_of(10, 0));
  r.outcomes.back().runs = r.outcomes.back().accepted = 0;
  EXPECT_FALSE(r.good()) << "there, and played on no case";
  r.request.mutant_seeds = r.request.family_seeds = 0;
  EXPECT_TRUE(r.good()) << "no run of it was asked for";
  r.request.seeds = r.request.panel_seeds = 0;
  EXPECT_FALSE(r.good()) << "nor of any other image";
  PowerResult none;
  none.not_built = {"gain_pct@1"};
  EXPECT_TRUE(none.nothing_built());
  EXPECT_FALSE(none.good());
}

}  // namespace
}  // namespace forcegate
