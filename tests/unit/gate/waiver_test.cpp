#include "hil/gate/waiver.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "hil/gate/decision.h"

namespace forcegate {
namespace {

struct WaivedRun {
  std::vector<JudgedCheck> checks;
  std::vector<PlayedRecord> records;
  std::vector<JudgedCheck>& of_record() { return records[0].judged.checks; }
};

void apply_waivers(const std::vector<Waiver>& waivers, const std::string& today, WaivedRun& run,
                   std::vector<std::string>& notes) {
  forcegate::apply_waivers(waivers, today, run.checks, run.records, notes);
}

WaivedRun one_failure() {
  WaivedRun run;
  run.records.resize(1);
  JudgedCheck good, bad;
  good.check = {.id = "output_finite",
                .case_id = "sine/q50",
                .title = "Finite",
                .value = 0.0,
                .unit = "1",
                .limit = {Limit::Kind::upper, 0.0, "test"},
                .evidence = ""};
  good.check.verdict = Verdict::pass;
  bad.check = {.id = "mre_minima",
               .case_id = "sine/q50",
               .title = "Minima",
               .value = 9.0,
               .unit = "%",
               .limit = {Limit::Kind::upper, 7.5, "test"},
               .evidence = ""};
  bad.check.verdict = Verdict::fail;
  bad.check.blame = Blame::firmware;
  run.of_record() = {good, bad};
  return run;
}

Waiver waiver(const std::string& check) {
  return {"sine", "*", check, "A. Smith", "new film", "2026-12-31", "waivers.toml:2:1"};
}

Decision decision_of(WaivedRun& run) {
  std::vector<const Check*> all;
  for (const JudgedCheck* j : all_checks(run.checks, run.records)) all.push_back(&j->check);
  return decide(all, {}, {});
}

TEST(Waivers, a_waived_failure_is_shown_and_counted_and_no_pass) {
  WaivedRun run = one_failure();
  std::vector<std::string> notes;
  apply_waivers({waiver("mre_minima")}, "2026-11-21", run, notes);
  const Check& c = run.of_record()[1].check;
  EXPECT_EQ(c.verdict, Verdict::waived);
  EXPECT_NE(c.evidence.find("A. Smith"), std::string::npos);
  const Decision d = decision_of(run);
  EXPECT_EQ(d.kind, DecisionKind::accept);
  EXPECT_NE(d.reason.find("1 waived"), std::string::npos);
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_NE(notes[0].find("2026-11-21"), std::string::npos) << "the day is stated";
}

TEST(Waivers, the_last_day_still_holds_and_the_next_one_fails) {
  for (const auto& [today, kind] :
       {std::pair{"2026-12-31", DecisionKind::accept}, {"2027-01-01", DecisionKind::reject}}) {
    WaivedRun run = one_failure();
    std::vector<std::string> notes;
    apply_waivers({waiver("mre_minima")}, today, run, notes);
    EXPECT_EQ(decision_of(run).kind, kind) << today;
  }
}

TEST(Waivers, an_expired_one_fails_although_everything_passed) {
  WaivedRun run = one_failure();
  run.of_record().pop_back();
  std::vector<std::string> notes;
  apply_waivers({waiver("mre_minima")}, "2027-03-01", run, notes);
  const Decision d = decision_of(run);
  EXPECT_NE(d.kind, DecisionKind::accept);
  EXPECT_EQ(d.blame, Blame::user);
}

TEST(Waivers, an_expired_one_does_not_hide_what_the_build_fails_in) {
  WaivedRun run = one_failure();
  std::vector<std::string> notes;
  apply_waivers({waiver("mre_minima")}, "2027-03-01", run, notes);
  const Decision d = decision_of(run);
  EXPECT_EQ(d.kind, DecisionKind::reject);
  EXPECT_EQ(d.blame, Blame::firmware);
  EXPECT_EQ(d.reason.rfind("Minima 9 % > 7.5 %", 0), 0u) << d.reason;
  EXPECT_NE(d.reason.find("; besides, Waivers that are past their day: expired on 2026-12-31"), std::string::npos) << d.reason;
}

TEST(Waivers, quarantine_of_a_case_is_a_waiver_for_all_its_checks_but_never_for_the_rig) {
  WaivedRun run = one_failure();
  run.of_record()[0].check.verdict = Verdict::rig_error;
  std::vector<std::string> notes;
  apply_waivers({waiver("*")}, "2026-11-21", run, notes);
  EXPECT_EQ(run.of_record()[0].check.verdict, Verdict::rig_error);
  EXPECT_EQ(run.of_record()[1].check.verdict, Verdict::waived);
  EXPECT_EQ(decision_of(run).kind, DecisionKind::no_decision);
}

TEST(Waivers, one_that_meets_nothing_is_noted) {
  WaivedRun run = one_failure();
  std::vector<std::string> notes;
  apply_waivers({waiver("lag")}, "2026-11-21", run, notes);
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_NE(notes[0].find("remove it"), std::string::npos);
}

TEST(Waivers, when_all_is_waived_nothing_is_accepted) {
  WaivedRun run = one_failure();
  run.of_record().erase(run.of_record().begin());
  std::vector<std::string> notes;
  apply_waivers({waiver("*")}, "2026-11-21", run, notes);
  EXPECT_EQ(decision_of(run).kind, DecisionKind::no_decision);
}

TEST(Waivers, a_file_without_owner_reason_or_date_is_refused_with_its_line) {
  const auto path = std::filesystem::temp_directory_path() / "forcegate_waiver_test.toml";
  const auto read = [&](const std::string& body) {
    std::ofstream(path) << "format = 1\n[[waiver]]\n" << body;
    return read_waivers(path);
  };
  const std::string good =
      "case = \"sine\"\ncheck = \"lag\"\nowner = \"A\"\nreason = \"b\"\nexpires = \"2026-12-31\"\n";
  EXPECT_TRUE(read(good));
  EXPECT_FALSE(read("case = \"sine\"\ncheck = \"lag\"\nowner = \"A\"\nreason = \"b\"\n"));
  EXPECT_FALSE(
      read("case = \"sine\"\ncheck = \"lag\"\nowner = \"\"\nreason = \"b\"\nexpires = \"2026-12-31\"\n"));
  EXPECT_FALSE(
      read("case = \"*\"\ncheck = \"*\"\nowner = \"A\"\nreason = \"b\"\nexpires = \"2026-12-31\"\n"));
  const auto bad =
      read("case = \"s\"\ncheck = \"lag\"\nowner = \"A\"\nreason = \"b\"\nexpires = \"2026-02-30\"\n");
  ASSERT_FALSE(bad);
  EXPECT_NE(bad.error().where.find(":2"), std::string::npos) << bad.error().where;
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace forcegate
