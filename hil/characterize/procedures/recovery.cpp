// Recovery (IV-A3): 20 minutes of cycling, a rest at the lowest force, the same cycling again. Swing 8 to 20 s after
// the start of the second cycling against the same instants of the first one.

#include <fmt/format.h>

#include "hil/characterize/sequence.h"
#include "hil/characterize/session.h"

namespace forcegate::characterize {
namespace {

constexpr double kA_N = 1.5, kM_N = 2.7, kAgain_s = 60.0, kFrom_s = 8.0, kTo_s = 20.0;

std::string key_of(double pause_s) { return fmt::format("recovery.{:.0f}", pause_s); }

Result<void> run(Session& s) {
  for (const double pause_s : s.plan.recovery_s) {
    Sequence load;
    FORCEGATE_TRY(auto first, make_stimulus(sine(0.5, kA_N, kM_N, s.plan.record_s)));
    FORCEGATE_TRY(auto pause, make_stimulus(rest(kM_N - kA_N, pause_s)));
    FORCEGATE_TRY(auto second, make_stimulus(sine(0.5, kA_N, kM_N, kAgain_s)));
    load.add(std::move(first), s.plan.record_s);
    load.add(std::move(pause), pause_s);
    load.add(std::move(second), kAgain_s);
    ExtremaSink sink(0.5 * kA_N, s.bench.volts_per_code());
    FORCEGATE_TRY(const PlayedRecord played,
                  s.bench.play(load, [&](const RigBlock& b, std::size_t n, std::span<const float> e) {
                    sink(b, n, e);
                  }));
    (void)played;
    const Extrema e = sink.finish();
    const double low_V = e.mean_minimum_V(), again_s = load.start_s(2);
    const double share =
        e.swing_V(low_V, again_s + kFrom_s, again_s + kTo_s) / e.swing_V(low_V, kFrom_s, kTo_s);
    s.add(key_of(pause_s),
          fmt::format("Swing of a fresh film that is back after {:.0f} min of rest", pause_s / 60.0), "%",
          100.0 * share);
  }
  return {};
}

std::vector<std::string> keys(const StudyPlan& plan, std::string_view) {
  std::vector<std::string> out;
  for (const double pause_s : plan.recovery_s) out.push_back(key_of(pause_s));
  return out;
}

const Registration<ProcedureKind> kRow{
    {"recovery", "Cycling, a rest of 5 min to 2 h, cycling again: what has come back (IV-A3)", true, run, keys}};

}  // namespace
}  // namespace forcegate::characterize
