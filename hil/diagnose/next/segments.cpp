#include "hil/diagnose/next/segments.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "hil/base/slug.h"

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

double edges(double t, double low, double high) {
  const double in_period = std::fmod(t, 4.0);
  return in_period < 2.0 ? edge(in_period, 0.5, low, high) : edge(in_period, 2.5, high, low);
}

ForceCourse hold(double for_s) {
  return [for_s](double t, double low, double high) { return t > 10.0 && t < 10.0 + for_s ? high : low; };
}

ForceCourse triangles(double period_s) {
  return [period_s](double t, double low, double high) { return triangle(t, period_s, low, high); };
}

ForceCourse triangles(double period_s, double until_s, double then_period_s) {
  return [=](double t, double low, double high) {
    return t < until_s ? triangle(t, period_s, low, high) : triangle(t - until_s, then_period_s, low, high);
  };
}

ForceCourse sines(double f_Hz, double until_s, double then_f_Hz) {
  return [=](double t, double low, double high) { return sine(t, t < until_s ? f_Hz : then_f_Hz, low, high); };
}

double at_low(double, double low, double) { return low; }

double at_middle(double, double low, double high) { return 0.5 * (low + high); }

double two_levels(double t, double low, double high) {
  return t < 120.0 || t >= 360.0 ? low : t < 240.0 ? at_middle(t, low, high) : high;
}

double minor_loops(double t, double low, double high) {
  const double share = 1.0 - std::min(0.9, std::floor(t / 20.0) * 0.11), middle = 0.5 * (low + high);
  return triangle(t, 20.0, middle - 0.5 * share * (high - low), middle + 0.5 * share * (high - low));
}

// From 0.05 to 5 Hz in 120 s, by the logarithm.
double chirp(double t, double low, double high) {
  const double cycles = 0.05 * 120.0 / std::log(100.0) * (std::pow(100.0, t / 120.0) - 1.0);
  return sine(1.0, cycles, low, high);
}

double edges_at_both_loads(double t, double low, double high) {
  const double from = t < 30.0 ? low : high - 0.25 * (high - low);
  return edges(t, from, from + 0.25 * (high - low));
}

double edges_around_a_hold(double t, double low, double high) { return t < 30.0 || t > 930.0 ? edges(t, low, high) : low; }

double touch_and_release(double t, double, double high) { return std::max(0.0, triangle(t, 15.0, -0.05 * high, 0.12 * high)); }

double small_sine(double t, double low, double high) { return sine(t, 0.5, low, low + 0.15 * (high - low)); }

// As many decimals as the files of forces have.
double rounded(double force_N) { return std::round(1e5 * force_N) / 1e5; }

Parameters rest_at(double share, double duration_s) {
  return [=](double low, double high) { return StimulusSpec{"rest", {{"level_N", rounded(low + share * (high - low))}, {"duration_s", duration_s}}, {}, {}}; };
}

Parameters step_for(double hold_s, double duration_s) {
  return [=](double low, double high) {
    return StimulusSpec{"step", {{"low_N", rounded(low)}, {"high_N", rounded(high)}, {"at_s", 10.0}, {"hold_s", hold_s}, {"duration_s", duration_s}}, {}, {}};
  };
}

Parameters ramps(double period_s, double cycles) {
  return [=](double low, double high) {
    return StimulusSpec{"ramp", {{"low_N", rounded(low)}, {"high_N", rounded(high)}, {"sweep_s", 0.5 * period_s}, {"cycles", cycles}}, {}, {}};
  };
}

// Amplitude and middle of a sine over a share of the range; its lowest force is the lower level, so that none is below 0.
std::map<std::string, double> swing(double low, double high, double share) {
  const double A = rounded(0.5 * share * (high - low));
  return {{"A_N", A}, {"m_N", rounded(rounded(low) + A)}};
}

StimulusSpec small_sine_of(double low, double high) {
  StimulusSpec out{"sine", swing(low, high, 0.15), {}, {}};
  out.numbers["f_Hz"] = 0.5;
  out.numbers["duration_s"] = 60.0;
  return out;
}

Parameters jump_of(double f_Hz, double then_f_Hz, double stretch_s) {
  return [=](double low, double high) {
    return StimulusSpec{"jump", swing(low, high, 1.0), {{"f_Hz", {f_Hz, then_f_Hz}}, {"stretch_s", {stretch_s, stretch_s}}}, {}};
  };
}

StimulusSpec two_levels_of(double low, double high) {
  return {"staircase",
          {{"dwell_s", 120.0}, {"transition_s", 0.0}, {"up_down", 0.0}},
          {{"levels_N", {rounded(low), rounded(0.5 * (low + high)), rounded(high), rounded(low)}}},
          {}};
}

std::vector<Segment> all_segments() {
  return {
      {.name = "rest", .kind = "rest", .minutes = 2.0, .parameters = rest_at(0.0, 120.0), .force = at_low},
      {.name = "hold for 10 s", .kind = "step", .minutes = 0.5, .parameters = step_for(10.0, 30.0), .force = hold(10.0)},
      {.name = "hold for 100 s, then unload", .kind = "step", .minutes = 4.0, .parameters = step_for(100.0, 240.0), .force = hold(100.0)},
      {.name = "hold for 10 min, then unload", .kind = "step", .minutes = 16.0, .parameters = step_for(600.0, 960.0), .force = hold(600.0)},
      {.name = "holds at two levels", .kind = "staircase", .minutes = 8.0, .parameters = two_levels_of, .force = two_levels},
      {.name = "slow triangle", .kind = "ramp", .minutes = 4.0, .parameters = ramps(120.0, 2.0), .force = triangles(120.0)},
      {.name = "triangle", .kind = "ramp", .minutes = 1.0, .parameters = ramps(12.0, 5.0), .force = triangles(12.0)},
      {.name = "fast triangle", .kind = "ramp", .minutes = 0.5, .parameters = ramps(1.2, 25.0), .force = triangles(1.2)},
      {.name = "triangles at two speeds", .kind = "ramp", .minutes = 3.0, .force = triangles(120.0, 120.0, 6.0)},
      {.name = "shrinking minor loops", .kind = "staircase", .minutes = 3.0, .force = minor_loops},
      {.name = "chirp", .kind = "chirp", .minutes = 2.0, .f_min_Hz = 0.05, .force = chirp},
      {.name = "sines at 0.2 and 4 Hz", .kind = "multisine", .minutes = 2.0, .f_min_Hz = 0.2, .parameters = jump_of(0.2, 4.0, 60.0), .force = sines(0.2, 60.0, 4.0)},
      {.name = "fast edges", .kind = "step", .minutes = 0.5, .force = edges},
      {.name = "fast edges at low and high load", .kind = "step", .minutes = 1.0, .force = edges_at_both_loads},
      {.name = "fast edges at both ends of a long hold", .kind = "step", .minutes = 16.0, .force = edges_around_a_hold},
      {.name = "touch and release", .kind = "ramp", .minutes = 1.0, .force = touch_and_release},
      {.name = "small sine near zero", .kind = "sine", .minutes = 1.0, .f_min_Hz = 0.5, .parameters = small_sine_of, .force = small_sine},
      {.name = "heat at constant load", .kind = "rest", .minutes = 15.0, .parameters = rest_at(0.5, 900.0), .force = at_middle, .temperature_C = 10.0},
      {.name = "repeat of the first ramp", .kind = "ramp", .minutes = 2.0, .parameters = ramps(60.0, 2.0), .force = triangles(60.0)},
      {.name = "sine, then a jump of frequency",
       .kind = "jump",
       .minutes = 6.0,
       .dynamic = true,
       .f_min_Hz = 0.5,
       .parameters = jump_of(0.5, 2.0, 180.0),
       .force = sines(0.5, 180.0, 2.0),
       .jump_s = 180.0,
       .jump_log_ratio = std::log(4.0)},
  };
}

}  // namespace

const std::vector<Segment>& segments() {
  static const std::vector<Segment> kSegments = all_segments();
  return kSegments;
}

namespace {

struct Levels {
  double low = 0.0, high = 0.0;  // N
};

constexpr double kStep_s = 0.005;
constexpr double kEdge = 0.05;  // of the campaign's range, left out at either end

// Of what the records cover, as much as lies in the declared range of the reference; all of it where next to none does, for then the
// records and not the proposal contradict the declaration.
Levels levels_of(const Workspace& w) {
  const Levels covered{w.input.lowest_N + kEdge * w.input.range_N, w.input.lowest_N + (1.0 - kEdge) * w.input.range_N};
  const BenchFacts& bench = w.input.bench;
  Levels allowed = covered;
  if (std::isfinite(bench.force_min_N)) allowed.low = std::max(allowed.low, bench.force_min_N);
  if (std::isfinite(bench.force_max_N)) allowed.high = std::min(allowed.high, bench.force_max_N);
  return allowed.high - allowed.low > kEdge * w.input.range_N ? allowed : covered;
}

// Rows of at least four samples, 6000 of them at most.
void play(const Segment& s, const Levels& levels, RecordInput& r) {
  const auto per_row = std::max(4, static_cast<int>(std::ceil(60.0 * s.minutes / kStep_s / 6000.0)));
  const auto n_rows = static_cast<std::size_t>(60.0 * s.minutes / kStep_s / per_row);
  r.row_step_s = kStep_s * per_row;
  for (std::size_t i = 0; i <= n_rows; ++i) r.row_begin.push_back(static_cast<std::uint32_t>(i * static_cast<std::size_t>(per_row)));
  for (std::size_t i = 0; i < n_rows; ++i) {
    double F = 0.0, t = 0.0;
    for (int k = 0; k < per_row; ++k) {
      const double at = kStep_s * static_cast<double>(i * static_cast<std::size_t>(per_row) + static_cast<std::size_t>(k));
      r.fast_t_s.push_back(at);
      r.fast_F_N.push_back(s.force(at, levels.low, levels.high));
      F += r.fast_F_N.back();
      t += at;
    }
    r.F_N.push_back(F / per_row);
    r.t_s.push_back(t / per_row);
  }
  r.ok.assign(n_rows, 1);
  r.rate_N_per_s.assign(n_rows, 0.0);
  r.travel_N.assign(n_rows, 0.0);
  for (std::size_t i = 1; i < n_rows; ++i) {
    r.rate_N_per_s[i] = (r.F_N[i] - r.F_N[i - 1]) / r.row_step_s;
    r.travel_N[i] = r.travel_N[i - 1] + std::abs(r.F_N[i] - r.F_N[i - 1]);
  }
}

// Of an eccentric that presses from one level to the other in half a turn.
void add_angle(const Levels& levels, RecordInput& r) {
  for (std::size_t i = 0; i < r.rows(); ++i) {
    const double share = (r.F_N[i] - levels.low) / std::max(1e-9, levels.high - levels.low);
    const double theta_rad = std::acos(std::clamp(1.0 - 2.0 * share, -1.0, 1.0));
    r.theta_rad.push_back(r.rate_N_per_s[i] < 0.0 ? -theta_rad : theta_rad);
    r.sin_theta.push_back(std::sin(r.theta_rad.back()));
    r.cos_theta.push_back(std::cos(r.theta_rad.back()));
  }
}

}  // namespace

StimulusSpec stimulus_of(const Workspace& w, const Segment& s) {
  constexpr double kMost_N = 20.0;  // of a profile; it does not pull either
  const Levels levels = levels_of(w);
  return s.parameters && levels.low >= 0.0 && levels.high <= kMost_N ? s.parameters(levels.low, levels.high) : StimulusSpec{"replay", {}, {}, {}};
}

RecordInput simulate(const Workspace& w, const Segment& s) {
  const Levels levels = levels_of(w);
  RecordInput r;
  r.name = s.name;
  r.duration_s = 60.0 * s.minutes;
  r.dynamic = s.dynamic;
  play(s, levels, r);
  r.U_V = r.F_N;
  for (double& u : r.U_V) u *= w.gain_V_per_N;
  const RecordInput& last = w.input.records.back();
  r.index = r.recording = w.input.records.size();
  r.start_s = last.start_s + last.duration_s + 600.0;
  r.travel_before_N = w.input.travel_total_N;
  r.drive_mean_V = last.drive_mean_V;
  if (w.input.has_temp) {
    const double T = last.temp_C.empty() ? 23.0 : last.temp_C.back();
    for (std::size_t i = 0; i < r.rows(); ++i)
      r.temp_C.push_back(T + s.temperature_C * static_cast<double>(i) / static_cast<double>(r.rows()));
  }
  if (w.input.has_theta) add_angle(levels, r);
  r.F_min_N = s.dynamic ? levels.low : 0.0;
  r.f_Hz = s.dynamic ? 0.5 : 0.0;
  r.A_N = 0.5 * (levels.high - levels.low);
  if (s.jump_log_ratio != 0.0) {
    r.frequency_jumps_s = {s.jump_s};
    r.jump_log_ratio = {s.jump_log_ratio};
  }
  set_decay(r, w.law);
  return r;
}

bool is_record_of(std::string_view record, const Segment& segment) {
  const std::string name = "_" + slug(segment.name);
  if (!record.starts_with('r') || !record.ends_with(name) || record.size() < name.size() + 2) return false;
  const std::string_view number = record.substr(1, record.size() - name.size() - 1);
  return number.find_first_not_of("0123456789") == std::string_view::npos;
}

}  // namespace forcegate::diagnose
