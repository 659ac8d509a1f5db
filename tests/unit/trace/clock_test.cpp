// What read_csv makes of clocks that are not what they seem: packets, jitter, coarse stamps.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "hil/base/rng.h"
#include "hil/base/text.h"
#include "hil/trace/clock_unit.h"
#include "hil/trace/csv.h"
#include "hil/trace/packets.h"
#include "tests/unit/trace/read_csv.h"

namespace forcegate {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

std::string table(const std::vector<double>& stamps_s, const std::string& clock = "t_s") {
  std::string text = clock + ",F_ref_N\n";
  for (const double t : stamps_s) text += shortest(t) + ",1\n";
  return text;
}

// The stamp of each row's last in packets of `rows`, rounded as a file has it.
std::vector<double> packet_stamps(std::size_t n, double rate_Hz, std::size_t rows, double begin_s) {
  std::vector<double> out;
  for (std::size_t i = 0; i < n; ++i)
    out.push_back(std::round(1e4 * (begin_s + static_cast<double>(std::min(n - 1, i / rows * rows + rows - 1)) / rate_Hz)) / 1e4);
  return out;
}

TEST(ClockOfATable, SpreadsTheRowsOfAPacketAlongTheClock) {
  for (const double begin_s : {0.0, 1.7e9}) {
    const auto f = read(table(packet_stamps(1710, 72.0, 30, begin_s)));
    const TimeBase& base = f.trace.time_bases.front();
    ASSERT_EQ(base.t_s.size(), 1710u);
    EXPECT_NEAR(base.nominal_rate_Hz, 72.0, 0.01);
    EXPECT_TRUE(base.gaps.empty());
    for (std::size_t i = 0; i < 1710; ++i) EXPECT_NEAR(base.t_s[i], begin_s + static_cast<double>(i) / 72.0, 2e-4) << i;
    EXPECT_THAT(f.notes, Contains(HasSubstr("1653 of 1710 rows repeat the time stamp before them, as in packets of 30")));
  }
}

TEST(ClockOfATable, KeepsAGapBetweenPackets) {
  std::vector<double> stamps_s = packet_stamps(1000, 100.0, 10, 0.0);
  for (std::size_t i = 500; i < 1000; ++i) stamps_s[i] += 4.0;
  CsvOptions declared;
  declared.assumed_rate_Hz = 100.0;
  for (const CsvOptions& options : {CsvOptions{}, declared}) {
    const auto f = read(table(stamps_s), options);
    const TimeBase& base = f.trace.time_bases.front();
    ASSERT_EQ(base.gaps.size(), 1u);
    EXPECT_EQ(base.gaps.front().index, 500u);
    EXPECT_NEAR(base.t_s[505], 4.0 + 5.05, 1e-6);
    EXPECT_NEAR(base.t_s[495], 4.95, 1e-6);
  }
}

TEST(ClockOfATable, TellsStampsOfTheFirstRowFromThoseOfTheLast) {
  std::vector<double> stamps_s;
  for (std::size_t rows = 4, at = 0; at < 2000; at += rows, rows = 4 + (rows * 7 + at) % 9)
    for (std::size_t i = 0; i < rows; ++i) stamps_s.push_back(0.001 * static_cast<double>(at));
  const auto spread = spread_packets(stamps_s, 0.0);
  ASSERT_TRUE(spread);
  for (std::size_t i = 0; i < spread->size(); ++i) EXPECT_NEAR((*spread)[i], 0.001 * static_cast<double>(i), 1e-6) << i;
}

TEST(ClockOfATable, ReadsAUniformClockOutOfPacketsThatArriveLate) {
  std::vector<double> stamps_s = packet_stamps(4000, 200.0, 16, 0.0);
  Rng rng(3, "arrival");
  for (std::size_t i = 0; i < stamps_s.size(); i += 16) {
    const double late_s = 0.02 * rng.uniform();
    for (std::size_t k = i; k < std::min(i + 16, stamps_s.size()); ++k) stamps_s[k] += late_s;
  }
  const auto spread = spread_packets(stamps_s, 0.0);
  ASSERT_TRUE(spread);
  for (std::size_t i = 1; i < spread->size(); ++i) EXPECT_NEAR((*spread)[i] - (*spread)[i - 1], 0.005, 1e-4) << i;
}

TEST(ClockOfATable, ReadsStampsThatAreCoarserThanTheSampleRate) {
  std::vector<double> stamps_s;
  for (int i = 0; i < 3000; ++i) stamps_s.push_back(std::floor(i * 1000.0 / 1064.0) / 1000.0);
  const auto f = read(table(stamps_s));
  EXPECT_NEAR(f.trace.time_bases.front().nominal_rate_Hz, 1064.0, 1.0);
  EXPECT_TRUE(f.trace.time_bases.front().gaps.empty());
}

TEST(ClockOfATable, AClockThatStandsStillIsRefusedByItsName) {
  std::vector<double> stamps_s;
  for (int i = 0; i < 1000; ++i) stamps_s.push_back(i < 500 ? 0.01 * i : i < 900 ? 5.0 : 5.0 + 0.01 * (i - 899));
  const auto refused = parse_csv(table(stamps_s, "elapsed_s"), "x.csv");
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().text, HasSubstr("the clock \"elapsed_s\" stands still in 399 of 1000 rows"));
  EXPECT_THAT(refused.error().hint, HasSubstr("--map elapsed_s=unused --rate HZ"));
  EXPECT_FALSE(parse_csv(table(std::vector<double>(100, 3.0)), "x.csv"));
}

// Stamps that stand off a clock of 100 Hz by `jitter` of a period.
std::vector<double> jittering(double jitter) {
  Rng rng(5, "stamps");
  std::vector<double> out;
  for (int i = 0; i < 20000; ++i) out.push_back(std::round(1e5 * (1.0 + 0.01 * (i + jitter * rng.normal()))) / 1e5);
  std::ranges::sort(out);
  return out;
}

TEST(ClockOfATable, JitterIsToldAsJitterAndNotAsGaps) {
  const auto f = read(table(jittering(0.15)));
  EXPECT_TRUE(f.trace.time_bases.front().gaps.empty());
  EXPECT_NEAR(f.trace.time_bases.front().nominal_rate_Hz, 100.0, 0.1);
  EXPECT_THAT(f.notes, Contains("the clock jitters by 15 % of a period"));
  EXPECT_THAT(f.notes, Not(Contains(HasSubstr("gap"))));
  EXPECT_THAT(read(table(jittering(0.01))).notes, Not(Contains(HasSubstr("jitter"))));
}

TEST(ClockOfATable, AGapStandsOutOfTheJitter) {
  std::vector<double> stamps_s = jittering(0.15);
  stamps_s.erase(stamps_s.begin() + 7000, stamps_s.begin() + 7003);
  const auto f = read(table(stamps_s));
  ASSERT_EQ(f.trace.time_bases.front().gaps.size(), 1u);
  EXPECT_EQ(f.trace.time_bases.front().gaps.front().index, 7000u);
}

TEST(ClockOfATable, AStampThatCameLateIsNoGapAndALostRowIs) {
  std::vector<double> stamps_s;
  for (int i = 0; i < 1000; ++i)
    if (i != 700) stamps_s.push_back(0.01 * i + (i % 50 == 3 ? 0.007 : 0.0));
  const auto f = read(table(stamps_s));
  ASSERT_EQ(f.trace.time_bases.front().gaps.size(), 1u);
  EXPECT_EQ(f.trace.time_bases.front().gaps.front().index, 700u);
}

TEST(ClockOfATable, RoundedStampsAreNoJitter) {
  std::vector<double> stamps_s;
  for (int i = 0; i < 100; ++i) stamps_s.push_back(std::nearbyint(2.5 + 5.0 * i));
  EXPECT_THAT(read(table(stamps_s)).notes, Not(Contains(HasSubstr("jitter"))));
}

TEST(UnitOfTheClock, NumbersThatCannotBeSecondsAreFractionsOfOne) {
  for (const auto& [factor, name] : {std::pair{1e3, "milliseconds"}, std::pair{1e6, "microseconds"}, std::pair{1e9, "nanoseconds"}}) {
    for (const char* clock : {"timestamp", "t_s"}) {
      std::string text = std::string(clock) + ",F_ref_N\n";
      for (int i = 0; i < 100; ++i) text += std::to_string(static_cast<long long>((1.7e9 + 0.01 * i) * factor)) + ",1\n";
      const auto f = read(text);
      EXPECT_NEAR(f.trace.time_bases.front().nominal_rate_Hz, 100.0, 0.1) << name;
      EXPECT_NEAR(f.trace.time_bases.front().t_s.front(), 1.7e9, 1e-3) << name;
      EXPECT_THAT(f.notes, Contains(HasSubstr(std::string("read as ") + name)));
      EXPECT_THAT(f.notes, Not(Contains(HasSubstr("assumed"))));
    }
  }
  EXPECT_NEAR(read("timestamp,F_ref_N\n1700000000,1\n1700000001,1\n1700000002,1\n").trace.time_bases.front().nominal_rate_Hz, 1.0, 1e-9);
  const auto ticks = parse_csv("time,F_ref_N\n638000000000000000,1\n638000000000100000,1\n", "x.csv");
  ASSERT_FALSE(ticks) << "neither a date of this century nor seconds";
  EXPECT_THAT(ticks.error().text, HasSubstr("cannot be seconds"));
  EXPECT_THAT(ticks.error().hint, HasSubstr("--map time=t_us"));
}

TEST(UnitOfTheClock, WholeNumbersWithoutAUnitAreToldAndADeclaredRateDecides) {
  std::vector<double> counts;
  for (int i = 0; i < 200; ++i) counts.push_back(10.0 * i);
  const auto f = read(table(counts, "time"));
  EXPECT_NEAR(f.trace.time_bases.front().nominal_rate_Hz, 0.1, 1e-9);
  EXPECT_THAT(f.notes, Contains(HasSubstr("a sample every 10 s; if it counts milliseconds: --map time=t_ms")));
  CsvOptions options;
  options.column_map["time"] = "t_ms";
  EXPECT_NEAR(read(table(counts, "time"), options).trace.time_bases.front().nominal_rate_Hz, 100.0, 1e-6);
  options.column_map["time"] = "t_s";
  EXPECT_TRUE(read(table(counts, "time"), options).notes.empty()) << "who says seconds is not asked again";
  EXPECT_TRUE(read(table(counts, "t_s")).notes.empty());
  CsvOptions declared;
  declared.assumed_rate_Hz = 98.0;
  EXPECT_NEAR(read(table(counts, "time"), declared).trace.time_bases.front().nominal_rate_Hz, 100.0, 1e-6);
  declared.assumed_rate_Hz = 0.1;
  EXPECT_NEAR(read(table(counts, "time"), declared).trace.time_bases.front().nominal_rate_Hz, 0.1, 1e-9);
}

TEST(UnitOfTheClock, WithoutAUnitWhoseSecondsWouldBeHoursIsAskedAbout) {
  std::vector<double> stamps;
  for (int i = 0; i < 100; ++i) stamps.push_back(10000.0 * i);
  const auto read = unit_of_clock(stamps, "time", true, 0.0, "a.csv");
  ASSERT_TRUE(read);
  EXPECT_EQ(read->factor, 1.0) << "the default stays";
  EXPECT_EQ(map_of_clock({"another note", "a: " + read->note}), "--map time=t_us") << read->note;
  for (double& t : stamps) t /= 1000.0;
  EXPECT_EQ(map_of_clock({unit_of_clock(stamps, "time", true, 0.0, "a.csv")->note}), "") << "a slow logger";
  EXPECT_EQ(map_of_clock({}), "");
}

TEST(UnitOfTheClock, DaysOfASpreadsheetAreSuspectedAndRead) {
  std::string text = "time,F_ref_N\n";
  for (int i = 0; i < 100; ++i) text += shortest(46000.4 + 0.01 * i / 86400.0) + ",1\n";
  EXPECT_THAT(read(text).notes, Contains(HasSubstr("--map time=t_days")));
  CsvOptions options;
  options.column_map["time"] = "t_days";
  EXPECT_NEAR(read(text, options).trace.time_bases.front().nominal_rate_Hz, 100.0, 0.1);
}

TEST(ClockOfATable, TheOnlyColumnOfTimeIsTheClock) {
  const auto f = read("Time elapsed (ms),F_ref_N\n0,1\n10,1\n20,1\n");
  EXPECT_NEAR(f.trace.time_bases.front().nominal_rate_Hz, 100.0, 1e-9);
  EXPECT_THAT(f.notes, Contains("column \"Time elapsed (ms)\" was taken for the clock, the only time"));
  EXPECT_FALSE(parse_csv("dwell_s,rise_ms,F_ref_N\n0,1,1\n1,2,1\n", "x.csv"));
  CsvOptions options;
  options.assumed_rate_Hz = 50.0;
  EXPECT_TRUE(read("dwell_s,F_ref_N\n5,1\n5,1\n", options).trace.time_bases.front().invented);
  EXPECT_TRUE(read("dwell_s,F_ref_N\n5,1\n9,1\n12,1\n", options).trace.time_bases.front().invented) << "50 Hz is no 0.3 Hz";
  const auto ticks = read("esp_us,F_ref_N\n100,1\n20140,1\n40100,1\n", options);
  EXPECT_FALSE(ticks.trace.time_bases.front().invented);
  EXPECT_NEAR(ticks.trace.time_bases.front().t_s[1] - ticks.trace.time_bases.front().t_s[0], 0.02004, 1e-9);
}

TEST(ClockOfATable, IsCalledTsWhereItHasAUnit) {
  EXPECT_NEAR(read("ts_us,dwell_s,F_ref_N\n0,1,1\n10000,1,1\n20000,1,1\n").trace.time_bases.front().nominal_rate_Hz, 100.0, 1e-9);
  CsvOptions options;
  options.assumed_rate_Hz = 50.0;
  EXPECT_TRUE(read("F_ref_N,Ts\n1,4\n2,\n3,\n", options).trace.time_bases.front().invented) << "the period of sampling, once";
}

TEST(UnitOfTheClock, DatesNeedNoUnitAndNoName) {
  const char* rows = "2026-11-21T10:00:00.00,1\n2026-11-21T10:00:00.01,1\n2026-11-21T10:00:00.02,1\n";
  EXPECT_TRUE(read(std::string("time,F_ref_N\n") + rows).notes.empty());
  EXPECT_NEAR(read(std::string("Time (ms),F_ref_N\n") + rows).trace.time_bases.front().nominal_rate_Hz, 100.0, 0.01);
  const auto unnamed = read(std::string("Aufnahme,F_ref_N\n") + rows);
  EXPECT_NEAR(unnamed.trace.time_bases.front().nominal_rate_Hz, 100.0, 0.01);
  EXPECT_THAT(unnamed.notes, Contains("column \"Aufnahme\" holds dates or times of day and was taken for the clock"));
}

TEST(Packets, RowsThatRepeatStampAndValuesAreCopies) {
  std::string twice = "t_s,F_ref_N,U_V\n", packets = twice, rest = twice;
  for (int i = 0; i < 400; ++i) {
    const std::string values = shortest(1.0 + 0.01 * i) + "," + shortest(2.0 + 0.02 * i) + "\n", stamp = shortest(0.01 * i) + ",";
    twice += stamp + values + stamp + values;
    packets += shortest(0.01 * (i / 2 * 2)) + "," + values;
    rest += shortest(0.01 * (i / 2 * 2)) + ",1,2\n";
  }
  const TraceFile once = read(twice);
  EXPECT_EQ(once.trace.size(), 400u);
  EXPECT_NEAR(once.trace.time_bases[0].nominal_rate_Hz, 100.0, 1e-6);
  EXPECT_THAT(once.notes, Contains(HasSubstr("400 of 800 rows repeat the row before them, time stamp and every value")));
  const TraceFile sent = read(packets);
  EXPECT_EQ(sent.trace.size(), 400u) << "other values under one stamp are samples";
  EXPECT_THAT(sent.notes, Contains(HasSubstr("packets of 2")));
  const TraceFile still = read(rest);
  EXPECT_EQ(still.trace.size(), 400u) << "a signal at rest repeats itself";
  EXPECT_THAT(still.notes, Contains(HasSubstr("packets of 2")));
}

// A converter hands over what it has every 16 ms, and the rows are stamped while they are read.
struct Buffered {
  double rate_Hz = 1000.0;
  std::vector<double> t_s, stamps_s, force_N, output_V;
};

Buffered read_through_a_buffer(std::size_t n) {
  Buffered out;
  Rng rng(7);
  double late_s = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    const double t = static_cast<double>(i) / out.rate_Hz;
    late_s = i % 16 == 0 ? 0.001 * rng.uniform() : late_s + 2e-5 + 1e-4 * rng.uniform();
    out.t_s.push_back(t);
    out.stamps_s.push_back(static_cast<double>(i / 16 * 16 + 15) / out.rate_Hz + late_s);
    out.force_N.push_back(2.0 + std::sin(6.0 * t));
    out.output_V.push_back(out.force_N.back() + 0.005 * rng.normal());
  }
  return out;
}

std::string table_of(const Buffered& rows, double step_of_stamps_s, const std::vector<double>& stamps_s) {
  std::string text = "t_s,F_ref_N,U_V\n";
  for (std::size_t i = 0; i < stamps_s.size(); ++i)
    text += shortest(std::round(stamps_s[i] / step_of_stamps_s) * step_of_stamps_s) + "," + shortest(rows.force_N[i]) + "," + shortest(rows.output_V[i]) + "\n";
  return text;
}

TEST(Bursts, RowsStampedWhenTheyWereReadAreSpread) {
  const Buffered rows = read_through_a_buffer(4000);
  for (const double step_s : {1e-6, 1e-3}) {
    const TraceFile file = read(table_of(rows, step_s, rows.stamps_s));
    const TimeBase& base = file.trace.time_bases[0];
    ASSERT_EQ(base.t_s.size(), 4000u);
    EXPECT_NEAR(base.nominal_rate_Hz, 1000.0, 0.5);
    EXPECT_TRUE(base.gaps.empty());
    for (std::size_t i = 1; i < 4000; ++i) EXPECT_NEAR(base.t_s[i] - base.t_s[i - 1], 0.001, 1e-5) << i;
    EXPECT_THAT(file.notes, Contains(HasSubstr("in bursts of 16")));
    EXPECT_THAT(file.notes, Contains(HasSubstr("the first one " + fmt::format("{:.3g}", std::round(rows.stamps_s[0] / step_s) * step_s - base.t_s[0]) + " s before its stamp")));
  }
}

TEST(Bursts, ALoggerThatSamplesInBurstsKeepsItsStamps) {
  const Buffered rows = read_through_a_buffer(8000);
  Buffered kept;
  for (std::size_t i = 0; i < 8000; ++i)
    if (i % 400 < 100) {
      kept.t_s.push_back(rows.t_s[i]);
      kept.force_N.push_back(rows.force_N[i]);
      kept.output_V.push_back(rows.output_V[i]);
    }
  const std::string text = table_of(kept, 1e-6, kept.t_s);
  EXPECT_EQ(read(text).trace.time_bases[0].gaps.size(), 19u);
  CsvOptions declared;
  declared.assumed_rate_Hz = 250.0;
  EXPECT_THAT(read(text, declared).notes, Contains(HasSubstr("in bursts of 100"))) << "a stated rate decides";
}

TEST(Bursts, ALoggerThatWritesWhatChangesKeepsItsStamps) {
  const Buffered rows = read_through_a_buffer(8000);
  Buffered kept;
  for (std::size_t i = 0; i < 8000; ++i) {
    const double force_N = std::round(rows.force_N[i] * 50.0) / 50.0;
    if (!kept.force_N.empty() && force_N == kept.force_N.back()) continue;
    kept.t_s.push_back(rows.t_s[i]);
    kept.force_N.push_back(force_N);
    kept.output_V.push_back(rows.output_V[i]);
  }
  EXPECT_THAT(read(table_of(kept, 1e-6, kept.t_s)).notes, Not(Contains(HasSubstr("bursts"))));
}

TEST(Bursts, ValuesThatTellNothingLeaveTheStamps) {
  Buffered rows = read_through_a_buffer(2000);
  std::ranges::fill(rows.force_N, 1.0);
  std::ranges::fill(rows.output_V, 2.0);
  EXPECT_THAT(read(table_of(rows, 1e-6, rows.stamps_s)).notes, Not(Contains(HasSubstr("bursts"))));
}

}  // namespace
}  // namespace forcegate
