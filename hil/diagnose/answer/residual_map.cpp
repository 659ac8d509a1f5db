#include "hil/diagnose/answer/residual_map.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "hil/base/parallel.h"
#include "hil/base/plain_number.h"
#include "hil/diagnose/answer/force_turns.h"
#include "hil/model/rows.h"

namespace forcegate::diagnose {

namespace {

struct Turn {
  double force_N, time_s;
};

// Of every row: the last turning point before it, with a prominence of 5 % of the span.
std::vector<Turn> last_turns(const RecordInput& r, double prominence) {
  std::vector<Turn> out;
  out.reserve(r.rows());
  Turn last{r.F_N[0], r.t_s[0]};
  for (const ForceTurn& turn : force_turns(r.F_N, prominence)) {
    out.resize(turn.seen_at, last);
    last = {r.F_N[turn.row], r.t_s[turn.row]};
  }
  out.resize(r.rows(), last);
  return out;
}

struct Row {
  const RecordInput& record;
  std::size_t i;
  Turn turn;
};

struct Coordinate {
  const char* name;
  const char* group;
  const char* unit;
  double (*of)(const Row&);  ///< NaN where it does not apply
};

std::vector<Coordinate> coordinates(const Workspace& w) {
  constexpr double kTurn_rad = 6.283185307179586;
  std::vector<Coordinate> out = {
      {"force", "force", "N", [](const Row& r) { return r.record.F_N[r.i]; }},
      {"force while loading", "history", "N",
       [](const Row& r) { return r.record.rate_N_per_s[r.i] > 0.0 ? r.record.F_N[r.i] : kMissing; }},
      {"force while unloading", "history", "N",
       [](const Row& r) { return r.record.rate_N_per_s[r.i] < 0.0 ? r.record.F_N[r.i] : kMissing; }},
      {"rate", "rate", "N/s", [](const Row& r) { return r.record.rate_N_per_s[r.i]; }},
      {"size of the rate", "rate", "N/s", [](const Row& r) { return std::abs(r.record.rate_N_per_s[r.i]); }},
      {"last turning point", "history", "N", [](const Row& r) { return r.turn.force_N; }},
      {"time since the last turn", "history", kLogOfTime,
       [](const Row& r) { return std::log10(1.0 + r.record.t_s[r.i] - r.turn.time_s); }},
      {"time in the record", "time", "s", [](const Row& r) { return r.record.t_s[r.i]; }},
      {"campaign time", "time", "s", [](const Row& r) { return r.record.start_s + r.record.t_s[r.i]; }},
      {"load done", "history", "N",
       [](const Row& r) { return r.record.travel_before_N + r.record.travel_N[r.i]; }},
      {"output", "force", w.output.unit.c_str(), [](const Row& r) { return r.record.U_V[r.i]; }},
      {"cycle frequency", "frequency", "Hz",
       [](const Row& r) { return r.record.dynamic ? r.record.f_Hz : kMissing; }}};
  if (w.input.has_temp)
    out.push_back({"temperature", "temperature", "degC",
                   [](const Row& r) { return r.record.temp_C.empty() ? kMissing : r.record.temp_C[r.i]; }});
  if (w.input.has_theta)
    out.push_back({"angle", "angle", "rad", [](const Row& r) {
                     return r.record.theta_rad.empty() ? kMissing
                                                       : std::remainder(r.record.theta_rad[r.i], kTurn_rad);
                   }});
  if (w.input.has_drive)
    out.push_back({"drive", "drive", "V", [](const Row& r) { return r.record.drive_mean_V; }});
  return out;
}

constexpr int kCells = 16;
constexpr std::size_t kBlocks = 12;

// `value`: of the coordinate, per record and chosen row.
ResidualMap map_of(const Coordinate& c, const std::vector<std::vector<double>>& value,
                   const std::vector<std::vector<double>>& residual, const std::string& unit) {
  ResidualMap map;
  map.coordinate = c.name;
  map.group = c.group;
  map.unit = c.unit;
  std::vector<double> all;
  for (const auto& v : value)
    for (double x : v)
      if (std::isfinite(x)) all.push_back(x);
  if (all.size() < 200) return map;
  std::vector<double> edge;
  auto rest = all.begin();
  for (int k = 1; k < kCells; ++k) {
    const auto at =
        all.begin() + static_cast<std::ptrdiff_t>(all.size() * static_cast<std::size_t>(k) / kCells);
    std::nth_element(rest, at, all.end());
    rest = at;
    if (edge.empty() || *at > edge.back()) edge.push_back(*at);
  }
  const std::size_t n_cells = edge.size() + 1;
  const auto cell_of = [&](double x) {
    return static_cast<std::size_t>(std::upper_bound(edge.begin(), edge.end(), x) - edge.begin());
  };
  // sums per block of rows and cell; a block is predicted by all blocks of other records, or by the other blocks
  // of its own record where there is only one
  struct Sum {
    double n = 0.0, e = 0.0, x = 0.0;
  };
  const std::size_t n_records = residual.size();
  std::vector<std::vector<std::vector<Sum>>> sum(
      n_records, std::vector<std::vector<Sum>>(kBlocks, std::vector<Sum>(n_cells)));
  std::vector<Sum> total(n_cells);
  double square = 0.0;
  for (std::size_t k = 0; k < n_records; ++k)
    for (std::size_t j = 0; j < residual[k].size(); ++j) {
      const double e = residual[k][j];
      square += e * e;
      if (!std::isfinite(value[k][j])) continue;
      const std::size_t cell = cell_of(value[k][j]);
      Sum& s = sum[k][j * kBlocks / residual[k].size()][cell];
      s.n += 1.0;
      s.e += e;
      s.x += value[k][j];
      total[cell].n += 1.0;
      total[cell].e += e;
      total[cell].x += value[k][j];
    }
  const bool own_record = std::string(c.group) == "time" || n_records < 3;
  double gained = 0.0;
  for (std::size_t k = 0; k < n_records; ++k)
    for (std::size_t b = 0; b < kBlocks; ++b)
      for (std::size_t cell = 0; cell < n_cells; ++cell) {
        const Sum& here = sum[k][b][cell];
        if (here.n == 0.0) continue;
        Sum other = total[cell];
        for (std::size_t q = 0; q < kBlocks; ++q)
          if (!own_record || q == b) {
            other.n -= sum[k][q][cell].n;
            other.e -= sum[k][q][cell].e;
          }
        if (other.n < 20.0) continue;
        const double prediction = other.e / (other.n + 20.0);
        gained += 2.0 * prediction * here.e - prediction * prediction * here.n;
      }
  map.share = square > 0.0 ? gained / square : 0.0;
  double largest = 0.0;
  for (std::size_t cell = 0; cell < n_cells; ++cell) {
    MapCell out;
    out.n = static_cast<int>(total[cell].n);
    if (out.n > 0) {
      out.x = total[cell].x / total[cell].n;
      out.mean = total[cell].e / total[cell].n;
      double spread = 0.0;
      for (std::size_t k = 0; k < n_records; ++k)
        for (std::size_t b = 0; b < kBlocks; ++b) {
          const Sum& s = sum[k][b][cell];
          if (s.n == 0.0) continue;
          ++out.blocks;
          const double d = s.e - out.mean * s.n;
          spread += d * d;
        }
      out.standard_error = std::sqrt(spread) / total[cell].n;
    }
    map.cells.push_back(out);
    if (out.blocks >= 3 && std::abs(out.mean) > std::abs(largest) &&
        std::abs(out.mean) > 2.0 * out.standard_error) {
      largest = out.mean;
      char text[160];
      const PrintedUnit printed = printed_unit(unit);
      const bool logarithm = map.unit == kLogOfTime;
      std::snprintf(text, sizeof text, "%+.3g %s where %s is about %.3g %s", out.mean * printed.factor,
                    printed.name.c_str(), c.name, logarithm ? seconds_of_log(out.x) : out.x, logarithm ? "s" : c.unit);
      map.sentence = text;
    }
  }
  if (map.sentence.empty()) map.sentence = std::string("no cell of ") + c.name + " stands out of its scatter";
  return map;
}

}  // namespace

std::vector<ResidualMap> residual_maps(const Workspace& w, const std::vector<std::vector<double>>& residual, unsigned threads) {
  const ResidualChannel& channel = w.output;
  const std::size_t n = channel.record_of.size();
  std::vector<std::vector<Turn>> turns(n);
  parallel_for(n, threads, [&](std::size_t k) {
    turns[k] = last_turns(w.input.records[channel.record_of[k]], 0.05 * w.input.range_N);
  });
  const std::vector<Coordinate> all = coordinates(w);
  std::vector<ResidualMap> out(all.size());
  parallel_for(all.size(), threads, [&](std::size_t c) {
    std::vector<std::vector<double>> value(n);
    for (std::size_t k = 0; k < n; ++k) {
      value[k].reserve(channel.rows[k].row.size());
      for (const std::size_t i : channel.rows[k].row)
        value[k].push_back(all[c].of({w.input.records[channel.record_of[k]], i, turns[k][i]}));
    }
    out[c] = map_of(all[c], value, residual, channel.unit);
  });
  std::erase_if(out, [](const ResidualMap& map) { return map.cells.empty(); });
  std::stable_sort(out.begin(), out.end(),
                   [](const ResidualMap& a, const ResidualMap& b) { return a.share > b.share; });
  return out;
}

double autocorrelated_share(const std::vector<std::vector<double>>& residual, std::size_t block) {
  double between = 0.0, total = 0.0;
  for (const auto& e : residual)
    for (std::size_t i = 0; i + block <= e.size(); i += block) {
      double sum = 0.0, square = 0.0;
      for (std::size_t j = i; j < i + block; ++j) {
        sum += e[j];
        square += e[j] * e[j];
      }
      const double n = static_cast<double>(block);
      // square of the mean, less what white noise of this size would give it
      between += (sum * sum - square) / (n - 1.0);
      total += square;
    }
  return total > 0.0 ? between / total : 0.0;
}

}  // namespace forcegate::diagnose
