#include "hil/trace/ordered_stamps.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "hil/base/quantile.h"
#include "hil/base/text.h"
#include "hil/trace/date_time.h"
#include "hil/trace/packets.h"
#include "hil/trace/part_column.h"
#include "hil/trace/summer_time.h"
#include "hil/trace/trace.h"

namespace forcegate {
namespace {

std::string times(std::size_t n, const char* one, const char* many) {
  return std::to_string(n) + " " + (n == 1 ? one : many);
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
    return std::ranges::all_of(columns, [&](const std::vector<double>* values) {
      return (*values)[a] == (*values)[b] || (std::isnan((*values)[a]) && std::isnan((*values)[b]));
    });
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

std::optional<std::vector<double>> spread_bursts(const std::vector<double>& ordered_s, const std::vector<std::size_t>& rows,
                                                 const ClockSource& source, std::vector<std::string>& notes) {
  const auto stamps = stamps_of_bursts(ordered_s, rows, source.columns, source.declared_rate_Hz);
  auto spread = stamps ? spread_packets(*stamps, source.declared_rate_Hz) : std::nullopt;
  if (!spread) return std::nullopt;
  std::size_t bursts = 1;
  for (std::size_t i = 1; i < stamps->size(); ++i) bursts += (*stamps)[i] != (*stamps)[i - 1];
  notes.push_back("the rows were stamped in bursts of " + std::to_string((stamps->size() + bursts / 2) / bursts) +
                  ", when they were read and not when they were sampled, for their values run on from one burst to the next: "
                  "their instants are spread evenly between the bursts, the first one " + fmt::format("{:.3g}", ordered_s.front() - spread->front()) +
                  " s before its stamp (a logger that cuts off fractions of a second is that early beside another clock)");
  return spread;
}

// Splitting cannot mend a file that was written from its end.
Result<void> check_runs_forwards(const std::vector<double>& t, const std::string& where) {
  constexpr std::size_t kFewest = 3;
  std::size_t down = 0, up = 0;
  for (std::size_t i = 1; i < t.size(); ++i) down += t[i] < t[i - 1], up += t[i] > t[i - 1];
  if (down < kFewest || down <= up || t.back() > t.front()) return {};  // swapped neighbours go on in the end
  return fail(ErrorCode::parse,
              "the clock runs backwards, from " + shortest(t.front()) + " s down to " + shortest(t.back()) + " s, in " +
                  std::to_string(down) + " of " + std::to_string(t.size() - 1) + " steps",
              where, "sort the rows by their time");
}

std::string as_written(double t_s, bool dates) { return dates ? stamp_of_seconds(t_s) : shortest(t_s) + " s"; }

std::string hint_for_jump(double back_s, double step_s, const ClockSource& source, std::size_t row) {
  const std::string column = source.changes_at ? source.changes_at(row) : "";
  if (!column.empty()) return "column \"" + column + "\" changes there: make one file for each of its values, " + split_command(source.where, column);
  const std::string split = "split the file where a new recording begins";
  const auto hour = source.dates && !source.zoned ? hint_for_hour_back(back_s, step_s) : std::nullopt;
  return hour ? *hour + "; where it is another recording, " + split : split;
}

bool increases(const std::vector<double>& stamps_s) {
  if (stamps_s.empty() || !std::isfinite(stamps_s.front())) return false;
  for (std::size_t i = 1; i < stamps_s.size(); ++i)
    if (!(stamps_s[i] > stamps_s[i - 1] && stamps_s[i] < HUGE_VAL)) return false;
  return true;
}

double median_change(const std::vector<double>& t) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < t.size(); ++i)
    if (t[i] != t[i - 1]) steps.push_back(std::fabs(t[i] - t[i - 1]));
  return steps.empty() ? 0.0 : median(std::move(steps));
}

Result<void> check_no_hour_is_skipped(const OrderedStamps& stamps, const ClockSource& source) {
  if (!source.dates || source.zoned) return {};
  const std::vector<double>& t = stamps.t_s;
  const auto at = hour_ahead(t, median_change(t));
  if (!at) return {};
  const std::size_t row = stamps.rows.empty() ? *at : stamps.rows[*at];
  const std::string line = source.line_of_row ? ":" + std::to_string(source.line_of_row(row)) : "";
  return fail(ErrorCode::parse, "the clock skips an hour, from " + as_written(t[*at - 1], true) + " to " + as_written(t[*at], true), source.where + line, hint_for_hour_ahead());
}

// Stamps that are missing, out of order or repeated.
class Disorder {
 public:
  Disorder(const std::vector<double>& stamps_s, const ClockSource& source, OrderedStamps& out) : stamps_s_(stamps_s), source_(source), out_(out) {}

  Result<void> mend() {
    FORCEGATE_CHECK_OK(drop_unstamped());
    FORCEGATE_CHECK_OK(put_in_order());
    return mend_repeated();
  }

 private:
  bool has_lines() const { return static_cast<bool>(source_.line_of_row); }
  std::uint64_t line_of(std::size_t row) const { return has_lines() ? source_.line_of_row(row) : static_cast<std::uint64_t>(row + 1); }

  std::vector<double> stamps_of(const std::vector<std::size_t>& rows) const {
    std::vector<double> out;
    for (const std::size_t r : rows) out.push_back(stamps_s_[r]);
    return out;
  }

  Result<void> drop_unstamped() {
    for (std::size_t i = 0; i < stamps_s_.size(); ++i)
      if (std::isfinite(stamps_s_[i])) out_.rows.push_back(i);
    if (out_.rows.empty())
      return fail(ErrorCode::parse, "no row has a time stamp", source_.where,
                  "map another column, --map NAME=t_s, or leave the clock out: --map " + shell_quoted(source_.column + "=unused") + " --rate HZ");
    if (out_.rows.size() < stamps_s_.size())
      out_.notes.push_back(without_stamp(stamps_s_, [this](std::size_t row) { return line_of(row); }, has_lines() ? "line" : "row"));
    return {};
  }

  Result<void> put_in_order() {
    constexpr double kMostBack = 10.0;  // steps
    const std::vector<double> t = stamps_of(out_.rows);
    FORCEGATE_CHECK_OK(check_runs_forwards(t, source_.where));
    const double step_s = median_change(t);
    std::size_t backwards = 0;
    double latest_s = t.front();
    for (std::size_t i = 1; i < t.size(); ++i) {
      backwards += t[i] < latest_s ? 1 : 0;
      if (latest_s - t[i] > kMostBack * step_s) return jumps_back(latest_s, t[i], step_s, out_.rows[i]);
      latest_s = std::max(latest_s, t[i]);
    }
    if (backwards == 0) return {};
    std::ranges::stable_sort(out_.rows, {}, [this](std::size_t r) { return stamps_s_[r]; });
    out_.notes.push_back(times(backwards, "row was", "rows were") + " out of order; sorted by time");
    return {};
  }

  Result<void> jumps_back(double from_s, double to_s, double step_s, std::size_t row) const {
    const std::string line = std::to_string(line_of(row));
    return fail(ErrorCode::parse,
                "the clock jumps back from " + as_written(from_s, source_.dates) + " to " + as_written(to_s, source_.dates) + (has_lines() ? " in line " : " in row ") + line,
                has_lines() ? source_.where + ":" + line : source_.where, hint_for_jump(from_s - to_s, step_s, source_, row));
  }

  Result<void> mend_repeated() {
    constexpr std::size_t kOneIn = 100;  // rows: fewer are slips
    std::vector<std::size_t> distinct;
    for (const std::size_t r : out_.rows)
      if (distinct.empty() || stamps_s_[r] != stamps_s_[distinct.back()]) distinct.push_back(r);
    const std::size_t rows = out_.rows.size(), repeated = rows - distinct.size();
    const bool are_many = repeated > 1 && repeated * kOneIn > rows;
    const std::string of_rows = std::to_string(repeated) + " of " + std::to_string(rows) + " rows";
    if (are_many && are_copies(out_.rows, stamps_s_, source_.columns)) {
      out_.notes.push_back(of_rows + " repeat the row before them, time stamp and every value; a copy is no second sample, and they are dropped");
      keep(std::move(distinct));
      return {};
    }
    const std::vector<double> ordered_s = stamps_of(out_.rows);
    if (auto spread = spread_bursts(ordered_s, out_.rows, source_, out_.notes)) {
      out_.t_s = std::move(*spread);
      return {};
    }
    if (!are_many) {
      if (repeated > 0) out_.notes.push_back(times(repeated, "row repeats", "rows repeat") + " a time stamp; dropped");
      keep(std::move(distinct));
      return {};
    }
    auto spread = spread_packets(ordered_s, source_.declared_rate_Hz);
    if (!spread)
      return fail(ErrorCode::parse, "the clock \"" + source_.column + "\" stands still in " + of_rows, source_.where,
                  "leave it out: --map " + shell_quoted(source_.column + "=unused") + " --rate HZ");
    out_.notes.push_back(of_rows + " repeat the time stamp before them, as in packets of " + std::to_string((rows + distinct.size() / 2) / distinct.size()) +
                         ": their instants are spread evenly between the stamps");
    out_.t_s = std::move(*spread);
    return {};
  }

  void keep(std::vector<std::size_t> rows) {
    out_.t_s = stamps_of(rows);
    out_.rows = std::move(rows);
  }

  const std::vector<double>& stamps_s_;
  const ClockSource& source_;
  OrderedStamps& out_;
};

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

Result<OrderedStamps> order_stamps(std::vector<double>& stamps_s, const ClockSource& source) {
  OrderedStamps out;
  if (const std::size_t days = count_midnights(stamps_s); days > 0) out.notes.push_back(note_of_midnights(days));
  if (!increases(stamps_s)) {
    FORCEGATE_CHECK_OK(Disorder(stamps_s, source, out).mend());
  } else if (auto spread = spread_bursts(stamps_s, {}, source, out.notes)) {
    out.t_s = std::move(*spread);
  } else {
    out.t_s = std::move(stamps_s);
  }
  FORCEGATE_CHECK_OK(check_no_hour_is_skipped(out, source));
  return out;
}

}  // namespace forcegate
