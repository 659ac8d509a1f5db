// Sweeps (IV-A2a): 0 to 3 Hz and back in 20 minutes each; the laws take the frequency at the start.

#include "hil/characterize/session.h"

namespace forcegate::characterize {
namespace {

Result<void> run(Session& s) {
  const StudyPlan& p = s.plan;
  for (const bool up : {true, false}) {
    const StimulusSpec chirp{"chirp",
                             {{"f_start_Hz", up ? 0.0 : p.sweep_up_Hz},
                              {"f_end_Hz", up ? p.sweep_up_Hz : 0.0},
                              {"A_N", p.sweep_A_N},
                              {"m_N", p.sweep_m_N},
                              {"duration_s", p.record_s}},
                             {},
                             {},
                             1};
    FORCEGATE_TRY(DecayRecord d, play_decay(s, up ? "sweep up" : "sweep down", chirp, 0.8));
    d.f_Hz = up ? 0.0 : p.sweep_up_Hz;
    s.sheet.decays.push_back(std::move(d));
  }
  return {};
}

const Registration<ProcedureKind> kRow{
    {"frequency_sweep", "Sweeps 0 to 3 Hz, up and down (IV-A2a)", true, run}};

}  // namespace
}  // namespace forcegate::characterize
