// Sum of four sines (IV-A2c): 0.1 N 1 Hz, 0.2 N 0.5 Hz, 0.3 N 0.1 Hz, 0.4 N 0.05 Hz.

#include "hil/characterize/session.h"

namespace forcegate::characterize {
namespace {

constexpr double kWholeSwing = 1.4;

Result<void> run(Session& s) {
  FORCEGATE_TRY(DecayRecord d, play_decay(s, "four sines",
                                          sum_of_sines({1.0, 0.5, 0.1, 0.05}, {0.1, 0.2, 0.3, 0.4},
                                                       s.plan.four_sines_m_N, s.plan.record_s),
                                          kWholeSwing));
  s.sheet.decays.push_back(std::move(d));
  return {};
}

const Registration<ProcedureKind> kRow{{"four_sines", "Sum of four sines (IV-A2c)", true, run}};

}  // namespace
}  // namespace forcegate::characterize
