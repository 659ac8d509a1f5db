#include "hil/trace/packets.h"

#include <cmath>

#include "hil/base/quantile.h"

namespace forcegate {
namespace {

constexpr std::size_t kFewestStamps = 4;

struct Packet {
  std::size_t first = 0, rows = 0;
  double stamp_s = 0.0;  ///< since the first stamp
};

std::vector<Packet> packets_of(const std::vector<double>& stamps_s) {
  std::vector<Packet> out;
  for (std::size_t i = 0; i < stamps_s.size(); ++i) {
    if (i == 0 || stamps_s[i] != stamps_s[i - 1]) out.push_back({i, 0, stamps_s[i] - stamps_s.front()});
    ++out.back().rows;
  }
  return out;
}

// How long a packet takes when nothing is lost, with half of it and a row to spare.
bool is_gap(double interval_s, std::size_t rows, double period_s) { return interval_s > (1.5 * static_cast<double>(rows) + 1.0) * period_s; }

// The interval that the rows of packet k fill: before its stamp, or behind it. Where there is none, the period decides.
struct Spread {
  const std::vector<Packet>& packets;
  bool stamp_is_first;
  double period_s = 0.0;

  bool has_interval(std::size_t k) const { return stamp_is_first ? k + 1 < packets.size() : k > 0; }
  double interval_s(std::size_t k) const {
    return stamp_is_first ? packets[k + 1].stamp_s - packets[k].stamp_s : packets[k].stamp_s - packets[k - 1].stamp_s;
  }
  std::size_t stamped_row(std::size_t k) const { return packets[k].first + (stamp_is_first ? 0 : packets[k].rows - 1); }

  double misfit_s() const {
    double sum = 0.0;
    for (std::size_t k = 0; k < packets.size(); ++k)
      if (has_interval(k)) sum += std::abs(interval_s(k) - static_cast<double>(packets[k].rows) * period_s);
    return sum;
  }
};

double period_of(const Spread& spread) {
  std::vector<double> each_s;
  for (std::size_t k = 0; k < spread.packets.size(); ++k)
    if (spread.has_interval(k)) each_s.push_back(spread.interval_s(k) / static_cast<double>(spread.packets[k].rows));
  const double typical_s = median(std::move(each_s));
  double time_s = 0.0, rows = 0.0;
  for (std::size_t k = 0; k < spread.packets.size(); ++k) {
    if (!spread.has_interval(k) || is_gap(spread.interval_s(k), spread.packets[k].rows, typical_s)) continue;
    time_s += spread.interval_s(k);
    rows += static_cast<double>(spread.packets[k].rows);
  }
  return rows > 0.0 ? time_s / rows : typical_s;
}

// Stamps that jitter with the way they were sent, of a clock that does not.
std::optional<std::vector<double>> on_one_line(const Spread& spread, std::size_t rows) {
  std::vector<double> intervals_s;
  double mean_row = 0.0, mean_s = 0.0, n = 0.0, rr = 0.0, rs = 0.0;
  for (std::size_t k = 0; k < spread.packets.size(); ++k) {
    if (spread.has_interval(k)) {
      intervals_s.push_back(spread.interval_s(k));
      if (is_gap(spread.interval_s(k), spread.packets[k].rows, spread.period_s)) return std::nullopt;
    }
    n += 1.0;
    const double row = static_cast<double>(spread.stamped_row(k)), dr = row - mean_row;
    mean_row += dr / n;
    mean_s += (spread.packets[k].stamp_s - mean_s) / n;
    rr += dr * (row - mean_row);
    rs += dr * (spread.packets[k].stamp_s - mean_s);
  }
  const double slope = rs / rr, most_s = median(std::move(intervals_s));
  const auto at = [&](std::size_t row) { return mean_s + slope * (static_cast<double>(row) - mean_row); };
  for (std::size_t k = 0; k < spread.packets.size(); ++k)
    if (std::abs(spread.packets[k].stamp_s - at(spread.stamped_row(k))) > most_s) return std::nullopt;
  std::vector<double> out(rows);
  for (std::size_t i = 0; i < rows; ++i) out[i] = at(i);
  return out;
}

bool stood_still(const Spread& spread, std::size_t rows) {
  std::size_t dense = 0;
  for (std::size_t k = 0; k < spread.packets.size(); ++k)
    if (spread.has_interval(k) && static_cast<double>(spread.packets[k].rows) > 2.0 * spread.interval_s(k) / spread.period_s + 1.0) dense += spread.packets[k].rows;
  return dense * 100 > rows;
}

std::vector<double> between_stamps(const Spread& spread, std::size_t rows) {
  std::vector<double> out;
  out.reserve(rows);
  for (std::size_t k = 0; k < spread.packets.size(); ++k) {
    const Packet& packet = spread.packets[k];
    const double n = static_cast<double>(packet.rows);
    const bool fills = spread.has_interval(k) && !is_gap(spread.interval_s(k), packet.rows, spread.period_s);
    const double step_s = fills ? spread.interval_s(k) / n : spread.period_s, last = spread.stamp_is_first ? 0.0 : n - 1.0;
    for (std::size_t i = 0; i < packet.rows; ++i) out.push_back(packet.stamp_s + (static_cast<double>(i) - last) * step_s);
  }
  return out;
}

}  // namespace

std::optional<std::vector<double>> spread_packets(const std::vector<double>& stamps_s, double declared_rate_Hz) {
  const std::vector<Packet> packets = packets_of(stamps_s);
  if (packets.size() < kFewestStamps) return std::nullopt;
  Spread behind{packets, false}, before{packets, true};
  behind.period_s = period_of(behind);
  before.period_s = period_of(before);
  Spread& spread = before.misfit_s() < behind.misfit_s() ? before : behind;
  constexpr double kAgrees = 1.25;
  if (const double ratio = declared_rate_Hz * spread.period_s; ratio > 1.0 / kAgrees && ratio < kAgrees) spread.period_s = 1.0 / declared_rate_Hz;
  std::optional<std::vector<double>> out = on_one_line(spread, stamps_s.size());
  if (!out && stood_still(spread, stamps_s.size())) return std::nullopt;
  if (!out) out = between_stamps(spread, stamps_s.size());
  for (double& t : *out) t += stamps_s.front();
  return out;
}

}  // namespace forcegate
