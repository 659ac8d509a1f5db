#include "hil/characterize/recording.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hil/characterize/sharp_turns.h"
#include "hil/characterize/steady_stretch.h"
#include "hil/gate/calibrate.h"
#include "hil/trace/static_line.h"

namespace forcegate::characterize {
namespace {

constexpr std::size_t kBlock = 4096, kTurnsNeeded = 12;
constexpr double kSlowHalfCycle_s = 20.0, kRangeNeeded_N = 0.2;
constexpr double kSwingTolerance = 0.1, kDecaySigmas = 3.0, kLeastDecay = 0.005;

struct Columns {
  std::vector<double> t_s;
  std::vector<float> force_N, sensor_V;
};

Result<Columns> read_all(Rig& rig, BenchProgress& progress) {
  RigRecordRequest request;
  request.duration_s = 1.0;
  FORCEGATE_CHECK_OK(rig.begin(request));
  const RigInfo info = rig.info();
  const double per_code = info.v_range_V / static_cast<double>((1u << info.adc_bits) - 1u);
  Columns out;
  RigBlock block;
  block.resize(kBlock);
  for (;;) {
    FORCEGATE_TRY(const std::size_t n, rig.run(kBlock, block, 0));
    if (n == 0) break;
    for (std::size_t i = 0; i < n; ++i) {
      if (!std::isfinite(block.force_ref_N[i]) || (block.status[i] & kRigSampleLost) != 0) continue;
      out.t_s.push_back(block.t_s[i]);
      out.force_N.push_back(block.force_ref_N[i]);
      out.sensor_V.push_back(static_cast<float>(per_code * block.adc[i]));
    }
    progress.samples += n;
    if (progress.is_cancelled()) return fail(ErrorCode::cancelled, "interrupted");
  }
  rig.park();
  return out;
}

Extrema find_extrema(const Columns& c, double prominence_N) {
  ExtremaPairer pairer({.prominence = prominence_N, .followers = 2, .half_width = 2});
  const float* followers[2] = {c.sensor_V.data(), c.force_N.data()};
  pairer.push(c.t_s, c.force_N, {followers, 2});
  pairer.finish();
  Extrema out = extrema_of(pairer.pairs());
  sharpen_turns(c.t_s, c.force_N, c.sensor_V, out);
  return out;
}

void add(SessionSheet& sheet, const char* key, const char* title, const char* unit, double value) {
  sheet.values.push_back({key, title, unit, value});
}

// What eq. (3) says that the swing loses over the stretch, share of the first swing; 0 where a is not above its error.
double decay_of(const DecayRecord& d) {
  if (!d.fitted || std::abs(d.fit.a_V) < kDecaySigmas * d.fit.u_a_V) return 0.0;
  return d.fit.a_V / (d.fit.a_V + d.fit.c_V) * (1.0 - std::exp(-d.fit.b_per_s * d.duration_s));
}

// Share of `swing` by which the maxima fell, from tenths of the stretch.
double fall_of(const std::vector<double>& maxima, double swing) {
  const std::size_t n = std::max<std::size_t>(1, maxima.size() / 10);
  double fall = 0.0;
  for (std::size_t i = 0; i < n; ++i) fall += maxima[i] - maxima[maxima.size() - 1 - i];
  return fall / static_cast<double>(n) / swing;
}

// `fall`: of the maxima beyond that of the force, share of the first swing.
void describe_decay_of(SessionSheet& sheet, const DecayRecord& d, double fall) {
  const double decay = decay_of(d);
  if (std::abs(decay) < kLeastDecay) {
    sheet.notes.push_back(
        std::abs(fall) < kLeastDecay
            ? fmt::format("no decay of the maxima is seen over {:.0f} s: eq. (3) has nothing to be fitted to",
                          d.duration_s)
            : fmt::format(
                  "the maxima {} by {:.1f} % over {:.0f} s, but not along eq. (3): no b and c are told",
                  fall > 0.0 ? "fall" : "rise", 100.0 * std::abs(fall), d.duration_s));
    return;
  }
  if (decay < 0.0) sheet.notes.push_back("the maxima rise: a of eq. (3) is negative");
  add(sheet, "recording.a", "a of eq. (3)", "V", d.fit.a_V);
  add(sheet, "recording.b", "b of eq. (3)", "1/s", d.fit.b_per_s);
  add(sheet, "recording.c", "c of eq. (3)", "V", d.fit.c_V);
  add(sheet, "recording.rmse", "RMSE of the maxima, eq. (8)", "V", d.fit.rmse_V);
  if (const DecayScales scales = scales_of(d.fit, d.f_Hz, d.A_N); scales.b > 0.0 && scales.q > 0.0) {
    add(sheet, "identified.b", "Decay rate against eq. (5)", "1", sheet.calibration.b_scale = scales.b);
    add(sheet, "identified.q", "Ratio c/a against eq. (5)", "1", sheet.calibration.q_scale = scales.q);
  }
}

struct Span {
  double begin_s = 0.0, end_s = 0.0;
};

// `samples`: in a cycle.
void describe_cycles(SessionSheet& sheet, SteadyStretch stretch, const Span& recording, double samples) {
  constexpr double kFewSamples = 8.0;
  if (samples < kFewSamples)
    sheet.notes.push_back(fmt::format("only {:.2g} samples in a cycle: the heights of the turns, and with them A, the loss and c/a, are told from too few", samples));
  Extrema& extrema = stretch.extrema;
  const double half_cycle_s = (stretch.end_s - stretch.begin_s) / std::max(1.0, static_cast<double>(extrema.maxima.size() + extrema.minima.size()) - 1.0);
  double onset_s = stretch.begin_s, end_s = stretch.end_s;
  if (stretch.is_whole) {
    onset_s = std::max(recording.begin_s, stretch.begin_s - half_cycle_s);
    end_s = recording.end_s;
    if (onset_s - recording.begin_s > 2.0 * half_cycle_s)
      sheet.notes.push_back(fmt::format("the cycles begin {:.3g} s behind the beginning of the recording: the time of eq. (3) counts from there", onset_s - recording.begin_s));
  } else {
    sheet.notes.push_back(fmt::format(
        "cut to {:.0f} .. {:.0f} s of {:.0f} s: elsewhere the swing or the rate of the force is another one",
        stretch.begin_s, stretch.end_s, recording.end_s - recording.begin_s));
  }
  for (Turns* t : {&extrema.maxima, &extrema.minima})
    for (double& t_s : t->t_s) t_s -= onset_s;
  DecayRecord d = describe_decay(extrema);
  d.set = "recording";
  d.duration_s = end_s - onset_s;
  const Turns& m = extrema.maxima;
  d.f_Hz = static_cast<double>(m.size() - 1) / (m.t_s.back() - m.t_s.front());
  double mean_N = 0.0;
  for (const Turns* t : {&extrema.maxima, &extrema.minima})
    for (const double f : t->ati_N) mean_N += f / static_cast<double>(t->size()) / 2.0;
  d.m_N = mean_N;
  const double force_fall = fall_of(m.ati_N, 2.0 * d.A_N),
               fall = fall_of(m.sensor_V, m.sensor_V.front() - d.u_min_V) - force_fall;
  add(sheet, "recording.frequency", "Mean frequency of the cycles", "Hz", d.f_Hz);
  add(sheet, "recording.amplitude", "Amplitude A of the force", "N", d.A_N);
  add(sheet, "recording.mean", "Mean m of the force", "N", d.m_N);
  add(sheet, "recording.loss", "Loss of the maxima", "%", 100.0 * d.loss);
  add(sheet, "recording.force_loss", "Fall of the maxima of the force itself", "%", 100.0 * force_fall);
  add(sheet, "recording.minima_drift", "Drift of the minima, share of the first swing", "%",
      d.minima_drift_pct);
  add(sheet, "recording.wander", "Wandering of single maxima, share of the swing", "%", d.wander_pct);
  describe_decay_of(sheet, d, fall);
  sheet.decays.push_back(std::move(d));
}

Result<void> describe_static(SessionSheet& sheet, const Columns& c, double largest_N,
                             const std::string& name) {
  StaticLine line;
  for (std::size_t i = 0; i < c.t_s.size(); ++i)
    line.push(static_cast<double>(c.sensor_V[i]), static_cast<double>(c.force_N[i]));
  constexpr double kLeast_V2 = 1e-6, kAnswers = 0.5;  // correlation
  if (line.variance_V2() > kLeast_V2 && line.covariance_VN() < -kAnswers * std::sqrt(line.variance_V2() * line.variance_N2()))
    return fail(ErrorCode::parse, "the output falls while the force rises", name,
                "one of the two has the wrong sign: exchange the leads of the sensor, or turn the column over (U: full scale - U, F_ref: -F_ref)");
  if (!line.answers(kLeast_V2))
    return fail(ErrorCode::parse, "the sensor did not answer the force", name,
                "is it the sensor's channel?");
  Calibration& k = sheet.calibration;
  k.gain_N_per_V = line.gain_N_per_V();
  k.offset_N = line.offset_N();
  k.level = CalibrationLevel::statical;
  sheet.calibration_rmse_N = line.residual_N();
  add(sheet, "static.gain", "Gain G, eq. (1)", "N/V", k.gain_N_per_V);
  add(sheet, "static.offset", "Offset F0, eq. (1)", "N", k.offset_N);
  add(sheet, "static.residual", "Residual of the line", "N", sheet.calibration_rmse_N);
  add(sheet, "static.residual_share", "Residual of the line, share of the largest force", "%",
      100.0 * sheet.calibration_rmse_N / largest_N);
  return {};
}

}  // namespace

Result<SessionSheet> characterize_recording(Rig& rig, const std::string& name, BenchProgress& progress) {
  FORCEGATE_TRY(const Columns columns, read_all(rig, progress));
  if (columns.t_s.size() < 100)
    return fail(ErrorCode::parse, "the recording holds fewer than 100 valid samples", name,
                "record some seconds at least");
  const auto [low, high] = std::minmax_element(columns.force_N.begin(), columns.force_N.end());
  const double range_N = static_cast<double>(*high - *low);
  if (range_N < kRangeNeeded_N)
    return fail(ErrorCode::parse, "the force hardly moves: nothing can be learnt from this recording", name,
                "load the sensor through its range, or cyclically");
  SessionSheet sheet;
  sheet.specimen = name;
  sheet.samples = columns.t_s.size();
  const RigInfo info = rig.info();
  sheet.calibration = nominal_calibration(info);
  if (const auto assumed = info.details.find("assumed"); assumed != info.details.end()) {
    sheet.assumed_converter = assumed->second;
    sheet.notes.push_back("the converter is not stated: " + assumed->second + " in the calibration file " + (assumed->second.find(',') != std::string::npos ? "are" : "is") +
                          " assumed; give yours, --rig-option adc_bits=N --rig-option v_range_V=VOLTS");
  }
  const double largest_N =
      std::max(std::abs(static_cast<double>(*low)), std::abs(static_cast<double>(*high)));
  const Extrema all = find_extrema(columns, 0.25 * range_N);
  const double recording_s = columns.t_s.back() - columns.t_s.front();
  const auto turns_of = [](const Extrema& e) { return e.maxima.size() + e.minima.size(); };
  const auto is_cyclic = [](std::size_t turns, double duration_s) {
    return turns >= kTurnsNeeded && duration_s / static_cast<double>(turns) < kSlowHalfCycle_s;
  };
  SteadyStretch stretch = longest_steady_stretch(all, kSwingTolerance);
  if (is_cyclic(turns_of(stretch.extrema), stretch.end_s - stretch.begin_s)) {
    const double samples = samples_per_cycle(columns.t_s, stretch.extrema);
    describe_cycles(sheet, std::move(stretch), {columns.t_s.front(), columns.t_s.back()}, samples);
    return sheet;
  }
  if (is_cyclic(turns_of(all), recording_s))
    sheet.notes.push_back(
        "the swing of the force changes from cycle to cycle: no decay can be told from it; cycles of one "
        "amplitude would show it");
  FORCEGATE_CHECK_OK(describe_static(sheet, columns, largest_N, name));
  return sheet;
}

}  // namespace forcegate::characterize
