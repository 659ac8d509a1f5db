#include "hil/app/play/worker.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "hil/app/gate/run_folder.h"
#include "hil/gate/case_json.h"
#include "hil/gate/decision.h"
#include "hil/gate/judge.h"
#include "hil/interface/comparator.h"
#include "hil/interface/firmware_guard.h"
#include "hil/interface/reporter.h"
#include "tests/support/fake_dut.h"
#include "tests/support/fake_rig.h"

namespace forcegate {
namespace {

namespace fs = std::filesystem;

// Misbehaves at sample 30000 in the way its image's name says.
class EvilDut : public testing::FakeDut {
 public:
  Result<DutInfo> open(const DutSession& session) override {
    how_ = session.image.filename().string();
    FORCEGATE_TRY(DutInfo info, FakeDut::open(session));
    if (how_ == "known_twice") info.algorithm_id = "twice/1";
    return info;
  }
  Result<void> process(std::uint32_t first_index, std::span<const std::uint16_t> adc,
                       std::span<float> force_N, std::span<std::uint8_t> flags) override {
    if (first_index >= 30000) {
      if (how_ == "segv_outside") std::raise(SIGSEGV);
      if (how_ == "throw_outside") throw std::runtime_error("a defect of ours");
      const InFirmware inside(first_index);
      if (how_ == "segv") std::raise(SIGSEGV);
      if (how_ == "abort") std::abort();
      if (how_ == "throw") throw 42;
      if (how_ == "exit") std::exit(3);
      if (how_ == "loop")
        for (volatile bool forever = true; forever;) {
        }
    }
    return FakeDut::process(first_index, adc, force_N, flags);
  }

 private:
  std::string how_;
};

const Registration<LaneKind> kLane{
    {"evil", "for tests", [](const fs::path&) { return true; },
     [](const std::map<std::string, std::string>&) -> Result<std::unique_ptr<Dut>> {
       return std::make_unique<EvilDut>();
     }}};
const Registration<RigKind> kRig{
    {"fake", "for tests", [](const std::map<std::string, std::string>&) -> Result<std::unique_ptr<Rig>> {
       return std::make_unique<testing::FakeRig>();
     }}};
const Registration<ReporterKind> kReporter{
    {"json", "result.json", "for tests", [](const RunResult&) { return std::string("{}"); }}};

/// Says who it is and compares nothing.
class Named final : public Comparator {
 public:
  explicit Named(std::string name) : name_(std::move(name)) {}
  Result<void> begin(const ComparatorSession&) override { return {}; }
  void push(std::span<const std::uint16_t>, std::span<const float>, std::span<const std::uint8_t>) override {}
  Comparison finish() override { return {.limit = 1.0, .limit_source = {}, .evidence = name_}; }

 private:
  std::string name_;
};
ComparatorKind named(const std::string& name) {
  return {name, "for tests", [](std::string_view id) { return id == "twice/1"; },
          [name] { return std::unique_ptr<Comparator>(std::make_unique<Named>(name)); }};
}
const Registration<ComparatorKind> kSecond{named("second")}, kFirst{named("first")};

CaseJob job(const std::string& how) {
  CaseJob j;
  j.id = how;
  j.rig = "fake";
  j.lane = "evil";
  j.image = "/images/" + how;
  j.planned.name = how;
  j.planned.controller = "open_loop";
  j.planned.stimulus.name = "sine";
  j.planned.stimulus.numbers = {
      {"f_Hz", 0.5}, {"A_N", 1.0}, {"m_N", 2.0}, {"duration_s", 60.0}, {"ramp_s", 2.0}};
  j.calibration.offset_N = 0.1;
  return j;
}

CaseFailure failure_of(const std::string& how) {
  WorkerOptions options;
  options.workers = 1;
  options.hang_cpu_s = 0.3;
  const auto records = run_in_workers({job(how)}, options);
  EXPECT_EQ(records.size(), 1u);
  EXPECT_EQ(records[0].id, how);
  EXPECT_TRUE(records[0].failure) << how;
  return records[0].failure.value_or(CaseFailure{});
}

TEST(Worker, a_crash_inside_the_firmware_is_the_firmware_s_with_signal_and_sample) {
  const CaseFailure f = failure_of("segv");
  EXPECT_EQ(f.stage, CaseFailure::Stage::firmware);
  EXPECT_EQ(f.error.code, ErrorCode::firmware);
  EXPECT_NE(f.error.text.find("SEGV"), std::string::npos) << f.error.text;
  EXPECT_NE(f.error.text.find("32720"), std::string::npos)
      << f.error.text;  // first block that begins after 30000
  EXPECT_NE(failure_of("abort").error.text.find("ABRT"), std::string::npos);
  EXPECT_NE(failure_of("exit").error.text.find("exit code 3"), std::string::npos);
}

TEST(Worker, a_crash_leaves_who_crashed) {
  WorkerOptions options;
  options.workers = 1;
  const auto records = run_in_workers({job("segv")}, options);
  ASSERT_EQ(records.size(), 1u);
  EXPECT_EQ(records[0].firmware.board, "fake");
  EXPECT_EQ(records[0].firmware.algorithm_id, "static/1");
  EXPECT_EQ(records[0].firmware.protocol_major, 1);
  EXPECT_EQ(records[0].firmware.adc_bits, 16);
  EXPECT_EQ(records[0].firmware.rate_Hz, 1000.0);
}

TEST(Worker, a_crash_outside_the_firmware_is_ours) {
  const CaseFailure f = failure_of("segv_outside");
  EXPECT_EQ(f.stage, CaseFailure::Stage::harness);
  EXPECT_EQ(f.error.code, ErrorCode::internal);
}

TEST(Worker, an_exception_ends_the_record_like_a_crash_and_is_never_an_acceptance) {
  EXPECT_EQ(failure_of("throw_outside").stage, CaseFailure::Stage::harness);
  EXPECT_EQ(failure_of("throw_outside").error.code, ErrorCode::internal);
  for (const char* how : {"throw", "throw_outside", "segv", "segv_outside", "exit", "loop"}) {
    CaseRecord record;
    record.id = how;
    record.failure = failure_of(how);
    Plan plan;
    PlanCase planned = job(how).planned;
    planned.checks = kCheckConformance | kCheckAccuracy;
    const JudgedCase judged = judge_case(plan, planned, record, {});
    std::vector<const Check*> checks;
    for (const JudgedCheck& j : judged.checks) checks.push_back(&j.check);
    RunEvents events;
    events.harness_error = judged.harness_error;
    EXPECT_NE(decide(checks, plan.rule, events).kind, DecisionKind::accept) << how;
  }
}

TEST(Worker, an_endless_loop_is_ended_and_charged_to_the_firmware) {
  const CaseFailure f = failure_of("loop");
  EXPECT_EQ(f.stage, CaseFailure::Stage::firmware);
  EXPECT_NE(f.error.text.find("endless loop"), std::string::npos) << f.error.text;
}

TEST(Worker, records_that_a_hung_image_leaves_out_are_not_run_and_accept_nothing) {
  WorkerOptions options;
  options.workers = 1;
  options.hang_cpu_s = 0.3;
  const auto records = run_in_workers({job("loop"), job("loop"), job("good")}, options);
  ASSERT_TRUE(records[1].failure);
  const JudgedCase judged = judge_case(Plan{}, job("loop").planned, records[1], {});
  ASSERT_EQ(judged.checks.size(), 1u);
  EXPECT_FALSE(judged.harness_error);
  EXPECT_EQ(judged.checks[0].check.verdict, Verdict::not_run);
  EXPECT_EQ(judged.checks[0].check.blame, Blame::firmware);
  EXPECT_FALSE(records[2].failure) << "another image";
}

TEST(Worker, one_bad_record_does_not_end_the_others_and_order_is_that_of_the_jobs) {
  std::vector<CaseJob> jobs{job("good_1"), job("segv"), job("good_2"), job("abort"), job("good_3")};
  std::vector<std::string> first;
  for (const unsigned workers : {1u, 2u, 5u}) {
    WorkerOptions options;
    options.workers = workers;
    const auto records = run_in_workers(jobs, options);
    std::vector<std::string> texts;
    for (const CaseRecord& r : records) texts.push_back(to_json(r));
    ASSERT_EQ(records.size(), 5u);
    for (std::size_t i = 0; i < jobs.size(); ++i) {
      EXPECT_EQ(records[i].id, jobs[i].id);
      EXPECT_EQ(records[i].failure.has_value(), i % 2 == 1);
    }
    if (first.empty()) first = texts;
    EXPECT_EQ(texts, first) << workers << " workers";
  }
}

TEST(Worker, makes_a_record_from_a_job_in_text_form) {
  const auto text = execute_job_text(to_json(job("good")));
  ASSERT_TRUE(text);
  const auto record = record_from_json(*text);
  ASSERT_TRUE(record);
  EXPECT_EQ(record->samples, 60000u);
  EXPECT_FALSE(execute_job_text("not a job"));
}

TEST(Worker, compares_with_the_first_that_knows_the_algorithm_as_a_later_check_does) {
  CaseJob twice = job("known_twice");
  twice.planned.checks |= kCheckConformance;
  const CaseRecord record = execute_job(twice);
  ASSERT_FALSE(record.failure) << record.failure->error.to_text();
  EXPECT_EQ(record.conformance_evidence, "first");
  ASSERT_NE(comparator_of("twice/1"), nullptr);
  EXPECT_EQ(comparator_of("twice/1")->name, "first");
  EXPECT_EQ(comparator_of("unknown/1"), nullptr);
}

TEST(Worker, stops_when_it_is_told_to) {
  std::atomic<bool> cancelled{true};
  WorkerOptions options;
  options.cancelled = &cancelled;
  const auto records = run_in_workers({job("good"), job("good")}, options);
  for (const CaseRecord& r : records) {
    ASSERT_TRUE(r.failure);
    EXPECT_EQ(r.failure->error.code, ErrorCode::cancelled);
  }
}

struct Folder {
  fs::path root = fs::temp_directory_path() / ("forcegate_run_folder_" + std::to_string(getpid()));
  Folder() { fs::create_directories(root); }
  ~Folder() { fs::remove_all(root); }
};

TEST(RunFolder, has_its_name_only_when_it_is_complete) {
  Folder f;
  auto folder = RunFolder::open(f.root / "run");
  ASSERT_TRUE(folder);
  EXPECT_FALSE(fs::exists(f.root / "run"));
  ASSERT_TRUE(folder->publish({}));
  EXPECT_TRUE(fs::exists(f.root / "run" / "result.json"));
}

TEST(RunFolder, removes_an_older_result_before_the_run) {
  Folder f;
  ASSERT_TRUE(RunFolder::open(f.root / "run")->publish({}));
  auto folder = RunFolder::open(f.root / "run");
  ASSERT_TRUE(folder);
  EXPECT_FALSE(fs::exists(f.root / "run" / "result.json")) << "it could be taken for the result of this run";
}

TEST(RunFolder, an_older_run_is_gone_when_the_newer_one_is_there_and_not_before) {
  Folder f;
  const fs::path run = f.root / "run", aside = f.root / ("run.older-" + std::to_string(getpid()));
  ASSERT_TRUE(RunFolder::open(run)->publish({}));
  {
    auto interrupted = RunFolder::open(run);
    ASSERT_TRUE(interrupted);
    EXPECT_EQ(interrupted->older(), aside);
    EXPECT_FALSE(interrupted->older_stays());
  }
  EXPECT_TRUE(fs::exists(run / "result.json")) << "Ctrl-C: nothing took its name";
  EXPECT_FALSE(fs::exists(aside));
  ASSERT_TRUE(RunFolder::open(run)->publish({}));
  EXPECT_TRUE(fs::exists(run / "result.json"));
  EXPECT_FALSE(fs::exists(aside));
  // of a bench: nobody plays it again
  RunResult of_bench;
  of_bench.rig.name = "bench";
  {
    auto folder = RunFolder::open(run);
    ASSERT_TRUE(folder);
    fs::create_directories(folder->path() / "traces");
    std::ofstream(folder->path() / "traces" / "a.h5") << "x";
    ASSERT_TRUE(folder->publish(of_bench));
  }
  auto next = RunFolder::open(run);
  ASSERT_TRUE(next);
  EXPECT_TRUE(next->older_stays());
  ASSERT_TRUE(next->publish({}));
  EXPECT_TRUE(fs::exists(aside / "traces" / "a.h5"));
}

TEST(RunFolder, a_folder_of_somebodys_own_traces_is_no_run) {
  Folder f;
  fs::create_directories(f.root / "mine" / "traces");
  std::ofstream(f.root / "mine" / "traces" / "my.csv") << "t_s,F_ref_N,U_V\n";
  EXPECT_FALSE(RunFolder::open(f.root / "mine"));
  EXPECT_TRUE(fs::exists(f.root / "mine" / "traces" / "my.csv"));
}

TEST(RunFolder, leaves_the_traces_of_a_bench_whatever_ends_the_run) {
  Folder f;
  fs::create_directories(f.root / "run.part-999999999" / "traces");
  std::ofstream(f.root / "run.part-999999999" / "traces" / "a.fgj") << "x";
  fs::path kept;
  {
    auto folder = RunFolder::open(f.root / "run");
    ASSERT_TRUE(folder);
    EXPECT_TRUE(fs::exists(f.root / "run.unfinished-999999999" / "traces" / "a.fgj")) << "what a killed run recorded";
    EXPECT_EQ(folder->left_by_others(), std::vector<fs::path>{f.root / "run.unfinished-999999999"});
    kept = folder->keep_traces();
    fs::create_directories(folder->path() / "traces");
    std::ofstream(folder->path() / "traces" / "b.fgj") << "x";
    EXPECT_EQ(folder->traces_that_stay(), std::vector<fs::path>{kept / "traces" / "b.fgj"});
  }
  EXPECT_TRUE(fs::exists(kept / "traces" / "b.fgj")) << "Ctrl-C";
  {
    auto folder = RunFolder::open(f.root / "run");
    ASSERT_TRUE(folder);
    kept = folder->keep_traces();
    ASSERT_TRUE(folder->publish({}));
  }
  EXPECT_TRUE(fs::exists(f.root / "run" / "result.json"));
  fs::remove_all(kept);
}

TEST(RunFolder, two_runs_never_fill_one_name_and_whoever_comes_too_late_keeps_its_result) {
  Folder f;
  ASSERT_TRUE(RunFolder::open(f.root / "run")->publish({}));
  const fs::path other = f.root / ("run.part-" + std::to_string(getppid()));
  fs::create_directories(other);
  const auto refused = RunFolder::open(f.root / "run");
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::usage);
  EXPECT_TRUE(fs::exists(f.root / "run" / "result.json")) << "an older result stays until there is a newer one";
  fs::remove_all(other);
  auto late = RunFolder::open(f.root / "run");
  ASSERT_TRUE(late);
  fs::create_directories(f.root / "run" / "of somebody else");
  const auto lost = late->publish({});
  ASSERT_FALSE(lost);
  const fs::path kept = f.root / ("run.run-" + std::to_string(getpid()));
  EXPECT_TRUE(fs::exists(kept / "result.json"));
  EXPECT_NE(lost.error().hint.find(kept.string()), std::string::npos) << lost.error().hint;
}

TEST(RunFolder, of_a_run_of_another_user_is_not_taken_for_a_dead_one) {
  Folder f;
  fs::permissions(f.root, fs::perms::all);
  fs::create_directories(f.root / "run.part-1");  // the first process lives, and is root's
  const pid_t child = fork();
  if (child == 0) {
    if (geteuid() == 0 && setuid(65534) != 0) _exit(2);
    _exit(RunFolder::open(f.root / "run") ? 1 : 0);
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_EQ(WEXITSTATUS(status), 0) << "1: it was taken";
  EXPECT_TRUE(fs::exists(f.root / "run.part-1"));
}

TEST(RunFolder, takes_no_name_for_its_own_that_has_no_process_and_no_folder_with_a_foreign_file) {
  Folder f;
  const std::vector<std::string> foreign{"run.part-B", "run.part-1st", "run.part-", "run.older-monday", "run.older-999999999-x", "run.part-999999999", "run.older-999999999"};
  for (const std::string& name : foreign) {
    fs::create_directories(f.root / name);
    std::ofstream(f.root / name / "recording.csv") << "x";
  }
  fs::create_directories(f.root / "run.part-999999998");
  std::ofstream(f.root / "run.part-999999998" / "bundle.json.part999999998") << "x";  // it was being written
  fs::create_directories(f.root / "run.older-999999998-2");
  std::ofstream(f.root / "run.older-999999998-2" / "result.json") << "{}";
  ASSERT_TRUE(RunFolder::open(f.root / "run")->publish({}));
  for (const std::string& name : foreign) EXPECT_TRUE(fs::exists(f.root / name / "recording.csv")) << name;
  EXPECT_FALSE(fs::exists(f.root / "run.part-999999998"));
  EXPECT_FALSE(fs::exists(f.root / "run.older-999999998-2"));
}

TEST(RunFolder, clears_what_a_killed_run_left_and_keeps_what_is_not_ours) {
  Folder f;
  fs::create_directories(f.root / "run.part-999999999");
  ASSERT_TRUE(RunFolder::open(f.root / "run"));
  EXPECT_FALSE(fs::exists(f.root / "run.part-999999999"));
  fs::create_directories(f.root / "photos");
  std::ofstream(f.root / "photos" / "cat.jpg") << "x";
  const auto refused = RunFolder::open(f.root / "photos");
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::usage);
  EXPECT_TRUE(fs::exists(f.root / "photos" / "cat.jpg"));
}

}  // namespace
}  // namespace forcegate
