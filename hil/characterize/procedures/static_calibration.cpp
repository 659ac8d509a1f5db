// Static calibration (III-A): the force range is applied continuously, twice; least squares of F = G U + F0 (eq. 1).
// Departure from linearity: largest distance of the mean curve (up and down together) from the line. Hysteresis:
// largest distance between the branches up and down. Both in newtons over the sensor's full scale of 5 N.

#include <algorithm>
#include <array>
#include <cmath>

#include "hil/characterize/session.h"
#include "hil/trace/static_line.h"

namespace forcegate::characterize {
namespace {

constexpr double kMeanOver_s = 0.05, kFullScale_N = 5.0, kEdge_N = 0.2;
constexpr int kBins = 30;

struct Bin {
  double n = 0, force_N = 0, sensor_V = 0;
};

Result<void> run(Session& s) {
  const StudyPlan& plan = s.plan;
  const RigInfo info = s.bench.info();
  const double per_code = s.bench.volts_per_code();
  const StimulusSpec ramp{"ramp",
                          {{"low_N", plan.sweep_low_N},
                           {"high_N", plan.sweep_high_N},
                           {"sweep_s", 0.5 * plan.sweep_s},
                           {"cycles", static_cast<double>(plan.sweeps)}},
                          {},
                          {},
                          1};
  std::array<std::array<Bin, kBins>, 2> bins{};
  StaticLine line;
  PairMeans means(std::max<std::size_t>(1, static_cast<std::size_t>(kMeanOver_s * info.rate_Hz)));
  CurveSink curve("fig4", 0.0, plan.sweep_s * plan.sweeps, per_code, false, 120);
  const double span_N = plan.sweep_high_N - plan.sweep_low_N;
  FORCEGATE_TRY(const PlayedRecord played,
                s.bench.play(ramp, [&](const RigBlock& b, std::size_t rows, std::span<const float> none) {
                  if (s.curves) curve(b, rows, none);
                  for (std::size_t i = 0; i < rows; ++i) {
                    if (!means.push(per_code * b.adc[i], static_cast<double>(b.force_ref_N[i]))) continue;
                    const double u = means.sensor_V(), f = means.force_N();
                    if (!std::isfinite(f)) continue;
                    line.push(u, f);
                    const bool falling = std::fmod(b.t_s[i], plan.sweep_s) > 0.5 * plan.sweep_s;
                    const double at = (f - plan.sweep_low_N) / span_N;
                    if (at < 0.0 || at >= 1.0) continue;
                    Bin& bin = bins[falling ? 1 : 0][static_cast<std::size_t>(at * kBins)];
                    bin.n += 1, bin.force_N += f, bin.sensor_V += u;
                  }
                }));
  (void)played;
  if (!(line.n() > 20.0) || !line.answers(1e-4))
    return fail(ErrorCode::device, "the sensor did not answer the calibration sweep", {},
                "is the sensor mounted and plugged in?");
  Calibration& c = s.sheet.calibration;
  c.adc_bits = info.adc_bits;
  c.v_range_V = info.v_range_V;
  c.gain_N_per_V = line.gain_N_per_V();
  c.offset_N = line.offset_N();
  c.level = CalibrationLevel::statical;
  c.id = s.bench.setup().specimen.substr(0, 14) + "/s";
  s.calibrated = true;
  s.sheet.calibration_rmse_N = line.residual_N();

  double bend_N = 0.0, loop_N = 0.0;
  for (std::size_t k = 0; k < kBins; ++k) {
    const Bin &up = bins[0][k], &down = bins[1][k];
    if (up.n < 3 || down.n < 3) continue;
    const double middle_N = plan.sweep_low_N + (static_cast<double>(k) + 0.5) / kBins * span_N;
    const auto error_N = [&](const Bin& b) { return s.force_N(b.sensor_V / b.n) - b.force_N / b.n; };
    bend_N = std::max(bend_N, std::abs(0.5 * (error_N(up) + error_N(down))));
    if (middle_N > plan.sweep_low_N + kEdge_N && middle_N < plan.sweep_high_N - kEdge_N)
      loop_N = std::max(loop_N, std::abs(error_N(up) - error_N(down)));
  }
  s.add("static.gain", "Gain G, eq. (1)", "N/V", c.gain_N_per_V);
  s.add("static.offset", "Offset F0, eq. (1)", "N", c.offset_N);
  s.add("static.linearity", "Departure from linearity", "% FS", 100.0 * bend_N / kFullScale_N);
  s.add("static.hysteresis", "Hysteresis", "% FS", 100.0 * loop_N / kFullScale_N);
  s.add("static.residual", "Residual of the line", "N", s.sheet.calibration_rmse_N);
  if (s.curves) s.sheet.curves.push_back(curve.finish());
  return {};
}

const Registration<ProcedureKind> kRow{
    {"static_calibration",
     "Two continuous sweeps, eq. (1), linearity and hysteresis (III-A, Table I, Fig. 4)", false, run,
     always({"static.gain", "static.offset", "static.linearity", "static.hysteresis", "static.residual"})}};

}  // namespace
}  // namespace forcegate::characterize
