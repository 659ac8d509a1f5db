#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <fstream>

#include "hil/base/rng.h"
#include "hil/trace/hdf5_io.h"
#include "hil/trace/journal.h"
#include "hil/trace/trace_recorder.h"
#include "tests/support/folder_test.h"

namespace forcegate {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
namespace fs = std::filesystem;

using Journal = FolderTest;

JournalHeader small_header() {
  return {"run",
          {{"rig", 1000.0}},
          {{"F_ref", "N", "force", SampleType::f32, 0}, {"U", "counts", "code", SampleType::u16, 0}},
          {{"seed", "1"}}};
}

Result<void> record(TraceRecorder& recorder, int from, int n) {
  std::vector<double> t;
  std::vector<float> f;
  std::vector<std::uint16_t> u;
  for (int i = from; i < from + n; ++i) {
    t.push_back(i * 1e-3);
    f.push_back(static_cast<float>(i));
    u.push_back(static_cast<std::uint16_t>(i));
  }
  return recorder.append(t, std::vector<ColumnView>{f, u});
}

// Bytes of 1000 rows in frames of ten, never closed; "": it could not be written.
std::string interrupted_journal(const fs::path& folder) {
  {
    auto recorder = TraceRecorder::create(folder / "r.h5", small_header());
    if (!recorder) return "";
    for (int i = 0; i < 1000; i += 10)
      if (!record(*recorder, i, 10)) return "";
  }
  std::ifstream file(folder / "r.fgj", std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST_F(Journal, ARecordingBecomesAnHdf5FileAndTheJournalGoes) {
  auto recorder = TraceRecorder::create(folder_ / "r.h5", small_header());
  ASSERT_TRUE(recorder);
  for (int i = 0; i < 10000; i += 100)
    if (i != 5000) {
      ASSERT_TRUE(record(*recorder, i, 100));
    }
  ASSERT_TRUE(recorder->append_raw(3, 10.0, {}));
  const auto report = recorder->close();
  ASSERT_TRUE(report) << report.error().to_text();
  EXPECT_TRUE(report->closed);
  EXPECT_EQ(report->samples, 9900u);
  EXPECT_EQ(report->raw_frames, 1u);
  EXPECT_FALSE(fs::exists(folder_ / "r.fgj"));
  const auto back = read_hdf5(folder_ / "r.h5");
  ASSERT_TRUE(back) << back.error().to_text();
  EXPECT_EQ(back->trace.size(), 9900u);
  EXPECT_EQ(back->trace.find("U")->raw[9899], 9999);
  EXPECT_EQ(back->trace.find("F_ref")->value[7], 7.0);
  ASSERT_EQ(back->trace.time_bases[0].gaps.size(), 1u);
  EXPECT_EQ(back->trace.time_bases[0].gaps[0].index, 5000u);
  EXPECT_EQ(back->trace.provenance, (std::map<std::string, std::string>{{"seed", "1"}}));
}

TEST_F(Journal, AJournalCutAnywhereGivesTheWholeFramesBefore) {
  const std::string whole = interrupted_journal(folder_);
  ASSERT_FALSE(whole.empty());
  const std::size_t frame = 24 + 4 + 10 * 14 + 4, header = whole.size() - 100 * frame;
  for (std::size_t cut = header; cut <= whole.size(); cut += 37) {
    std::ofstream(folder_ / "cut.fgj", std::ios::binary) << whole.substr(0, cut);
    const auto trace = read_journal_trace(folder_ / "cut.fgj");
    ASSERT_TRUE(trace) << trace.error().to_text();
    EXPECT_EQ(trace->trace.size(), (cut - header) / frame * 10);
    EXPECT_THAT(trace->notes, Contains(HasSubstr("interrupted")));
  }
  for (std::size_t cut = 0; cut < header; cut += 11) {
    std::ofstream(folder_ / "cut.fgj", std::ios::binary) << whole.substr(0, cut);
    EXPECT_EQ(read_journal_trace(folder_ / "cut.fgj").error().code, ErrorCode::parse);
  }
}

TEST_F(Journal, ADamagedFrameIsSkippedCountedAndLeavesAGap) {
  const std::string whole = interrupted_journal(folder_);
  ASSERT_FALSE(whole.empty());
  const std::size_t frame = 24 + 4 + 10 * 14 + 4, header = whole.size() - 100 * frame;
  Rng rng(8, "flip");
  for (int run = 0; run < 60; ++run) {
    std::string damaged = whole;
    const std::size_t at = header + rng.below(99 * frame);
    damaged[at] = static_cast<char>(damaged[at] ^ (1 << rng.below(8)));
    std::ofstream(folder_ / "x.fgj", std::ios::binary) << damaged;
    const auto report = recover_journal(folder_ / "x.fgj", folder_ / "x.h5");
    ASSERT_TRUE(report);
    EXPECT_EQ(report->samples, 990u);
    EXPECT_EQ(report->bytes_skipped, frame);
    EXPECT_EQ(report->damaged_places, 1u);
    const auto back = read_hdf5(folder_ / "x.h5");
    ASSERT_TRUE(back);
    EXPECT_EQ(back->trace.time_bases[0].gaps.size(), at >= header + frame ? 1u : 0u);
    EXPECT_THAT(back->trace.provenance.at("recovered"), HasSubstr("990 rows saved"));
  }
}

TEST_F(Journal, AFullDiskIsReportedAndWhatWasWrittenCanBeRead) {
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    // The limit on file size stands for the full disk; only this child has it.
    ::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{200000, 200000};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    auto recorder = TraceRecorder::create(folder_ / "r.h5", small_header());
    if (!recorder) ::_exit(3);
    for (int i = 0; i < 100000; i += 100)
      if (auto result = record(*recorder, i, 100); !result)
        ::_exit(result.error().code == ErrorCode::io ? 0 : 2);
    ::_exit(1);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 0);
  const auto trace = read_journal_trace(folder_ / "r.fgj");
  ASSERT_TRUE(trace) << trace.error().to_text();
  EXPECT_GT(trace->trace.size(), 12000u);
}

TEST_F(Journal, AFlushAfterAWriteThatFailedHalfWayWritesNothingTwice) {
  constexpr rlim_t kLimit = 10000;
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    ::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{kLimit, RLIM_INFINITY}, none{RLIM_INFINITY, RLIM_INFINITY};
    auto writer = JournalWriter::create(folder_ / "r.fgj", small_header());
    if (!writer) ::_exit(3);
    const std::vector<std::byte> payload(2 * kLimit);
    if (!writer->append({3, FrameKind::raw, 1, payload})) ::_exit(4);
    ::setrlimit(RLIMIT_FSIZE, &limit);
    if (writer->flush()) ::_exit(5);
    ::setrlimit(RLIMIT_FSIZE, &none);
    ::_exit(writer->flush() ? 1 : 0);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 0) << "1: the flush went on";
  EXPECT_EQ(fs::file_size(folder_ / "r.fgj"), kLimit);
}

TEST_F(Journal, KillingTheRecorderLosesAtMostOneSecondAndTheFileOpens) {
  Rng rng(2026, "kill");
  const int runs = 40;
  for (int run = 0; run < runs; ++run) {
    int progress[2];
    ASSERT_EQ(::pipe(progress), 0);
    const pid_t child = ::fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      ::close(progress[0]);
      auto recorder = TraceRecorder::create(folder_ / "r.h5", small_header());
      if (!recorder) ::_exit(1);
      for (std::int32_t i = 0; i < 100000000; i += 10) {
        if (!record(*recorder, i, 10)) ::_exit(1);
        const std::int32_t last = i + 9;
        if (::write(progress[1], &last, sizeof last) != sizeof last) ::_exit(1);
      }
      ::_exit(1);
    }
    ::close(progress[1]);
    // Killed at a random amount of progress, so that the test does not depend on the machine's speed.
    const auto until = static_cast<std::int32_t>(rng.below(30000));
    std::int32_t last = -1, told = -1;
    while (last < until && ::read(progress[0], &told, sizeof told) == sizeof told) last = told;
    ::kill(child, SIGKILL);
    while (::read(progress[0], &told, sizeof told) == sizeof told) last = told;
    ::close(progress[0]);
    int status = 0;
    ::waitpid(child, &status, 0);
    ASSERT_TRUE(WIFSIGNALED(status)) << "the recorder ended by itself";

    const auto report = recover_journal(folder_ / "r.fgj", folder_ / "r.h5");
    ASSERT_TRUE(report) << report.error().to_text();
    EXPECT_GE(report->last_s, last * 1e-3 - 1.02) << "run " << run;
    const auto back = read_hdf5(folder_ / "r.h5");
    ASSERT_TRUE(back) << back.error().to_text();
    EXPECT_EQ(back->trace.size(), report->samples);
    for (std::size_t i = 0; i < back->trace.size(); ++i)
      ASSERT_EQ(back->trace.find("F_ref")->value[i], static_cast<double>(i));
  }
}

}  // namespace
}  // namespace forcegate
