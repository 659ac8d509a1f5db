// Time drift (III-A): a load at rest for 20 minutes; mean output of the last second against that of the first one.

#include "hil/characterize/session.h"

namespace forcegate::characterize {
namespace {

constexpr double kLoad_N = 3.0, kMeanOver_s = 1.0;

Result<void> run(Session& s) {
  const double per_code = s.bench.volts_per_code();
  double first = 0, first_n = 0, last = 0, last_n = 0;
  FORCEGATE_TRY(const PlayedRecord played,
                s.bench.play(rest(kLoad_N, s.plan.record_s),
                             [&](const RigBlock& b, std::size_t n, std::span<const float>) {
                               for (std::size_t i = 0; i < n; ++i) {
                                 if (b.t_s[i] < kMeanOver_s) first += per_code * b.adc[i], first_n += 1;
                                 if (b.t_s[i] >= s.plan.record_s - kMeanOver_s)
                                   last += per_code * b.adc[i], last_n += 1;
                               }
                             }));
  (void)played;
  s.add("static.drift", "Drift of the output under 3 N at rest over the record", "%",
        100.0 * (last / last_n / (first / first_n) - 1.0));
  return {};
}

const Registration<ProcedureKind> kRow{
    {"rest_drift", "3 N at rest for 20 min: drift of the output (III-A)", true, run,
     always({"static.drift"})}};

}  // namespace
}  // namespace forcegate::characterize
