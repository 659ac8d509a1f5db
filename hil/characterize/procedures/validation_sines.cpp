// Cross-validation (IV-A1c): sines that the laws (5) were not fitted to.

#include "hil/characterize/session.h"

namespace forcegate::characterize {
namespace {

Result<void> run(Session& s) {
  for (const SineSpec& spec : s.plan.validation) {
    FORCEGATE_TRY(DecayRecord d,
                  play_decay(s, "validation", sine(spec.f_Hz, spec.A_N, spec.m_N, s.plan.record_s)));
    s.sheet.decays.push_back(std::move(d));
  }
  return {};
}

const Registration<ProcedureKind> kRow{
    {"validation_sines", "Independent sines for the cross-validation of eq. (5) (IV-A1c)", true, run}};

}  // namespace
}  // namespace forcegate::characterize
