#include "hil/characterize/recording.h"

#include <algorithm>
#include <cmath>

#include "hil/gate/calibrate.h"
#include "hil/trace/static_line.h"

namespace forcegate::characterize {
namespace {

constexpr std::size_t kBlock = 4096, kTurnsNeeded = 12;
constexpr double kSlowHalfCycle_s = 20.0, kFullScale_N = 5.0, kRangeNeeded_N = 0.2;
constexpr double kLaw_b1 = 0.0019, kLaw_b0 = 0.0056, kLaw_k = 1.377;  // eq. (5) as printed

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
  return extrema_of(pairer.pairs());
}

void add(SessionSheet& sheet, const char* key, const char* title, const char* unit, double value) {
  sheet.values.push_back({key, title, unit, value});
}

void describe_cycles(SessionSheet& sheet, const Extrema& extrema, double duration_s) {
  DecayRecord d = describe_decay(extrema);
  d.set = "recording";
  d.duration_s = duration_s;
  const Turns& m = extrema.maxima;
  d.f_Hz = static_cast<double>(m.size() - 1) / (m.t_s.back() - m.t_s.front());
  double mean_N = 0.0;
  for (const Turns* t : {&extrema.maxima, &extrema.minima})
    for (const double f : t->ati_N) mean_N += f / static_cast<double>(t->size()) / 2.0;
  d.m_N = mean_N;
  add(sheet, "recording.frequency", "Mean frequency of the cycles", "Hz", d.f_Hz);
  add(sheet, "recording.amplitude", "Amplitude A of the force", "N", d.A_N);
  add(sheet, "recording.mean", "Mean m of the force", "N", d.m_N);
  add(sheet, "recording.loss", "Loss of the maxima", "%", 100.0 * d.loss);
  add(sheet, "recording.minima_drift", "Drift of the minima, share of the first swing", "%",
      d.minima_drift_pct);
  add(sheet, "recording.wander", "Wandering of single maxima, share of the swing", "%", d.wander_pct);
  if (d.fitted) {
    add(sheet, "recording.a", "a of eq. (3)", "V", d.fit.a_V);
    add(sheet, "recording.b", "b of eq. (3)", "1/s", d.fit.b_per_s);
    add(sheet, "recording.c", "c of eq. (3)", "V", d.fit.c_V);
    add(sheet, "recording.rmse", "RMSE of the maxima, eq. (8)", "V", d.fit.rmse_V);
    const double b_scale = d.fit.b_per_s / (kLaw_b1 * d.f_Hz + kLaw_b0),
                 q_scale = d.fit.c_V / d.fit.a_V * (1.0 + kLaw_k * d.A_N * d.A_N);
    if (b_scale > 0.0 && q_scale > 0.0) {
      add(sheet, "identified.b", "Decay rate against eq. (5)", "1", sheet.calibration.b_scale = b_scale);
      add(sheet, "identified.q", "Ratio c/a against eq. (5)", "1", sheet.calibration.q_scale = q_scale);
    }
  }
  sheet.decays.push_back(std::move(d));
}

Result<void> describe_static(SessionSheet& sheet, const Columns& c, const std::string& name) {
  StaticLine line;
  for (std::size_t i = 0; i < c.t_s.size(); ++i)
    line.push(static_cast<double>(c.sensor_V[i]), static_cast<double>(c.force_N[i]));
  if (!line.answers(1e-6))
    return fail(ErrorCode::device, "the sensor did not answer the force", name,
                "is it the sensor's channel?");
  Calibration& k = sheet.calibration;
  k.gain_N_per_V = line.gain_N_per_V();
  k.offset_N = line.offset_N();
  k.level = CalibrationLevel::statical;
  sheet.calibration_rmse_N = line.residual_N();
  add(sheet, "static.gain", "Gain G, eq. (1)", "N/V", k.gain_N_per_V);
  add(sheet, "static.offset", "Offset F0, eq. (1)", "N", k.offset_N);
  add(sheet, "static.residual", "Residual of the line", "N", sheet.calibration_rmse_N);
  add(sheet, "static.residual_share", "Residual of the line, share of the full scale of 5 N", "% FS",
      100.0 * sheet.calibration_rmse_N / kFullScale_N);
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
    return fail(ErrorCode::device, "the force hardly moves: nothing can be learnt from this recording", name,
                "load the sensor through its range, or cyclically");
  SessionSheet sheet;
  sheet.specimen = name;
  sheet.samples = columns.t_s.size();
  sheet.calibration = nominal_calibration(rig.info());
  const Extrema extrema = find_extrema(columns, 0.25 * range_N);
  const std::size_t turns = extrema.maxima.size() + extrema.minima.size();
  const double duration_s = columns.t_s.back() - columns.t_s.front();
  if (turns >= kTurnsNeeded && duration_s / static_cast<double>(turns) < kSlowHalfCycle_s)
    describe_cycles(sheet, extrema, duration_s);
  else
    FORCEGATE_CHECK_OK(describe_static(sheet, columns, name));
  return sheet;
}

}  // namespace forcegate::characterize
