// Erratic maxima of the FSR (III-D, Fig. 7): 3.5 N +- 0.4 N at 0.5 Hz. The maxima mostly fall, sometimes rise.

#include "hil/characterize/session.h"

namespace forcegate::characterize {
namespace {

Result<void> run(Session& s) {
  CurveSink curve("fig7", 0.0, s.plan.record_s, s.bench.volts_per_code());
  FORCEGATE_TRY(const DecayRecord d,
                play_decay(s, "figure 7", sine(0.5, 0.4, 3.5, s.plan.record_s), 0.5,
                           [&](const RigBlock& b, std::size_t n, std::span<const float> none) {
                             if (s.curves) curve(b, n, none);
                           }));
  s.add("erratic.loss", "Loss of the maxima, 3.5 N +- 0.4 N at 0.5 Hz", "%", 100.0 * d.loss);
  s.add("erratic.wander", "Wandering of single maxima about their neighbours", "%", d.wander_pct);
  s.add("erratic.rises", "The maxima rise", "%", d.loss < 0.0 ? 100.0 : 0.0);
  if (s.curves) s.sheet.curves.push_back(curve.finish());
  return {};
}

const Registration<ProcedureKind> kRow{
    {"erratic_maxima", "3.5 N +- 0.4 N at 0.5 Hz: erratic maxima of the FSR (Fig. 7)", true, run,
     always({"erratic.loss", "erratic.wander", "erratic.rises"})}};

}  // namespace
}  // namespace forcegate::characterize
