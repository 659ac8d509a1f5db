#include "hil/diagnose/residual_map.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "hil/base/plain_number.h"
#include "hil/model/rows.h"

namespace forcegate::diagnose {

namespace {

struct Coordinate {
  const char* name;
  const char* group;
  const char* unit;
  std::vector<std::vector<double>> value;  ///< per record, per chosen row; NaN where it does not apply
};

// Turning points with a prominence of 5 % of the span: last extremum and time since it.
void history(const RecordInput& r, double prominence, std::vector<double>& last, std::vector<double>& since) {
  last.assign(r.rows(), r.F_N.empty() ? 0.0 : r.F_N[0]);
  since.assign(r.rows(), 0.0);
  double high = r.F_N[0], low = r.F_N[0], turn = r.F_N[0], turn_s = r.t_s[0], high_s = turn_s, low_s = turn_s;
  int direction = 0;
  for (std::size_t i = 0; i < r.rows(); ++i) {
    const double F = r.F_N[i];
    if (F > high) {
      high = F;
      high_s = r.t_s[i];
    }
    if (F < low) {
      low = F;
      low_s = r.t_s[i];
    }
    if (direction >= 0 && high - F > prominence) {
      direction = -1;
      turn = high;
      turn_s = high_s;
      low = F;
      low_s = r.t_s[i];
    } else if (direction <= 0 && F - low > prominence) {
      direction = 1;
      turn = low;
      turn_s = low_s;
      high = F;
      high_s = r.t_s[i];
    }
    last[i] = turn;
    since[i] = std::log10(1.0 + r.t_s[i] - turn_s);
  }
}

std::vector<Coordinate> coordinates(const Workspace& w, const ResidualChannel& channel) {
  std::vector<Coordinate> out = {{"force", "force", "N", {}},
                                 {"force while loading", "history", "N", {}},
                                 {"force while unloading", "history", "N", {}},
                                 {"rate", "rate", "N/s", {}},
                                 {"size of the rate", "rate", "N/s", {}},
                                 {"last turning point", "history", "N", {}},
                                 {"time since the last turn", "history", "log10 s", {}},
                                 {"time in the record", "time", "s", {}},
                                 {"campaign time", "time", "s", {}},
                                 {"load done", "history", "N", {}},
                                 {"output", "force", w.output.unit.c_str(), {}},
                                 {"cycle frequency", "frequency", "Hz", {}}};
  if (w.input.has_temp) {
    out.push_back({"temperature", "temperature", "degC", {}});
  }
  if (w.input.has_theta) {
    out.push_back({"angle", "angle", "rad", {}});
  }
  if (w.input.has_drive) out.push_back({"drive", "drive", "V", {}});
  for (std::size_t k = 0; k < channel.record_of.size(); ++k) {
    const RecordInput& r = w.input.records[channel.record_of[k]];
    std::vector<double> last, since;
    history(r, 0.05 * w.input.range_N, last, since);
    for (Coordinate& c : out) {
      std::vector<double> v;
      const std::string name = c.name;
      for (std::size_t i : channel.rows[k].row) {
        const double rate = r.rate_N_per_s[i];
        double x = kMissing;
        if (name == "force")
          x = r.F_N[i];
        else if (name == "force while loading")
          x = rate > 0.0 ? r.F_N[i] : kMissing;
        else if (name == "force while unloading")
          x = rate < 0.0 ? r.F_N[i] : kMissing;
        else if (name == "rate")
          x = rate;
        else if (name == "size of the rate")
          x = std::abs(rate);
        else if (name == "last turning point")
          x = last[i];
        else if (name == "time since the last turn")
          x = since[i];
        else if (name == "time in the record")
          x = r.t_s[i];
        else if (name == "campaign time")
          x = r.start_s + r.t_s[i];
        else if (name == "load done")
          x = r.travel_before_N + r.travel_N[i];
        else if (name == "output")
          x = r.U_V[i];
        else if (name == "cycle frequency")
          x = r.dynamic ? r.f_Hz : kMissing;
        else if (name == "temperature")
          x = r.temp_C.empty() ? kMissing : r.temp_C[i];
        else if (name == "angle")
          x = r.theta_rad.empty() ? kMissing : std::remainder(r.theta_rad[i], 6.283185307179586);
        else if (name == "drive")
          x = r.drive_mean_V;
        v.push_back(x);
      }
      c.value.push_back(std::move(v));
    }
  }
  return out;
}

constexpr int kCells = 16;
constexpr std::size_t kBlocks = 12;

ResidualMap map_of(const Coordinate& c, const std::vector<std::vector<double>>& residual,
                   const std::string& unit) {
  ResidualMap map;
  map.coordinate = c.name;
  map.group = c.group;
  map.unit = c.unit;
  std::vector<double> all;
  for (const auto& v : c.value)
    for (double x : v)
      if (std::isfinite(x)) all.push_back(x);
  if (all.size() < 200) return map;
  std::sort(all.begin(), all.end());
  std::vector<double> edge;
  for (int k = 1; k < kCells; ++k) {
    const double e = all[all.size() * static_cast<std::size_t>(k) / kCells];
    if (edge.empty() || e > edge.back()) edge.push_back(e);
  }
  const std::size_t n_cells = edge.size() + 1;
  const auto cell_of = [&](double x) {
    return static_cast<std::size_t>(std::upper_bound(edge.begin(), edge.end(), x) - edge.begin());
  };
  // sums per block of rows and cell; a block is predicted by all blocks of other records, or by the other parity of
  // its own record where there is only one
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
      if (!std::isfinite(c.value[k][j])) continue;
      const std::size_t cell = cell_of(c.value[k][j]);
      Sum& s = sum[k][j * kBlocks / residual[k].size()][cell];
      s.n += 1.0;
      s.e += e;
      s.x += c.value[k][j];
      total[cell].n += 1.0;
      total[cell].e += e;
      total[cell].x += c.value[k][j];
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
          if (!own_record || (q >= b ? q - b : b - q) <= 0) {
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
      std::snprintf(text, sizeof text, "%+.3g %s where %s is about %.3g %s", out.mean * printed.factor,
                    printed.name.c_str(), c.name, out.x, c.unit);
      map.sentence = text;
    }
  }
  if (map.sentence.empty()) map.sentence = std::string("no cell of ") + c.name + " stands out of its scatter";
  return map;
}

}  // namespace

std::vector<std::vector<double>> residual_rows(const ResidualChannel& channel, const MixedFit& fit) {
  std::vector<std::vector<double>> out;
  const MixedProblem& p = channel.problem;
  for (std::size_t k = 0; k < channel.rows.size(); ++k) {
    const auto& A = channel.rows[k].matrix;
    Eigen::VectorXd e = A.col(p.y_index()) - A.leftCols(p.nz) * fit.zeta[k] -
                        A.leftCols(p.n_fixed) * fit.coefficient.head(p.n_fixed);
    for (std::size_t b = 0; b < fit.columns.size(); ++b)
      e -= A.col(p.nz + fit.columns[b]) * fit.coefficient[p.n_fixed + static_cast<Eigen::Index>(b)];
    e *= channel.scale;
    out.emplace_back(e.data(), e.data() + e.size());
  }
  return out;
}

std::vector<ResidualMap> residual_maps(const Workspace& w, const ResidualChannel& channel,
                                       const std::vector<std::vector<double>>& residual) {
  std::vector<ResidualMap> out;
  for (const Coordinate& c : coordinates(w, channel)) {
    ResidualMap map = map_of(c, residual, channel.unit);
    if (!map.cells.empty()) out.push_back(std::move(map));
  }
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
