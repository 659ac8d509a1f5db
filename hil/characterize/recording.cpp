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
constexpr double kTurnShare = 0.25, kSmallTurnShare = 0.1;  // of the range of the force

struct Columns {
  std::vector<double> t_s;
  std::vector<float> force_N, sensor_V;
  std::vector<bool> at_rail;  ///< the converter was at its first or last code: the sensor may have been beyond
  std::size_t rails() const { return static_cast<std::size_t>(std::ranges::count(at_rail, true)); }
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
      out.at_rail.push_back((block.status[i] & kRigAdcRail) != 0);
    }
    progress.samples += n;
    if (progress.is_cancelled()) return fail(ErrorCode::cancelled, "interrupted");
  }
  rig.park();
  return out;
}

// Of the first `rows`.
Extrema find_extrema(const Columns& c, double prominence_N, std::size_t rows) {
  ExtremaPairer pairer({.prominence = prominence_N, .followers = 2, .half_width = 2});
  const float* followers[2] = {c.sensor_V.data(), c.force_N.data()};
  pairer.push(std::span(c.t_s).first(rows), std::span(c.force_N).first(rows), {followers, 2});
  pairer.finish();
  return extrema_of(pairer.pairs());
}

Extrema find_turns(const Columns& c, double prominence_N) {
  Extrema out = find_extrema(c, prominence_N, c.t_s.size());
  sharpen_turns(c.t_s, c.force_N, c.sensor_V, out);
  return out;
}

// How long the force was cycled before `until_s`, rests between cycles left out: these do not give the decay back, which takes hours.
double cycled_before(const Columns& c, double until_s, double range_N) {
  const auto rows = static_cast<std::size_t>(std::ranges::lower_bound(c.t_s, until_s) - c.t_s.begin());
  const Extrema turns = find_extrema(c, kSmallTurnShare * range_N, rows);
  std::vector<double> t_s = turns.maxima.t_s;
  t_s.insert(t_s.end(), turns.minima.t_s.begin(), turns.minima.t_s.end());
  std::ranges::sort(t_s);
  double cycled_s = 0.0;
  for (std::size_t i = 1; i < t_s.size(); ++i)
    if (const double half_cycle_s = t_s[i] - t_s[i - 1]; half_cycle_s < kSlowHalfCycle_s) cycled_s += half_cycle_s;
  return cycled_s;
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

// `fall`: of the maxima beyond that of the force, share of the first swing. `from_rest`: the decay began with these cycles, so that a and c are those of
// eq. (3); else a has lost an unknown part already, and c stands for another amplitude's too: b alone does not ask when the time began.
void describe_decay_of(SessionSheet& sheet, const DecayRecord& d, double fall, bool from_rest) {
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
  if (from_rest) add(sheet, "recording.a", "a of eq. (3)", "V", d.fit.a_V);
  add(sheet, "recording.b", "b of eq. (3)", "1/s", d.fit.b_per_s);
  if (from_rest) add(sheet, "recording.c", "c of eq. (3)", "V", d.fit.c_V);
  add(sheet, "recording.rmse", "RMSE of the maxima, eq. (8)", "V", d.fit.rmse_V);
  if (const DecayScales scales = scales_of(d.fit, d.f_Hz, d.A_N); scales.b > 0.0 && scales.q > 0.0) {
    add(sheet, "identified.b", "Decay rate against eq. (5)", "1", sheet.calibration.b_scale = scales.b);
    if (from_rest) add(sheet, "identified.q", "Ratio c/a against eq. (5)", "1", sheet.calibration.q_scale = scales.q);
  }
}

struct Span {
  double begin_s = 0.0, end_s = 0.0;
};

void note_rails(SessionSheet& sheet, const Columns& c, const char* what_of_it) {
  if (const std::size_t rails = c.rails(); rails > 0)
    sheet.notes.push_back(
        fmt::format("{} of {} samples lie at the first or the last code of the converter, where the sensor may be beyond its range: {}",
                    rails, c.t_s.size(), what_of_it));
}

void describe_cycles(SessionSheet& sheet, SteadyStretch stretch, const Columns& columns, double range_N) {
  constexpr double kFewSamples = 8.0, kCyclesLeft = 2.0;
  const Span recording{columns.t_s.front(), columns.t_s.back()};
  const double samples = samples_per_cycle(columns.t_s, stretch.extrema);
  if (samples < kFewSamples)
    sheet.notes.push_back(fmt::format("only {:.2g} samples in a cycle: the heights of the turns, and with them A, the loss and c/a, are told from too few", samples));
  Extrema& extrema = stretch.extrema;
  const double half_cycle_s = (stretch.end_s - stretch.begin_s) / std::max(1.0, static_cast<double>(extrema.maxima.size() + extrema.minima.size()) - 1.0);
  note_rails(sheet, columns, "turns there are cut off, and the loss and the decay with them");
  const double cycled_s = cycled_before(columns, stretch.begin_s, range_N);
  const bool from_rest = cycled_s <= 2.0 * kCyclesLeft * half_cycle_s;
  double onset_s = stretch.begin_s, end_s = stretch.end_s;
  if (stretch.is_whole) {
    onset_s = std::max(recording.begin_s, stretch.begin_s - half_cycle_s);
    end_s = recording.end_s;
    if (from_rest && onset_s - recording.begin_s > 2.0 * half_cycle_s)
      sheet.notes.push_back(
          fmt::format("the cycles begin {:.3g} s behind the beginning of the recording: the time of eq. (3) counts from there",
                      onset_s - recording.begin_s));
  } else {
    sheet.notes.push_back(fmt::format(
        "cut to {:.0f} .. {:.0f} s of {:.0f} s: elsewhere the swing or the rate of the force is another one",
        stretch.begin_s, stretch.end_s, recording.end_s - recording.begin_s));
  }
  if (!from_rest)
    sheet.notes.push_back(fmt::format(
        "the force was cycled for {:.0f} s before the cycles that are told of: the decay began there, with another swing, so that a and c of eq. (3), and c/a with them, "
        "are not told; record from rest for them",
        cycled_s));
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
  describe_decay_of(sheet, d, fall, from_rest);
  if (!from_rest) d.fit.a_V = d.fit.c_V = d.fit.u_a_V = d.fit.u_c_V = std::nan("");  // null in study.json
  sheet.decays.push_back(std::move(d));
}

Result<void> describe_static(SessionSheet& sheet, const Columns& c, double largest_N,
                             const std::string& name) {
  note_rails(sheet, c, "the static law is told without them");
  StaticLine line;
  for (std::size_t i = 0; i < c.t_s.size(); ++i)
    if (!c.at_rail[i]) line.push(static_cast<double>(c.sensor_V[i]), static_cast<double>(c.force_N[i]));
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
    if (info.details.contains("output"))
      return fail(ErrorCode::config, "the output is recorded in counts, and nothing says what a count is: " + assumed->second + " would be assumed", name,
                  "give the converter's, for instance --rig-option adc_bits=12 --rig-option v_range_V=3.3");
    sheet.assumed_converter = assumed->second;
    sheet.notes.push_back("the converter is not stated: " + assumed->second + " in the calibration file " + (assumed->second.find(',') != std::string::npos ? "are" : "is") +
                          " assumed; give yours, --rig-option adc_bits=N --rig-option v_range_V=VOLTS");
  }
  if (const auto notes = info.details.find("notes"); notes != info.details.end()) sheet.notes.push_back(notes->second);
  const double largest_N =
      std::max(std::abs(static_cast<double>(*low)), std::abs(static_cast<double>(*high)));
  const Extrema all = find_turns(columns, kTurnShare * range_N);
  const double recording_s = columns.t_s.back() - columns.t_s.front();
  const auto turns_of = [](const Extrema& e) { return e.maxima.size() + e.minima.size(); };
  const auto is_cyclic = [](std::size_t turns, double duration_s) {
    return turns >= kTurnsNeeded && duration_s / static_cast<double>(turns) < kSlowHalfCycle_s;
  };
  SteadyStretch stretch = longest_steady_stretch(all, kSwingTolerance);
  if (is_cyclic(turns_of(stretch.extrema), stretch.end_s - stretch.begin_s)) {
    describe_cycles(sheet, std::move(stretch), columns, range_N);
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
