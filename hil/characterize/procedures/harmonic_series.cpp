// Harmonic series (III-C, IV-A1): the sines of Table II, 20 minutes each; eq. (3) fitted to the maxima of each one.
// The exemplar also plays the 0.25 Hz record of Fig. 6.

#include <fmt/format.h>

#include <cmath>

#include "hil/characterize/session.h"
#include "hil/gate/statistics.h"

namespace forcegate::characterize {
namespace {

Result<void> keep_figure_6(Session& s) {
  CurveSink curve("fig6", 0.0, s.plan.record_s, s.bench.volts_per_code());
  FORCEGATE_TRY(const DecayRecord d, play_decay(s, "figure 6", sine(0.25, 1.55, 2.85, s.plan.record_s), 0.5,
                                                [&](const RigBlock& b, std::size_t n,
                                                    std::span<const float> e) { curve(b, n, e); }));
  s.add("harmonic.fig6_loss", "Loss of the maxima, 1.3 to 4.4 N at 0.25 Hz", "%", 100.0 * d.loss);
  s.sheet.curves.push_back(curve.finish());
  return {};
}

Result<void> run(Session& s) {
  if (s.plan.harmonic.empty())
    return fail(ErrorCode::config, "the plan has no [harmonic] sines", s.plan.path.string());
  std::vector<double> loss, minima, wander;
  int rising = 0, fitted = 0;
  for (const SineSpec& spec : s.plan.harmonic) {
    Extrema extrema;
    const bool figure_13 = s.curves && spec.f_Hz == 0.5 && spec.A_N == 1.5;
    FORCEGATE_TRY(DecayRecord d, play_decay(s, "series", sine(spec.f_Hz, spec.A_N, spec.m_N, s.plan.record_s),
                                            0.5, {}, figure_13 ? &extrema : nullptr));
    if (figure_13) s.sheet.curves.push_back(extrema_curve("fig13", extrema));
    loss.push_back(100.0 * d.loss);
    minima.push_back(std::abs(d.minima_drift_pct));
    wander.push_back(d.wander_pct);
    rising += d.loss < 0.0;
    fitted += d.fitted;
    s.sheet.decays.push_back(std::move(d));
  }
  const double n = static_cast<double>(s.plan.harmonic.size());
  s.add("harmonic.loss", "Mean loss of the maxima over the series", "%", moments(loss).mean);
  s.add("harmonic.loss_largest", "Largest loss in the series", "%", sample_quantile(loss, 1.0));
  s.add("harmonic.minima_drift", "Mean |drift| of the minima, share of the first swing", "%",
        moments(minima).mean);
  s.add("harmonic.wander", "Wandering of single maxima, share of the swing", "%", moments(wander).mean);
  s.add("harmonic.rising", "Records whose maxima rise", "%", 100.0 * rising / n);
  s.add("harmonic.fitted", "Records that eq. (3) fits", "%", 100.0 * fitted / n);
  return s.curves ? keep_figure_6(s) : Result<void>{};
}

const Registration<ProcedureKind> kRow{
    {"harmonic_series", "The sines of Table II: decay of the maxima, eq. (3), (8) (III-C, IV-A1, Fig. 6, 13)",
     true, run,
     always({"harmonic.loss", "harmonic.loss_largest", "harmonic.minima_drift", "harmonic.wander", "harmonic.rising", "harmonic.fitted"})}};

}  // namespace
}  // namespace forcegate::characterize
