#include "hil/model/impedance/force_models.h"

namespace forcegate::impedance {
namespace {

template <class Get>
LineModel fit_line(std::span<const ForceReading> readings, Get x_of) {
  const double n = static_cast<double>(readings.size());
  double x_mean = 0, y_mean = 0, xx = 0, xy = 0;
  for (const ForceReading& r : readings) x_mean += x_of(r) / n, y_mean += r.force_N / n;
  for (const ForceReading& r : readings) {
    const double x = x_of(r) - x_mean;
    xx += x * x;
    xy += x * (r.force_N - y_mean);
  }
  const double slope = xy / xx;
  return {slope, y_mean - slope * x_mean};
}

}  // namespace

LineModel fit_conductance(std::span<const ForceReading> readings) {
  return fit_line(readings, [](const ForceReading& r) { return r.output_V; });
}

LineModel fit_capacitance(std::span<const ForceReading> readings) {
  return fit_line(readings, [](const ForceReading& r) { return r.capacitance_F; });
}

double mean_squared_error_N2(std::span<const ForceReading> readings, const ForceModel& model) {
  double squares = 0.0;
  for (const ForceReading& r : readings) {
    const double error_N = model(r) - r.force_N;
    squares += error_N * error_N;
  }
  return squares / static_cast<double>(readings.size());
}

}  // namespace forcegate::impedance
