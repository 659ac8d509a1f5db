#include "rigs/emulated/hidden/difference.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

namespace forcegate::hidden {

const std::vector<double>& column_of(const RecordData& record, Measure measure) {
  return measure == Measure::voltage ? record.voltage_V : record.force_unrounded_N;
}

Difference difference(const std::vector<RecordData>& with, const std::vector<RecordData>& without,
                      Measure measure) {
  double n = 0, sx = 0, sxx = 0, sd = 0, sxd = 0, sdd = 0;
  Difference out;
  for (std::size_t r = 0; r < with.size(); ++r) {
    const auto &a = column_of(with[r], measure), &b = column_of(without[r], measure);
    double square = 0, count = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
      const double d = a[i] - b[i], x = b[i];
      if (!std::isfinite(d)) continue;
      n += 1, sx += x, sxx += x * x, sd += d, sxd += x * d, sdd += d * d;
      square += d * d, count += 1;
    }
    out.record_rms.push_back(count > 0 ? std::sqrt(square / count) : 0.0);
  }
  if (n < 2 || sdd == 0.0) return out;
  const double cxx = sxx - sx * sx / n, gain = cxx > 0 ? (sxd - sx * sd / n) / cxx : 0.0;
  const double offset = (sd - gain * sx) / n;
  out.plain_rms = std::sqrt(sdd / n);
  std::vector<double> squares;
  double held_square = 0, held_count = 0;
  for (std::size_t r = 0; r < with.size(); ++r) {
    const auto &a = column_of(with[r], measure), &b = column_of(without[r], measure);
    double square = 0, count = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
      const double e = a[i] - b[i] - gain * b[i] - offset;
      if (!std::isfinite(e)) continue;
      square += e * e, count += 1;
    }
    if (count > 0) squares.push_back(square / count);
    if (with[r].plan.heldout) held_square += square, held_count += count;
  }
  std::sort(squares.begin(), squares.end(), std::greater<>());
  const std::size_t third = std::max<std::size_t>(1, (squares.size() + 2) / 3);
  double total = 0;
  for (std::size_t k = 0; k < third; ++k) total += squares[k];
  out.rms = std::sqrt(total / static_cast<double>(third));
  out.heldout_rms = held_count > 0 ? std::sqrt(held_square / held_count) : out.rms;
  return out;
}

double span_of(const std::vector<RecordData>& records, Measure measure) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const RecordData& record : records)
    for (const double v : column_of(record, measure))
      if (std::isfinite(v)) low = std::min(low, v), high = std::max(high, v);
  return high > low ? high - low : 0.0;
}

}  // namespace forcegate::hidden
