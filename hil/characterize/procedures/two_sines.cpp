// Sums of two sines (IV-A2b, Table III): the laws take the lower frequency and the amplitude of the sum. Only turns
// of most of the whole swing count as maxima, for the envelope is what decays.

#include "hil/characterize/session.h"

namespace forcegate::characterize {
namespace {

constexpr double kWholeSwing = 1.5;

Result<void> run(Session& s) {
  const StudyPlan& p = s.plan;
  for (std::size_t i = 0; i < p.two_sines_f1_Hz.size(); ++i) {
    FORCEGATE_TRY(DecayRecord d,
                  play_decay(s, "two sines",
                             sum_of_sines({p.two_sines_f1_Hz[i], p.two_sines_f2_Hz[i]},
                                          {p.two_sines_A_N, p.two_sines_A_N}, p.two_sines_m_N, p.record_s),
                             kWholeSwing));
    d.f_Hz = p.two_sines_f1_Hz[i];
    d.f2_Hz = p.two_sines_f2_Hz[i];
    s.sheet.decays.push_back(std::move(d));
  }
  return {};
}

const Registration<ProcedureKind> kRow{{"two_sines", "Sums of two sines, Table III (IV-A2b)", true, run}};

}  // namespace
}  // namespace forcegate::characterize
