#include "hil/trace/time_base.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "hil/base/quantile.h"
#include "hil/base/text.h"
#include "hil/trace/date_time.h"
#include "hil/trace/packets.h"
#include "hil/trace/part_column.h"

namespace forcegate {
namespace {

double median_step(const std::vector<double>& t) {
  const std::size_t n = t.size() - 1, stride = std::max<std::size_t>(1, n / 4096);
  std::vector<double> steps;
  for (std::size_t i = 0; i < n; i += stride) steps.push_back(t[i + 1] - t[i]);
  return median(std::move(steps));
}

constexpr double kGap = 1.5;  // nominal steps, with room for the rounding of the stamps
bool is_long(double step_s, double nominal_s) { return step_s > kGap * nominal_s * (1 + 1e-9); }

std::size_t count_long(const std::vector<double>& t, double step) {
  std::size_t n = 0;
  for (std::size_t i = 1; i < t.size(); ++i) n += is_long(t[i] - t[i - 1], step);
  return n;
}

// A uniform clock with rounded stamps has steps of two lengths.
bool is_rounded(const std::vector<double>& t, double step) {
  constexpr double kSame = 1e-3;
  std::vector<double> lengths;
  for (std::size_t i = 1; i < t.size(); ++i) {
    const double length = t[i] - t[i - 1];
    if (is_long(length, step) || std::ranges::any_of(lengths, [&](double known) { return std::fabs(known - length) < kSame * step; })) continue;
    if (lengths.size() == 2) return false;
    lengths.push_back(length);
  }
  return true;
}

// Standard deviation of the stamps about a uniform clock, in steps, from their second differences: a rate that changes is no jitter.
double jitter_of(const std::vector<double>& t, double step) {
  constexpr std::size_t kMost = 8192;
  if (t.size() < 3 || is_rounded(t, step)) return 0.0;
  std::vector<double> second;
  for (std::size_t i = 1, stride = t.size() / kMost + 1; i + 1 < t.size(); i += stride) second.push_back(std::fabs(t[i + 1] - 2.0 * t[i] + t[i - 1]));
  return deviation_of_magnitudes(std::move(second)) / std::sqrt(6.0) / step;
}

/// The jitter, in steps.
double find_rate_and_gaps(TimeBase& base) {
  constexpr double kMostJitter = 0.25, kStandsOut = 5.0;  // beyond there is no rate; standard deviations of a step
  const auto& t = base.t_s;
  if (t.size() < 2) return 0.0;
  double step = median_step(t);
  const auto steps = static_cast<double>(t.size() - 1);
  if (static_cast<double>(count_long(t, step)) > 0.1 * steps) step = (t.back() - t.front()) / steps;
  if (!(step > 0.0)) return 0.0;
  const double jitter = jitter_of(t, step);
  const bool jitters = jitter > 0.0 && jitter <= kMostJitter;
  if (!jitters && static_cast<double>(count_long(t, step)) > 0.1 * steps) return 0.0;
  const double least = jitters ? 1.0 + kStandsOut * std::sqrt(2.0) * jitter : 0.0;
  // nothing is missing where a neighbour is as much shorter: that stamp came late
  const auto made_up_for = [&](std::size_t i) {
    const double before = i > 1 ? t[i - 1] - t[i - 2] : HUGE_VAL, behind = i + 1 < t.size() ? t[i + 1] - t[i] : HUGE_VAL;
    return t[i] - t[i - 1] + std::min(before, behind) < (1.0 + kGap) * step;
  };
  double missing_s = 0.0;
  for (std::size_t i = 1; i < t.size(); ++i)
    if (is_long(t[i] - t[i - 1], step) && t[i] - t[i - 1] > least * step && !made_up_for(i)) {
      base.gaps.push_back({i, t[i - 1], t[i]});
      missing_s += t[i] - t[i - 1];
    }
  const double regular = steps - static_cast<double>(base.gaps.size());
  base.nominal_rate_Hz = regular > 0 ? regular / (t.back() - t.front() - missing_s) : 1.0 / step;
  return jitters ? jitter : 0.0;
}

std::string times(std::size_t n, const char* one, const char* many) {
  return std::to_string(n) + " " + (n == 1 ? one : many);
}

bool misses_stamp(const std::vector<double>& stamps_s, std::size_t behind, std::size_t before) {
  for (std::size_t i = behind + 1; i < before; ++i)
    if (!std::isfinite(stamps_s[i])) return true;
  return false;
}

std::string without_stamp(const std::vector<double>& stamps_s, const LineOfRow& line_of_row, const std::string& word) {
  constexpr std::size_t kNamed = 3;
  std::size_t n = 0;
  std::string lines;
  for (std::size_t i = 0; i < stamps_s.size(); ++i)
    if (!std::isfinite(stamps_s[i]) && n++ < kNamed) lines += (n == 1 ? "" : ", ") + std::to_string(line_of_row(i));
  const std::string more = n > kNamed ? " and " + std::to_string(n - kNamed) + " more" : "";
  return times(n, "row has", "rows have") + " no time stamp (" + word + (n == 1 ? " " : "s ") + lines + more + "); dropped";
}

// Rows under one stamp that differ in nothing. A signal at rest repeats itself in packets as well: what changes between the stamps tells whether it would
// have changed within them.
bool are_copies(const std::vector<std::size_t>& rows, const std::vector<double>& stamps_s, const OtherColumns& columns) {
  constexpr std::size_t kFewestChanges = 8;
  if (columns.empty()) return false;
  const auto same_row = [&](std::size_t a, std::size_t b) {
    return std::ranges::all_of(columns, [&](const std::vector<double>* values) { return (*values)[a] == (*values)[b] || (std::isnan((*values)[a]) && std::isnan((*values)[b])); });
  };
  std::size_t stamps = 0, changes = 0, repeats = 0;
  for (std::size_t i = 1; i < rows.size(); ++i) {
    const bool same = same_row(rows[i - 1], rows[i]);
    if (stamps_s[rows[i]] == stamps_s[rows[i - 1]]) {
      if (!same) return false;
      ++repeats;
    } else {
      ++stamps;
      changes += !same;
    }
  }
  return changes * repeats >= kFewestChanges * stamps && changes >= kFewestChanges;
}

std::optional<std::vector<double>> spread_bursts(const std::vector<double>& ordered_s, const std::vector<std::size_t>& rows, const ClockSource& source, std::vector<std::string>& notes) {
  const auto stamps = stamps_of_bursts(ordered_s, rows, source.columns, source.declared_rate_Hz);
  auto spread = stamps ? spread_packets(*stamps, source.declared_rate_Hz) : std::nullopt;
  if (!spread) return std::nullopt;
  std::size_t bursts = 1;
  for (std::size_t i = 1; i < stamps->size(); ++i) bursts += (*stamps)[i] != (*stamps)[i - 1];
  notes.push_back("the rows were stamped in bursts of " + std::to_string((stamps->size() + bursts / 2) / bursts) +
                  ", when they were read and not when they were sampled, for their values run on from one burst to the next: their instants are spread evenly between the bursts");
  return spread;
}

// Splitting cannot mend a file that was written from its end.
Result<void> check_runs_forwards(const std::vector<double>& t, const std::string& where) {
  constexpr std::size_t kFewest = 3;
  std::size_t down = 0, up = 0;
  for (std::size_t i = 1; i < t.size(); ++i) down += t[i] < t[i - 1], up += t[i] > t[i - 1];
  if (down < kFewest || down <= up) return {};
  return fail(ErrorCode::parse, "the clock runs backwards, from " + shortest(t.front()) + " s down to " + shortest(t.back()) + " s, in " + std::to_string(down) + " of " + std::to_string(t.size() - 1) + " steps", where,
              "sort the rows by their time");
}

}  // namespace

std::size_t count_midnights(std::vector<double>& stamps_s) {
  constexpr double kDay_s = 86400.0, kNear_s = 60.0;
  for (const double t : stamps_s)
    if (std::isfinite(t) && !(t >= 0.0 && t <= kDay_s)) return 0;
  double added_s = 0.0, before = kMissing;
  for (double& t : stamps_s) {
    if (!std::isfinite(t)) continue;
    if (before > kDay_s - kNear_s && t < kNear_s) added_s += kDay_s;
    before = t;
    t += added_s;
  }
  return static_cast<std::size_t>(added_s / kDay_s);
}

std::string note_of_midnights(std::size_t days) {
  return "the clock of day passes midnight" + (days == 1 ? std::string() : " " + std::to_string(days) + " times") + "; counted on";
}

TimeBase with_rate_and_gaps(std::vector<double> t_s) {
  TimeBase base;
  base.t_s = std::move(t_s);
  find_rate_and_gaps(base);
  return base;
}

TimeBase invented_clock(std::size_t rows, double rate_Hz) {
  TimeBase base;
  base.invented = true;
  base.nominal_rate_Hz = rate_Hz;
  base.t_s.resize(rows);
  for (std::size_t i = 0; i < rows; ++i) base.t_s[i] = static_cast<double>(i) / rate_Hz;
  return base;
}

namespace {

std::string as_written(double t_s, bool dates) { return dates ? stamp_of_seconds(t_s) : shortest(t_s) + " s"; }

std::string hint_for_jump(double back_s, double step_s, const ClockSource& source, std::size_t row) {
  constexpr double kHour_s = 3600.0, kNear_s = 5.0;
  const std::string column = source.changes_at ? source.changes_at(row) : "";
  if (!column.empty()) return "column \"" + column + "\" changes there: make one file for each of its values, " + split_command(source.where, column);
  const std::string split = "split the file where a new recording begins";
  if (!source.dates || std::fabs(back_s - kHour_s) > std::max(kNear_s, 2.0 * step_s)) return split;
  return "an hour is what clocks go back at the end of summer time: add it to the stamps from there on, or write all of them with their zone (2026-10-25T02:00:00+01:00); where it is another recording, " + split;
}

}  // namespace

Result<Clock> make_clock(std::vector<double> stamps_s, const ClockSource& source) {
  Clock clock;
  const std::string& where = source.where;
  const bool has_lines = static_cast<bool>(source.line_of_row);
  const LineOfRow line_of_row = has_lines ? source.line_of_row : [](std::size_t row) { return static_cast<std::uint64_t>(row + 1); };
  if (const std::size_t days = count_midnights(stamps_s); days > 0) clock.notes.push_back(note_of_midnights(days));
  bool increasing = !stamps_s.empty() && std::isfinite(stamps_s.front());
  for (std::size_t i = 1; i < stamps_s.size() && increasing; ++i)
    increasing = stamps_s[i] > stamps_s[i - 1] && stamps_s[i] < HUGE_VAL;
  if (!increasing) {
    auto& rows = clock.rows;
    for (std::size_t i = 0; i < stamps_s.size(); ++i)
      if (std::isfinite(stamps_s[i])) rows.push_back(i);
    if (rows.empty())
      return fail(ErrorCode::parse, "no row has a time stamp", where,
                  "map another column, --map NAME=t_s, or leave the clock out: --map " + shell_quoted(source.column + "=unused") + " --rate HZ");
    if (rows.size() < stamps_s.size())
      clock.notes.push_back(without_stamp(stamps_s, line_of_row, has_lines ? "line" : "row"));

    std::vector<double> t;
    for (const std::size_t r : rows) t.push_back(stamps_s[r]);
    std::vector<double> steps;
    for (std::size_t i = 1; i < t.size(); ++i)
      if (t[i] != t[i - 1]) steps.push_back(std::fabs(t[i] - t[i - 1]));
    const double step = steps.empty() ? 0.0 : median(std::move(steps));
    FORCEGATE_CHECK_OK(check_runs_forwards(t, where));
    std::size_t backwards = 0;
    double latest = t.front();
    for (std::size_t i = 1; i < t.size(); ++i) {
      if (t[i] < latest) {
        ++backwards;
        if (latest - t[i] > 10.0 * step)
          return fail(ErrorCode::parse,
                      "the clock jumps back from " + as_written(latest, source.dates) + " to " + as_written(t[i], source.dates) +
                          (has_lines ? " in line " : " in row ") + std::to_string(line_of_row(rows[i])),
                      has_lines ? where + ":" + std::to_string(line_of_row(rows[i])) : where, hint_for_jump(latest - t[i], step, source, rows[i]));
      }
      latest = std::max(latest, t[i]);
    }
    if (backwards > 0) {
      std::stable_sort(rows.begin(), rows.end(),
                       [&](std::size_t a, std::size_t b) { return stamps_s[a] < stamps_s[b]; });
      clock.notes.push_back(times(backwards, "row was", "rows were") + " out of order; sorted by time");
    }
    std::vector<std::size_t> distinct;
    for (const std::size_t r : rows)
      if (distinct.empty() || stamps_s[r] != stamps_s[distinct.back()]) distinct.push_back(r);
    const std::size_t repeated = rows.size() - distinct.size();
    if (repeated > 1 && repeated * 100 > rows.size() && are_copies(rows, stamps_s, source.columns)) {
      clock.notes.push_back(std::to_string(repeated) + " of " + std::to_string(rows.size()) + " rows repeat the row before them, time stamp and every value; a copy is no second sample, and they are dropped");
      rows = std::move(distinct);
      for (const std::size_t r : rows) clock.base.t_s.push_back(stamps_s[r]);
    } else {
      std::vector<double> ordered;
      for (const std::size_t r : rows) ordered.push_back(stamps_s[r]);
      if (auto spread = spread_bursts(ordered, rows, source, clock.notes)) {
        clock.base.t_s = std::move(*spread);
      } else if (repeated > 1 && repeated * 100 > rows.size()) {
        spread = spread_packets(ordered, source.declared_rate_Hz);
        if (!spread)
          return fail(ErrorCode::parse, "the clock \"" + source.column + "\" stands still in " + std::to_string(repeated) + " of " + std::to_string(rows.size()) + " rows", where,
                      "leave it out: --map " + shell_quoted(source.column + "=unused") + " --rate HZ");
        clock.notes.push_back(std::to_string(repeated) + " of " + std::to_string(rows.size()) +
                              " rows repeat the time stamp before them, as in packets of " + std::to_string((rows.size() + distinct.size() / 2) / distinct.size()) +
                              ": their instants are spread evenly between the stamps");
        clock.base.t_s = std::move(*spread);
      } else {
        if (repeated > 0) clock.notes.push_back(times(repeated, "row repeats", "rows repeat") + " a time stamp; dropped");
        rows = std::move(distinct);
        for (const std::size_t r : rows) clock.base.t_s.push_back(stamps_s[r]);
      }
    }
  } else if (auto spread = spread_bursts(stamps_s, {}, source, clock.notes)) {
    clock.base.t_s = std::move(*spread);
  } else {
    clock.base.t_s = std::move(stamps_s);
  }

  constexpr double kTold = 0.05;
  if (const double jitter = find_rate_and_gaps(clock.base); jitter >= kTold)
    clock.notes.push_back("the clock jitters by " + std::to_string(std::lround(100.0 * jitter)) + " % of a period");
  std::size_t gaps = 0;
  double longest = 0.0;
  for (const Gap& g : clock.base.gaps) {
    if (!clock.rows.empty() && misses_stamp(stamps_s, clock.rows[g.index - 1], clock.rows[g.index])) continue;  // is told already
    ++gaps;
    longest = std::max(longest, g.to_s - g.from_s);
  }
  if (gaps > 0) {
    char shown[32];
    std::snprintf(shown, sizeof shown, "%.4g", longest);
    clock.notes.push_back(times(gaps, "gap", "gaps") + " in the clock, the longest " + shown + " s");
  }
  if (clock.base.nominal_rate_Hz == 0.0 && clock.base.t_s.size() > 2)
    clock.notes.push_back("the clock is not uniform: there is no one sample rate");
  return clock;
}

}  // namespace forcegate
