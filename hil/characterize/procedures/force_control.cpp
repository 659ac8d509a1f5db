// Force control (IV-B2, Fig. 9-11): 1.1 to 3.2 N at 0.5 Hz for 20 minutes, integral control on the sensor.
//   raw        F = G U + F0 of this session: the wheel comes to its stop
//   nominal, static, identified   F by eq. (7) with that much known of the specimen (docs/gate.md, 1)
//   four sines with the identified calibration, errors over the last tenth ("at the end")
// The FSR is used without compensation (V-A), so only `raw` is played for it.
// MRE (eq. 9) of the ATI against the set-point, maxima and minima each, from the end of the start window.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "hil/characterize/session.h"
#include "hil/gate/calibrate.h"

namespace forcegate::characterize {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kRunAway_pct = 30.0, kAtStop_rad = 0.02, kTouch_s = 0.05;

struct ControlRun {
  Extrema extrema;
  double judged_from_s = 0.0;
  double stop_s = kNan;   ///< first time that the wheel is at its stop, or the safety gate acts
  double stuck_s = kNan;  ///< from here on it stays there for a whole cycle
};

struct ControlErrors {
  double maxima_pct = kNan, minima_pct = kNan;
};

ControlErrors errors_of(const ControlRun& run, double from_s) {
  const auto one = [&](const Turns& turns) {
    std::vector<double> actual, expected;
    for (std::size_t i = 0; i < turns.size(); ++i)
      if (turns.t_s[i] >= from_s) actual.push_back(turns.ati_N[i]), expected.push_back(turns.setpoint_N[i]);
    return 100.0 * mean_relative_error(actual, expected, 0.1).mean;
  };
  return {one(run.extrema.maxima), one(run.extrema.minima)};
}

class ForceControl {
 public:
  explicit ForceControl(Session& s) : s_(s) {}

  Result<void> run() {
    const StudyPlan& p = s_.plan;
    const StimulusSpec reference = sine(p.control_f_Hz, p.control_A_N, p.control_m_N, p.record_s);
    FORCEGATE_CHECK_OK(raw(reference));
    if (s_.fsr()) return {};
    FORCEGATE_CHECK_OK(identify());
    const Calibration nominal = nominal_calibration(s_.bench.info());
    Calibration statical = s_.sheet.calibration;
    statical.b_scale = statical.q_scale = 1.0;
    FORCEGATE_CHECK_OK(compensated("nominal", nominal, reference, "", p.record_s));
    FORCEGATE_CHECK_OK(compensated("static", statical, reference, "", p.record_s));
    FORCEGATE_CHECK_OK(compensated("identified", s_.sheet.calibration, reference, "fig10", p.record_s));
    return compensated(
        "four_sines", s_.sheet.calibration,
        sum_of_sines({1.0, 0.5, 0.1, 0.05}, {0.1, 0.2, 0.3, 0.4}, p.four_sines_m_N, p.record_s), "",
        0.1 * p.record_s);
  }

 private:
  Result<ControlRun> play(const std::string& name, const StimulusSpec& spec, const Estimator& estimator,
                          const std::function<bool()>& learning, const std::string& curve_name) {
    FORCEGATE_TRY(const auto stimulus, make_stimulus(spec));
    const StimulusFacts facts = stimulus->facts();
    const double cycle_s = 1.0 / std::max(0.1, facts.lowest_frequency_Hz),
                 duration_s = stimulus->duration_s();
    const double per_code = s_.bench.volts_per_code();
    ExtremaSink sink(std::max(0.05, 0.25 * facts.amplitude_N), per_code, true);
    const double shown_s = learning ? duration_s : std::min(duration_s, 400.0);
    CurveSink whole(curve_name, 0.0, shown_s, per_code, true, 720);
    CurveSink end(curve_name + "_end", duration_s - 10.0, duration_s, per_code, true, 500);
    ControlRun out;
    out.judged_from_s = learning ? s_.plan.learning_s : 0.0;
    double stopped_for_s = 0.0;
    bool was_learning = false, decided = !learning;
    const RigInfo info = s_.bench.info();
    const double step_s = 1.0 / info.rate_Hz, stop_rad = info.geometry.theta_max_rad - kAtStop_rad;
    FORCEGATE_TRY(
        const PlayedRecord played,
        s_.bench.play(*stimulus,
                      [&](const RigBlock& b, std::size_t n, std::span<const float> estimate_N) {
                        sink(b, n, estimate_N);
                        if (!curve_name.empty() && s_.curves) {
                          whole(b, n, estimate_N);
                          end(b, n, estimate_N);
                        }
                        if (!decided) {
                          const bool now = learning();
                          if (was_learning && !now)
                            out.judged_from_s = std::min(out.judged_from_s, b.t_s[n - 1]), decided = true;
                          was_learning = was_learning || now;
                        }
                        for (std::size_t i = 0; i < n; ++i) {
                          stopped_for_s =
                              static_cast<double>(b.theta_rad[i]) > stop_rad ? stopped_for_s + step_s : 0.0;
                          if (stopped_for_s > kTouch_s && std::isnan(out.stop_s))
                            out.stop_s = b.t_s[i] - stopped_for_s;
                          if (stopped_for_s > cycle_s && std::isnan(out.stuck_s))
                            out.stuck_s = b.t_s[i] - stopped_for_s;
                        }
                      },
                      {.estimator = estimator, .faults = {}}));
    if (played.safety.stopped() && std::isnan(out.stop_s)) out.stop_s = played.safety.t_s;
    out.extrema = sink.finish();
    if (s_.curves) s_.sheet.curves.push_back(extrema_curve("extrema/control_" + name, out.extrema));
    if (!curve_name.empty() && s_.curves) {
      s_.sheet.curves.push_back(whole.finish());
      s_.sheet.curves.push_back(end.finish());
    }
    return out;
  }

  Result<void> raw(const StimulusSpec& reference) {
    const double gain = s_.sheet.calibration.gain_N_per_V * s_.bench.volts_per_code(),
                 offset = s_.sheet.calibration.offset_N;
    FORCEGATE_TRY(
        const ControlRun run,
        play(
            "raw", reference, [=](std::uint16_t code) { return gain * code + offset; }, {}, "fig9"));
    s_.add("control.raw_stop", "Without compensation: the wheel comes to its stop after", "s", run.stop_s);
    s_.add("control.raw_stopped", "Without compensation: it comes to its stop within the record", "%",
           std::isnan(run.stop_s) ? 0.0 : 100.0);
    s_.add("control.raw_stuck", "Without compensation: it stays there for a whole cycle", "%",
           std::isnan(run.stuck_s) ? 0.0 : 100.0);
    if (s_.fsr()) {
      const ControlErrors e = errors_of(run, s_.plan.learning_s);
      s_.add("control.raw_maxima", "Without compensation: maxima, ATI against set-point", "%", e.maxima_pct);
      s_.add("control.raw_minima", "Without compensation: minima, ATI against set-point", "%", e.minima_pct);
    }
    return {};
  }

  // b and q = c/a from an earlier record of this specimen, relative to eq. (5).
  Result<void> identify() {
    const StudyPlan& p = s_.plan;
    FORCEGATE_TRY(
        const DecayRecord d,
        play_decay(s_, "identification", sine(p.control_f_Hz, p.control_A_N, p.control_m_N, p.record_s)));
    if (!d.fitted || !(d.fit.b_per_s > 0.0) || !(d.fit.c_V / d.fit.a_V > 0.0))
      return fail(ErrorCode::device, "the dynamic record does not determine b and c/a", s_.sheet.specimen,
                  "take a longer record");
    Calibration& c = s_.sheet.calibration;
    const DecayScales scales = scales_of(d.fit, d.f_Hz, d.A_N);
    c.b_scale = scales.b;
    c.q_scale = scales.q;
    c.level = CalibrationLevel::identified;
    c.id = s_.sheet.specimen.substr(0, 14) + "/i";
    s_.add("identified.b", "Decay rate against eq. (5)", "1", c.b_scale);
    s_.add("identified.q", "Ratio c/a against eq. (5)", "1", c.q_scale);
    return {};
  }

  Result<void> compensated(const std::string& level, const Calibration& calibration,
                           const StimulusSpec& reference, const std::string& curve, double judged_s) {
    if (!s_.compensation) return fail(ErrorCode::internal, "force control has no compensation to try");
    const Compensation c = s_.compensation(calibration);
    FORCEGATE_TRY(const ControlRun run, play(level, reference, c.estimate, c.learning, curve));
    const ControlErrors e = errors_of(run, std::max(run.judged_from_s, s_.plan.record_s - judged_s));
    const bool away = !std::isnan(run.stop_s) || e.maxima_pct > kRunAway_pct;
    const std::string title =
        level == "four_sines" ? "Four sines, identified, at the end" : "Compensated, level " + level;
    s_.add("control." + level + "_maxima", title + ": maxima, ATI against set-point", "%", e.maxima_pct);
    s_.add("control." + level + "_minima", title + ": minima, ATI against set-point", "%", e.minima_pct);
    s_.add("control." + level + "_away", title + ": runs away", "%", away ? 100.0 : 0.0);
    return {};
  }

  Session& s_;
};

Result<void> run(Session& s) { return ForceControl(s).run(); }

std::vector<std::string> keys(const StudyPlan&, std::string_view sensor) {
  std::vector<std::string> out = {"control.raw_stop", "control.raw_stopped", "control.raw_stuck"};
  if (sensor == "fsr") {
    out.insert(out.end(), {"control.raw_maxima", "control.raw_minima"});
    return out;
  }
  out.insert(out.end(), {"identified.b", "identified.q"});
  for (const std::string level : {"nominal", "static", "identified", "four_sines"})
    for (const char* what : {"_maxima", "_minima", "_away"}) out.push_back("control." + level + what);
  return out;
}

const Registration<ProcedureKind> kRow{
    {"force_control", "Force control with and without compensation (IV-B2, Fig. 9-11)", true, run, keys}};

}  // namespace
}  // namespace forcegate::characterize
