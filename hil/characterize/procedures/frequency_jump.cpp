// Jump of the frequency (IV-A3, Fig. 8): 0.5, then 2, then 3 Hz, a third of the record each, beside a record that stays
// at 0.5 Hz. The bump is the largest rise of the swing (means over 2 s) within 20 s of the switch, as a share of the
// swing lost until then; the return is the difference to the undisturbed record 100 s after the switch.

#include <algorithm>
#include <cmath>

#include "hil/characterize/session.h"

namespace forcegate::characterize {
namespace {

constexpr double kA_N = 1.5, kM_N = 2.7, kLook_s = 20.0, kReturn_s = 100.0;

double bump_of(const Extrema& e, double low_V, double fresh_V, double switch_s) {
  const double before_V = e.swing_V(low_V, switch_s - 20.0, switch_s);
  double peak_V = 0.0;
  for (double t = switch_s + 1.0; t < switch_s + kLook_s; t += 2.0)
    peak_V = std::max(peak_V, e.swing_V(low_V, t, t + 2.0));
  return (peak_V - before_V) / (fresh_V - before_V);
}

Result<void> run(Session& s) {
  const double third_s = std::floor(s.plan.record_s / 3.0);
  const StimulusSpec jump{"jump",
                          {{"A_N", kA_N}, {"m_N", kM_N}},
                          {{"f_Hz", {0.5, 2.0, 3.0}}, {"stretch_s", {third_s, third_s, third_s}}},
                          {},
                          1};
  CurveSink curve("fig8", 0.0, 3.0 * third_s, s.bench.volts_per_code());
  Extrema with, without;
  FORCEGATE_TRY(DecayRecord d, play_decay(
                                   s, "jump", jump, 0.5,
                                   [&](const RigBlock& b, std::size_t n, std::span<const float> none) {
                                     if (s.curves) curve(b, n, none);
                                   },
                                   &with));
  FORCEGATE_TRY(DecayRecord plain,
                play_decay(s, "jump control", sine(0.5, kA_N, kM_N, 3.0 * third_s), 0.5, {}, &without));
  const double fresh_V = with.swing_V(d.u_min_V, 0.0, 4.0);
  s.add("jump.bump", "Rise at the jump 0.5 to 2 Hz, share of the lost swing", "%",
        100.0 * bump_of(with, d.u_min_V, fresh_V, third_s));
  s.add("jump.second_bump", "Rise at the jump 2 to 3 Hz, share of the lost swing", "%",
        100.0 * bump_of(with, d.u_min_V, fresh_V, 2.0 * third_s));
  const double at_s = third_s + kReturn_s;
  const double back_V = with.swing_V(d.u_min_V, at_s, at_s + 20.0),
               undisturbed_V = without.swing_V(plain.u_min_V, at_s, at_s + 20.0);
  s.add("jump.return", "100 s after the jump, against the record without it", "%",
        100.0 * (back_V / undisturbed_V - 1.0));
  if (s.curves) {
    s.sheet.curves.push_back(curve.finish());
    s.sheet.curves.push_back(extrema_curve("fig8_control", without));
  }
  return {};
}

const Registration<ProcedureKind> kRow{
    {"frequency_jump", "0.5, 2, 3 Hz in one record: the sudden rise and the return (Fig. 8)", true, run,
     always({"jump.bump", "jump.second_bump", "jump.return"})}};

}  // namespace
}  // namespace forcegate::characterize
