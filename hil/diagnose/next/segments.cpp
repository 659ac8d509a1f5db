#include "hil/diagnose/next/segments.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace forcegate::diagnose {

namespace {

double triangle(double t, double period, double low, double high) {
  const double phase = std::fmod(t / period, 1.0);
  return low + (high - low) * (phase < 0.5 ? 2.0 * phase : 2.0 - 2.0 * phase);
}
double sine(double t, double f, double low, double high) {
  return 0.5 * (low + high) - 0.5 * (high - low) * std::cos(2.0 * std::numbers::pi * f * t);
}
double edge(double t, double at, double from, double to) { return t < at ? from : to + (from - to) * std::exp(-(t - at) / 0.02); }

}  // namespace

const std::vector<Segment>& segments() {
  static const std::vector<Segment> kSegments = {
      {"rest", "rest", 2.0, false, {}, [](double, double lo, double) { return lo; }, 0.0},
      {"hold for 10 s", "step", 0.5, false, {{"hold_s", 10}}, [](double t, double lo, double hi) { return t > 10 && t < 20 ? hi : lo; }, 0.0},
      {"hold for 100 s, then unload", "step", 4.0, false, {{"hold_s", 100}}, [](double t, double lo, double hi) { return t > 10 && t < 110 ? hi : lo; }, 0.0},
      {"hold for 10 min, then unload", "step", 16.0, false, {{"hold_s", 600}}, [](double t, double lo, double hi) { return t > 10 && t < 610 ? hi : lo; }, 0.0},
      {"holds at two levels", "staircase", 8.0, false, {{"hold_s", 120}}, [](double t, double lo, double hi) { return t < 120 ? lo : t < 240 ? 0.5 * (lo + hi) : t < 360 ? hi : lo; }, 0.0},
      {"slow triangle", "ramp", 4.0, false, {{"period_s", 120}}, [](double t, double lo, double hi) { return triangle(t, 120.0, lo, hi); }, 0.0},
      {"triangle", "ramp", 1.0, false, {{"period_s", 12}}, [](double t, double lo, double hi) { return triangle(t, 12.0, lo, hi); }, 0.0},
      {"fast triangle", "ramp", 0.5, false, {{"period_s", 1.2}}, [](double t, double lo, double hi) { return triangle(t, 1.2, lo, hi); }, 0.0},
      {"triangles at two speeds", "ramp", 3.0, false, {{"period_s", 120}, {"second_period_s", 6}}, [](double t, double lo, double hi) { return t < 120 ? triangle(t, 120.0, lo, hi) : triangle(t - 120, 6.0, lo, hi); }, 0.0},
      {"shrinking minor loops", "staircase", 3.0, false, {{"loops", 8}}, [](double t, double lo, double hi) { const double k = 1.0 - std::min(0.9, std::floor(t / 20.0) * 0.11), m = 0.5 * (lo + hi); return triangle(t, 20.0, m - 0.5 * k * (hi - lo), m + 0.5 * k * (hi - lo)); }, 0.0},
      {"chirp", "chirp", 2.0, false, {{"f_start_Hz", 0.05}, {"f_end_Hz", 5}}, [](double t, double lo, double hi) { return sine(1.0, 0.05 * 120.0 / std::log(100.0) * (std::pow(100.0, t / 120.0) - 1.0), lo, hi); }, 0.0},
      {"sines at 0.2 and 4 Hz", "multisine", 2.0, false, {{"f1_Hz", 0.2}, {"f2_Hz", 4}}, [](double t, double lo, double hi) { return sine(t, t < 60 ? 0.2 : 4.0, lo, hi); }, 0.0},
      {"fast edges", "step", 0.5, false, {{"edge_ms", 20}}, [](double t, double lo, double hi) { const double p = std::fmod(t, 4.0); return p < 2.0 ? edge(p, 0.5, lo, hi) : edge(p, 2.5, hi, lo); }, 0.0},
      {"fast edges at low and high load", "step", 1.0, false, {{"edge_ms", 20}}, [](double t, double lo, double hi) { const double p = std::fmod(t, 4.0), m = t < 30 ? lo : hi - 0.25 * (hi - lo), h = m + 0.25 * (hi - lo); return p < 2.0 ? edge(p, 0.5, m, h) : edge(p, 2.5, h, m); }, 0.0},
      {"fast edges at both ends of a long hold", "step", 16.0, false, {{"hold_s", 900}}, [](double t, double lo, double hi) { const double p = std::fmod(t, 4.0); return t < 30 || t > 930 ? (p < 2.0 ? edge(p, 0.5, lo, hi) : edge(p, 2.5, hi, lo)) : lo; }, 0.0},
      {"touch and release", "ramp", 1.0, false, {{"F_top_N", 0}}, [](double t, double lo, double hi) { (void)lo; return std::max(0.0, triangle(t, 15.0, -0.05 * hi, 0.12 * hi)); }, 0.0},
      {"small sine near zero", "sine", 1.0, false, {{"f_Hz", 0.5}}, [](double t, double lo, double hi) { return sine(t, 0.5, lo, lo + 0.15 * (hi - lo)); }, 0.0},
      {"heat at constant load", "rest", 15.0, false, {{"ramp_C", 10}}, [](double, double lo, double hi) { return 0.5 * (lo + hi); }, 10.0},
      {"repeat of the first ramp", "ramp", 2.0, false, {{"period_s", 60}}, [](double t, double lo, double hi) { return triangle(t, 60.0, lo, hi); }, 0.0},
      {"sine, then a jump of frequency", "jump", 6.0, true, {{"f1_Hz", 0.5}, {"f2_Hz", 2}}, [](double t, double lo, double hi) { return sine(t, t < 180 ? 0.5 : 2.0, lo, hi); }, 0.0, 180.0, std::log(4.0)},
  };
  return kSegments;
}

std::map<std::string, double> numbers_of(const Segment& segment, const RecordInput& played) {
  std::map<std::string, double> out = segment.numbers;
  if (const auto top = out.find("F_top_N"); top != out.end()) top->second = *std::ranges::max_element(played.fast_F_N);
  return out;
}

RecordInput simulate(const Workspace& w, const Segment& s) {
  RecordInput r;
  r.name = s.name;
  const double low = w.input.lowest_N + 0.05 * w.input.range_N, high = w.input.lowest_N + 0.95 * w.input.range_N;
  const double fast = 0.005;
  const auto per_row = std::max(4, static_cast<int>(std::ceil(60.0 * s.minutes / fast / 6000.0)));
  const auto n_rows = static_cast<std::size_t>(60.0 * s.minutes / fast / per_row);
  r.row_step_s = fast * per_row;
  r.duration_s = 60.0 * s.minutes;
  r.dynamic = s.dynamic;
  for (std::size_t i = 0; i <= n_rows; ++i) r.row_begin.push_back(static_cast<std::uint32_t>(i * static_cast<std::size_t>(per_row)));
  for (std::size_t i = 0; i < n_rows; ++i) {
    double F = 0.0, t = 0.0;
    for (int k = 0; k < per_row; ++k) {
      const double at = fast * static_cast<double>(i * static_cast<std::size_t>(per_row) + static_cast<std::size_t>(k));
      r.fast_t_s.push_back(at);
      r.fast_F_N.push_back(s.force(at, low, high));
      F += r.fast_F_N.back();
      t += at;
    }
    r.F_N.push_back(F / per_row);
    r.t_s.push_back(t / per_row);
  }
  r.U_V = r.F_N;
  for (double& u : r.U_V) u *= w.gain_V_per_N;
  r.ok.assign(n_rows, 1);
  r.rate_N_per_s.assign(n_rows, 0.0);
  r.travel_N.assign(n_rows, 0.0);
  for (std::size_t i = 1; i < n_rows; ++i) {
    r.rate_N_per_s[i] = (r.F_N[i] - r.F_N[i - 1]) / r.row_step_s;
    r.travel_N[i] = r.travel_N[i - 1] + std::abs(r.F_N[i] - r.F_N[i - 1]);
  }
  const RecordInput& last = w.input.records.back();
  r.index = r.recording = w.input.records.size();
  r.start_s = last.start_s + last.duration_s + 600.0;
  r.travel_before_N = w.input.travel_total_N;
  r.drive_mean_V = last.drive_mean_V;
  if (w.input.has_temp) {
    const double T = last.temp_C.empty() ? 23.0 : last.temp_C.back();
    for (std::size_t i = 0; i < n_rows; ++i)
      r.temp_C.push_back(T + s.temperature_C * static_cast<double>(i) / static_cast<double>(n_rows));
  }
  if (w.input.has_theta)
    for (std::size_t i = 0; i < n_rows; ++i) {
      r.theta_rad.push_back((r.rate_N_per_s[i] < 0.0 ? -1.0 : 1.0) *
                            std::acos(std::clamp(1.0 - 2.0 * (r.F_N[i] - low) / std::max(1e-9, high - low), -1.0, 1.0)));
      r.sin_theta.push_back(std::sin(r.theta_rad.back()));
      r.cos_theta.push_back(std::cos(r.theta_rad.back()));
    }
  r.F_min_N = s.dynamic ? low : 0.0;
  r.f_Hz = s.dynamic ? 0.5 : 0.0;
  r.A_N = 0.5 * (high - low);
  if (s.jump_log_ratio != 0.0) {
    r.frequency_jumps_s = {s.jump_s};
    r.jump_log_ratio = {s.jump_log_ratio};
  }
  set_decay(r, w.law);
  return r;
}

}  // namespace forcegate::diagnose
