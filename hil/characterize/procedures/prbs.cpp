// Pseudo random binary signal, 0 to 5 Hz, A = 1.6 N, m = 2.6 N (IV-A2c). Its lowest frequency is 0, which is what
// the laws take.

#include "hil/base/rng.h"
#include "hil/characterize/session.h"

namespace forcegate::characterize {
namespace {

Result<void> run(Session& s) {
  const StudyPlan& p = s.plan;
  const StimulusSpec spec{
      "prbs",
      {{"f_max_Hz", p.prbs_Hz}, {"A_N", p.prbs_A_N}, {"m_N", p.prbs_m_N}, {"duration_s", p.record_s}},
      {},
      {},
      mix_seed(p.seed, "prbs")};
  FORCEGATE_TRY(DecayRecord d, play_decay(s, "prbs", spec, 1.0));
  s.sheet.decays.push_back(std::move(d));
  return {};
}

const Registration<ProcedureKind> kRow{{"prbs", "Binary signal 0 to 5 Hz (IV-A2c)", true, run}};

}  // namespace
}  // namespace forcegate::characterize
