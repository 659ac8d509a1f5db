#include "hil/diagnose/laws/recorded_cause.h"

#include <cmath>

#include "hil/diagnose/laws/drift.h"
#include "hil/diagnose/laws/no_input.h"

namespace forcegate::diagnose {

namespace {

// RMS of tenths that a line in x, fitted to the other nine, leaves of y.
double left_out_by_line(const std::vector<double>& x, const std::vector<double>& y) {
  constexpr std::size_t kParts = 10;
  double square = 0.0;
  for (std::size_t part = 0; part < kParts; ++part) {
    const std::size_t from = part * y.size() / kParts, to = (part + 1) * y.size() / kParts;
    double n = 0.0, mx = 0.0, my = 0.0, xx = 0.0, xy = 0.0;
    for (std::size_t i = 0; i < y.size(); ++i)
      if (i < from || i >= to) n += 1.0, mx += x[i], my += y[i];
    mx /= n, my /= n;
    for (std::size_t i = 0; i < y.size(); ++i)
      if (i < from || i >= to) xx += (x[i] - mx) * (x[i] - mx), xy += (x[i] - mx) * (y[i] - my);
    const double slope = xx > 0.0 ? xy / xx : 0.0;
    double of_part = 0.0;
    for (std::size_t i = from; i < to; ++i) of_part += std::pow(y[i] - my - slope * (x[i] - mx), 2);
    square += of_part / static_cast<double>(to - from) / kParts;
  }
  return std::sqrt(square);
}

}  // namespace

bool tells_of_output(const Record& record, const char* channel) {
  constexpr double kClearly = 1.15;
  const Channel *U = output_of(record), *cause = record.trace.find(channel);
  if (U == nullptr || cause == nullptr || !movement_of(cause->value).stands_out()) return false;
  const std::vector<double>& t_s = record.trace.time_bases[U->time_base].t_s;
  const auto of_time = fit_drift(record.name, t_s, U->value);
  if (!of_time) return false;
  const auto [x, y] = means_of_pairs(at_times(record.trace.time_bases[cause->time_base].t_s, cause->value, t_s), U->value, kDriftBlocks);
  return !y.empty() && kClearly * left_out_by_line(x, y) < of_time->fits.front().left_out_rms;
}

}  // namespace forcegate::diagnose
