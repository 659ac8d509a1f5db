// Static gain after 20 minutes of cycling (III-D), and after 2 hours of rest (IV-A3): 0.5 Hz, then a rest at low load,
// then the calibration sweeps of eq. (1); against the same sweeps without the cycling.

#include "hil/characterize/sequence.h"
#include "hil/characterize/session.h"

namespace forcegate::characterize {
namespace {

constexpr double kA_N = 1.5, kM_N = 2.7, kShort_s = 120.0, kLong_s = 7200.0, kRest_N = 0.2;

Result<double> gain_after(Session& s, double cycling_s, double rest_s) {
  Sequence load;
  if (cycling_s > 0.0) {
    FORCEGATE_TRY(auto cycling, make_stimulus(sine(0.5, kA_N, kM_N, cycling_s)));
    load.add(std::move(cycling), cycling_s);
  }
  FORCEGATE_TRY(auto pause, make_stimulus(rest(kRest_N, rest_s)));
  load.add(std::move(pause), rest_s);
  FORCEGATE_TRY(auto ramp,
                make_stimulus({"ramp", {{"low_N", kRest_N}, {"high_N", s.plan.sweep_high_N}}, {}, {}, 1}));
  const double ramp_s = ramp->duration_s(), from_s = cycling_s + rest_s;
  load.add(std::move(ramp), ramp_s);
  const double per_code = s.bench.volts_per_code();
  double n = 0, u1 = 0, f1 = 0, uu = 0, uf = 0;
  FORCEGATE_TRY(const PlayedRecord played,
                s.bench.play(load, [&](const RigBlock& b, std::size_t rows, std::span<const float>) {
                  for (std::size_t i = 0; i < rows; i += 10) {
                    if (b.t_s[i] < from_s || b.adc[i] == 0) continue;  // 0 V: below the offset
                    const double u = per_code * b.adc[i], f = static_cast<double>(b.force_ref_N[i]);
                    n += 1, u1 += u, f1 += f, uu += u * u, uf += u * f;
                  }
                }));
  (void)played;
  return (uf - u1 * f1 / n) / (uu - u1 * u1 / n);
}

Result<void> run(Session& s) {
  FORCEGATE_TRY(const double fresh, gain_after(s, 0.0, kShort_s));
  FORCEGATE_TRY(const double after, gain_after(s, s.plan.record_s, kShort_s));
  s.add("cycling.gain", "Change of the static gain by 20 min of cycling", "%", 100.0 * (after / fresh - 1.0));
  return {};
}

Result<void> run_rested(Session& s) {
  FORCEGATE_TRY(const double fresh, gain_after(s, 0.0, kShort_s));
  FORCEGATE_TRY(const double rested, gain_after(s, s.plan.record_s, kLong_s));
  s.add("cycling.gain_rested", "Change of the static gain 2 h after the cycling", "%",
        100.0 * (rested / fresh - 1.0));
  return {};
}

const Registration<ProcedureKind> kAfter{
    {"cycling_gain", "Static gain after 20 min of cycling (III-D)", true, run,
     always({"cycling.gain"})}};
const Registration<ProcedureKind> kRested{
    {"gain_recovery", "Static gain after 20 min of cycling and 2 h of rest (IV-A3)", true, run_rested,
     always({"cycling.gain_rested"})}};

}  // namespace
}  // namespace forcegate::characterize
