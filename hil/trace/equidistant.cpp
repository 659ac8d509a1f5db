#include "hil/trace/equidistant.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hil/base/text.h"

namespace forcegate {
namespace {

using Kind = EquidistantGrid::Kind;

constexpr double kNearWhole = 1e-3;
constexpr double kLongestGap_samples = 1e7;  // 2.8 h at 1 kHz, longer than records last

/// Rows [first, end) between two gaps.
struct Piece {
  std::size_t first = 0, end = 0;
};

std::vector<Piece> pieces_of(const TimeBase& base) {
  std::vector<Piece> out{{0, base.t_s.size()}};
  for (const Gap& gap : base.gaps) {
    out.back().end = gap.index;
    out.push_back({gap.index, base.t_s.size()});
  }
  return out;
}

bool keeps_step(const TimeBase& base, const std::vector<Piece>& pieces, double step_s) {
  constexpr double kMost = 0.5, kMean = 0.01;  // of a step
  double deviation = 0.0;
  std::size_t n = 0;
  for (const Piece& piece : pieces)
    for (std::size_t i = piece.first + 1; i < piece.end; ++i, ++n) {
      const double difference = std::fabs(base.t_s[i] - base.t_s[i - 1] - step_s);
      if (difference > kMost * step_s) return false;
      deviation += difference;
    }
  return n == 0 || deviation / static_cast<double>(n) <= kMean * step_s;
}

/// Instants of the first and the last row of a piece on the line through all its stamps, and how far the farthest stamp is from it.
struct Line {
  double first_s = 0.0, last_s = 0.0, step_s = 0.0, scatter_s = 0.0;
};

Line line_through(const std::vector<double>& t, const Piece& piece, double step_s) {
  const auto n = static_cast<double>(piece.end - piece.first);
  const double middle = 0.5 * (n - 1.0);
  double mean_s = 0.0, rt = 0.0;
  for (std::size_t i = piece.first; i < piece.end; ++i) mean_s += (t[i] - t[piece.first]) / n;
  for (std::size_t i = piece.first; i < piece.end; ++i) rt += (static_cast<double>(i - piece.first) - middle) * (t[i] - t[piece.first] - mean_s);
  Line line;
  line.step_s = n > 1.0 ? 12.0 * rt / (n * (n * n - 1.0)) : step_s;
  line.first_s = t[piece.first] + mean_s - middle * line.step_s;
  line.last_s = line.first_s + (n - 1.0) * line.step_s;
  for (std::size_t i = piece.first; i < piece.end; ++i)
    line.scatter_s = std::max(line.scatter_s, std::fabs(t[i] - line.first_s - static_cast<double>(i - piece.first) * line.step_s));
  return line;
}

/// The lines of all pieces, or none where one of them is not an even clock with stamps that scatter.
std::vector<Line> even_clock(const std::vector<double>& t, const std::vector<Piece>& pieces, double step_s) {
  constexpr double kFarthest = 1.0, kSameRate = 0.02;  // periods
  constexpr std::size_t kTells = 50;                   // rows: a shorter piece has no rate of its own
  std::vector<Line> lines;
  for (const Piece& piece : pieces) {
    lines.push_back(line_through(t, piece, step_s));
    if (lines.back().scatter_s > kFarthest * step_s) return {};
    if (piece.end - piece.first >= kTells && std::fabs(lines.back().step_s / step_s - 1.0) > kSameRate) return {};
  }
  return lines;
}

double whole_where_near(double rate_Hz, double near) {
  const double whole = std::round(rate_Hz);
  return whole > 0.0 && std::fabs(rate_Hz - whole) < near * rate_Hz ? whole : rate_Hz;
}

/// Of all pieces, each by what it knows of the slope (its rows cubed).
double rate_of(const std::vector<Line>& lines, const std::vector<Piece>& pieces, double rate_Hz) {
  double weight = 0.0, step_s = 0.0, scatter_s = 0.0;
  for (std::size_t k = 0; k < lines.size(); ++k) {
    const double w = std::pow(static_cast<double>(pieces[k].end - pieces[k].first), 3.0);
    weight += w;
    step_s += w * lines[k].step_s;
    scatter_s = std::max(scatter_s, lines[k].scatter_s);
  }
  step_s /= weight;
  const double uncertainty = scatter_s * rate_Hz * std::sqrt(12.0 / weight);
  return whole_where_near(1.0 / step_s, std::max(kNearWhole, 3.0 * uncertainty));
}

void add_lost(EquidistantGrid& grid, std::size_t held, double from_s, double to_s) {
  for (long long k = std::llround((to_s - from_s) * grid.rate_Hz) - 1; k > 0; --k) grid.rows.push_back({static_cast<std::uint32_t>(held), true});
}

void add_rows(EquidistantGrid& grid, const Piece& piece) {
  for (std::size_t i = piece.first; i < piece.end; ++i) grid.rows.push_back({static_cast<std::uint32_t>(i), false});
}

void hold(EquidistantGrid& grid, const std::vector<double>& t, double step_s, double periods) {
  std::size_t row = 0;
  for (std::size_t k = 0, n = static_cast<std::size_t>(periods + 1e-6); k < n; ++k) {
    const double now = t.front() + static_cast<double>(k) * step_s;
    while (row + 1 < t.size() && t[row + 1] <= now + 1e-9) ++row;
    grid.rows.push_back({static_cast<std::uint32_t>(row), now - t[row] > 1.5 * step_s});
  }
}

}  // namespace

Result<EquidistantGrid> equidistant_grid(const TimeBase& base, const std::string& where) {
  const auto& t = base.t_s;
  double rate_Hz = base.nominal_rate_Hz;
  if (t.size() < 2)
    return fail(ErrorCode::config, "the record has only " + std::to_string(t.size()) + (t.size() == 1 ? " sample" : " samples"), where, "record some seconds at least");
  if (rate_Hz <= 0.0)
    return fail(ErrorCode::config, "the record has no sample rate: its clock is not uniform", where, "resample it to the rate of the firmware first");
  rate_Hz = whole_where_near(rate_Hz, kNearWhole);
  const double periods = (t.back() - t.front()) * rate_Hz + 1.0;
  // Every row of a gap is held in memory: one wild time would ask for all that there is.
  for (std::size_t i = 1; i < t.size(); ++i)
    if ((t[i] - t[i - 1]) * rate_Hz > kLongestGap_samples)
      return fail(ErrorCode::config,
                  fmt::format("a gap of {:.6g} s before sample {} (t_s = {}): more than {:.0e} lost samples are no loss", t[i] - t[i - 1], i + 1,
                              shortest(t[i]), kLongestGap_samples),
                  where, "correct that time, or cut the record there");
  if (periods > 4e9) return fail(ErrorCode::config, "the record is too long to be replayed: more than 4e9 samples", where, "cut it into parts");

  EquidistantGrid grid;
  grid.rate_Hz = rate_Hz;
  const std::vector<Piece> pieces = pieces_of(base);
  if (keeps_step(base, pieces, 1.0 / rate_Hz)) {
    for (const Piece& piece : pieces) {
      if (piece.first > 0) add_lost(grid, piece.first - 1, t[piece.first - 1], t[piece.first]);
      add_rows(grid, piece);
    }
  } else if (const std::vector<Line> lines = even_clock(t, pieces, 1.0 / rate_Hz); !lines.empty()) {
    grid.kind = Kind::on_a_line;
    grid.rate_Hz = rate_of(lines, pieces, rate_Hz);
    for (std::size_t k = 0; k < pieces.size(); ++k) {
      if (k > 0) add_lost(grid, pieces[k].first - 1, lines[k - 1].last_s, lines[k].first_s);
      add_rows(grid, pieces[k]);
      grid.scatter_s = std::max(grid.scatter_s, lines[k].scatter_s);
    }
  } else {
    grid.kind = Kind::held;
    hold(grid, t, 1.0 / rate_Hz, periods);
  }
  grid.lost = static_cast<std::size_t>(std::ranges::count_if(grid.rows, [](const GridRow& row) { return row.lost; }));
  return grid;
}

}  // namespace forcegate
