#include "hil/diagnose/answer/residual_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "hil/base/parallel.h"
#include "hil/base/plain_number.h"
#include "hil/diagnose/answer/residual_coordinates.h"

namespace forcegate::diagnose {

namespace {

constexpr std::size_t kCells = 16, kCellsOfTurn = 36;
constexpr std::size_t kBlocks = 12;  // of a record
constexpr std::size_t kFewestRows = 200;

using PerRow = std::vector<std::vector<double>>;  // per record

// Between cells of as many rows each; values that many rows share stay in one cell.
std::vector<double> quantile_edges(std::vector<double> values) {
  std::vector<double> out;
  auto rest = values.begin();
  for (std::size_t k = 1; k < kCells; ++k) {
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(values.size() * k / kCells);
    std::nth_element(rest, at, values.end());
    rest = at;
    if (out.empty() || *at > out.back()) out.push_back(*at);
  }
  return out;
}

// A wheel rests at few angles and passes the others: by rows these would be in few cells.
std::vector<double> edges_of_turn(std::vector<double>) {
  std::vector<double> out;
  for (std::size_t k = 1; k < kCellsOfTurn; ++k) out.push_back(std::numbers::pi * (2.0 * static_cast<double>(k) / kCellsOfTurn - 1.0));
  return out;
}

struct Sum {
  double n = 0.0, e = 0.0, x = 0.0;

  void add(double residual, double value) { n += 1.0, e += residual, x += value; }
};

// Sums per cell, in all and in every block of every record.
struct CellSums {
  std::vector<Sum> total;
  std::vector<std::array<std::vector<Sum>, kBlocks>> block;
  double square = 0.0;  // of all rows, with those where the coordinate does not apply
};

CellSums cell_sums(const PerRow& value, const PerRow& residual, const std::vector<double>& edges) {
  CellSums out;
  out.total.resize(edges.size() + 1);
  out.block.resize(residual.size());
  for (std::size_t k = 0; k < residual.size(); ++k) {
    out.block[k].fill(std::vector<Sum>(out.total.size()));
    for (std::size_t j = 0; j < residual[k].size(); ++j) {
      const double e = residual[k][j], x = value[k][j];
      out.square += e * e;
      if (!std::isfinite(x)) continue;
      const auto cell = static_cast<std::size_t>(std::ranges::upper_bound(edges, x) - edges.begin());
      out.block[k][j * kBlocks / residual[k].size()][cell].add(e, x);
      out.total[cell].add(e, x);
    }
  }
  return out;
}

// A block is foretold by all other records or, where `by_own_record`, by all other blocks; means of few rows are drawn to 0.
double foretold_share(const CellSums& sums, bool by_own_record) {
  constexpr double kFewest = 20.0;
  double gained = 0.0;
  for (const auto& record : sums.block)
    for (std::size_t b = 0; b < kBlocks; ++b)
      for (std::size_t cell = 0; cell < sums.total.size(); ++cell) {
        const Sum& here = record[b][cell];
        if (here.n == 0.0) continue;
        Sum other = sums.total[cell];
        for (std::size_t q = 0; q < kBlocks; ++q)
          if (!by_own_record || q == b) other.n -= record[q][cell].n, other.e -= record[q][cell].e;
        if (other.n < kFewest) continue;
        const double foretold = other.e / (other.n + kFewest);
        gained += 2.0 * foretold * here.e - foretold * foretold * here.n;
      }
  return sums.square > 0.0 ? gained / sums.square : 0.0;
}

MapCell map_cell(const CellSums& sums, std::size_t cell) {
  const Sum& total = sums.total[cell];
  MapCell out{.n = static_cast<int>(total.n)};
  if (out.n == 0) return out;
  out.x = total.x / total.n;
  out.mean = total.e / total.n;
  double spread = 0.0;
  for (const auto& record : sums.block)
    for (const std::vector<Sum>& block : record) {
      const Sum& s = block[cell];
      if (s.n == 0.0) continue;
      ++out.blocks;
      const double d = s.e - out.mean * s.n;
      spread += d * d;
    }
  out.standard_error = std::sqrt(spread) / total.n;
  return out;
}

std::string sentence_of(const ResidualMap& map, const std::string& unit) {
  constexpr int kFewestBlocks = 3;
  const MapCell* largest = nullptr;
  for (const MapCell& c : map.cells)
    if (c.blocks >= kFewestBlocks && std::abs(c.mean) > 2.0 * c.standard_error && (largest == nullptr || std::abs(c.mean) > std::abs(largest->mean))) largest = &c;
  if (largest == nullptr) return "no cell of " + map.coordinate + " stands out of its scatter";
  const PrintedUnit printed = printed_unit(unit);
  const bool logarithm = map.unit == kLogOfTime;
  const PrintedUnit at = map.unit == "S" ? printed_unit(map.unit) : PrintedUnit{1.0, logarithm ? "s" : map.unit};  // no sensor conducts a siemens
  return fmt::format("{:+.3g} {} where {} is about {:.3g} {}", largest->mean * printed.factor, printed.name, map.coordinate,
                     at.factor * (logarithm ? seconds_of_log(largest->x) : largest->x), at.name);
}

// `edges`: of the cells, made of the finite values.
ResidualMap map_of(const ResidualCoordinate& c, const std::vector<std::vector<MappedRow>>& rows, const PerRow& residual, const std::string& unit,
                   std::vector<double> (*edges)(std::vector<double>)) {
  ResidualMap map{.coordinate = c.name, .group = c.group, .unit = c.unit, .cells = {}, .sentence = {}};
  PerRow value(rows.size());
  std::vector<double> all;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    value[k].reserve(rows[k].size());
    for (const MappedRow& row : rows[k])
      if (const double x = value[k].emplace_back(c.of(row)); std::isfinite(x)) all.push_back(x);
  }
  if (all.size() < kFewestRows) return map;
  const CellSums sums = cell_sums(value, residual, edges(std::move(all)));
  constexpr std::size_t kFewestRecords = 3;
  map.share = foretold_share(sums, map.group == "time" || residual.size() < kFewestRecords);
  for (std::size_t cell = 0; cell < sums.total.size(); ++cell) map.cells.push_back(map_cell(sums, cell));
  map.sentence = sentence_of(map, unit);
  return map;
}

}  // namespace

std::vector<ResidualMap> residual_maps(const Workspace& w, const PerRow& residual, unsigned threads) {
  const std::vector<std::vector<MappedRow>> rows = mapped_rows(w, w.output, threads);
  const std::vector<ResidualCoordinate> all = residual_coordinates(w);
  std::vector<ResidualMap> out(all.size());
  parallel_for(all.size(), threads, [&](std::size_t c) { out[c] = map_of(all[c], rows, residual, w.output.unit, quantile_edges); });
  std::erase_if(out, [](const ResidualMap& map) { return map.cells.empty(); });
  std::ranges::stable_sort(out, std::ranges::greater{}, &ResidualMap::share);
  return out;
}

ResidualMap rig_map_of_angle(const Workspace& w, const PerRow& residual_N) {
  return map_of(wheel_angle(), mapped_rows(w, w.rig, 1), residual_N, "N", edges_of_turn);
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
