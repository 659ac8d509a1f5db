#include "hil/gate/judge_output.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "hil/gate/judged_extrema.h"
#include "hil/gate/statistics.h"

namespace forcegate {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

// Nobody reads the thirty digits of a float that ran away.
std::string force_text(double force_N) { return std::fabs(force_N) < 1e6 ? fmt::format("{:.3f}", force_N) : fmt::format("{:.4g}", force_N); }

class OutputJudge {
 public:
  OutputJudge(const Plan& plan, const CaseRecord& record, bool calibration_fits, CaseChecks& checks)
      : plan_(plan), record_(record), calibration_fits_(calibration_fits), checks_(checks) {}

  void run() {
    const OutputFacts& o = record_.output;
    checks_.value_check(
        "output_finite", "Samples that are not a number", static_cast<double>(o.not_finite), "1", 0.0,
        record_.samples, {Limit::Kind::upper, 0.0, "ours: every sample is a number"},
        o.not_finite == 0 ? "every sample is finite"
                          : fmt::format("{} samples are NaN or infinite, the first at {:.3f} s", o.not_finite,
                                        o.first_not_finite_s));
    checks_.judge_even_if_incomplete();
    checks_.value_check(
        "output_bounded", "Largest force the firmware reported",
        std::isnan(o.minimum_N + o.maximum_N) ? kNan
                                              : std::max(std::fabs(o.minimum_N), std::fabs(o.maximum_N)),
        "N", 0.0, record_.samples, {Limit::Kind::upper, plan_.limits.output_max_N, "ours: plan"},
        fmt::format("{} to {} N", force_text(o.minimum_N), force_text(o.maximum_N)));
    if (calibration_fits_) checks_.judge_even_if_incomplete();
    spikes();
    // What lies before the end of the first window is not judged. One that begins later than it may last is no start window: all that it takes
    // out counts. (When a recording's own excitation began is known only roughly.)
    const double taken_out_s = std::max(0.0, o.learning_end_s - record_.facts.excitation_start_s);
    const bool late = taken_out_s - o.learning_longest_s > plan_.limits.learning_s;
    if (record_.facts.dynamic || taken_out_s > 0.0)
      checks_.value_check("learning_window", "Longest start window", late ? taken_out_s : o.learning_longest_s, "s", 0.0,
                          record_.samples, {Limit::Kind::upper, plan_.limits.learning_s, "ours: plan"},
                          fmt::format("the first window closed at {:.2f} s", o.learning_end_s));
    if (record_.facts.dynamic) lag();
  }

 private:
  void spikes() {
    const OutputFacts& o = record_.output;
    if (!std::isfinite(o.spike_N)) return;  // too few samples a second to tell a spike from a turn of the force
    checks_.value_check("output_spike", "Largest spike of the output where the code has none", o.spike_N, "N", 0.0, record_.samples,
                        {Limit::Kind::upper, plan_.limits.spike_max_N, "ours: plan"},
                        o.spike_N > 0.0 ? fmt::format("at {:.3f} s, against the samples 10 ms before and after it", o.spike_t_s) : "none");
    checks_.judge_even_if_incomplete();
  }

  void lag() {
    const double limit_s = plan_.limits.lag_s, period_s = shortest_period_s(record_.pairs, record_.facts.excitation_start_s);
    const bool known = std::isfinite(record_.lag_s);
    checks_.value_check("lag", "Distance in time between firmware and ATI", std::fabs(record_.lag_s), "s", known ? record_.u_lag_s : 0.0,
                        record_.samples, {Limit::Kind::upper, limit_s, "ours: plan"},
                        !known ? "cannot be told: the ATI's force hardly moves, or the output does not follow it"
                               : fmt::format("the firmware is {:.1f} ms {} the ATI", 1000.0 * std::fabs(record_.lag_s),
                                             record_.lag_s < 0.0 ? "ahead of" : "behind"));
    JudgedCheck& j = checks_.list.back();
    if (known && j.judgeable && beside_the_codes(j.check)) {
      j.judgeable = false;
      return;
    }
    if (!known || !j.judgeable || !(0.5 * period_s <= limit_s + coverage_factor(plan_.rule.coverage_per_look(), 0.0) * record_.u_lag_s)) return;
    // A delay by whole periods looks like none at all.
    j.judgeable = false;
    j.check.verdict = Verdict::inconclusive;
    j.check.blame = Blame::user;
    j.check.evidence += fmt::format(
        ", or that and whole periods of {:.3g} ms: half a period is no more than the limit of {:.3g} ms and its uncertainty; play a slower profile",
        1000.0 * period_s, 1000.0 * limit_s);
  }

  // What the codes bring along is not the firmware's: of a lag beyond the limit it is taken off, and where the ATI's reading
  // is the late one it is added to one inside. Where that turns the verdict there is none.
  bool beside_the_codes(Check& c) const {
    const double codes_s = record_.raw_lag_s, own_s = record_.lag_s - codes_s, limit_s = plan_.limits.lag_s;
    if (!std::isfinite(codes_s)) return false;
    const bool link = c.value > limit_s && std::fabs(own_s) <= limit_s, reference = c.value <= limit_s && codes_s < 0.0 && own_s > limit_s;
    if (!link && !reference) return false;
    c.verdict = Verdict::inconclusive;
    c.blame = codes_s < 0.0 ? Blame::reference : Blame::link;
    c.evidence += fmt::format(", but {:.1f} ms behind its codes, which are {:.1f} ms {} the ATI", 1000.0 * own_s,
                              1000.0 * std::fabs(codes_s), codes_s < 0.0 ? "ahead of" : "behind");
    return true;
  }

  const Plan& plan_;
  const CaseRecord& record_;
  const bool calibration_fits_;
  CaseChecks& checks_;
};

}  // namespace

void judge_output(const Plan& plan, const CaseRecord& record, bool calibration_fits, CaseChecks& checks) {
  OutputJudge(plan, record, calibration_fits, checks).run();
}

}  // namespace forcegate
