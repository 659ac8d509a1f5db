#include "hil/gate/judge_excursion.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "hil/base/quantile.h"
#include "hil/gate/budget.h"

namespace forcegate {
namespace {

constexpr std::size_t kAround = 15, kExtremaNeeded = 5;

struct Excursion {
  double value_N = 0.0;      ///< of firmware against ATI
  double of_codes_N = 0.0;   ///< at the same extremum, of the sensor's static force against ATI
  const CasePair* at = nullptr;
};

double beyond_those_around(const std::vector<double>& errors_N, std::size_t i) {
  const std::size_t from = i > kAround ? i - kAround : 0, to = std::min(errors_N.size(), i + kAround + 1);
  return std::fabs(errors_N[i] - median({errors_N.begin() + static_cast<std::ptrdiff_t>(from), errors_N.begin() + static_cast<std::ptrdiff_t>(to)}));
}

Excursion largest_excursion(const CaseRecord& record) {
  const double from_s = std::max(record.facts.excitation_start_s, record.output.learning_end_s);
  Excursion out;
  for (const bool maximum : {true, false}) {
    std::vector<const CasePair*> extrema;
    std::vector<double> errors_N, of_codes_N;
    for (const CasePair& p : record.pairs)
      if (p.maximum == maximum && p.t_s >= from_s && std::isfinite(p.dut_N - p.ati_N)) {
        extrema.push_back(&p);
        errors_N.push_back(p.dut_N - p.ati_N);
        of_codes_N.push_back(p.raw_N - p.ati_N);
      }
    if (extrema.size() < kExtremaNeeded) continue;
    for (std::size_t i = 0; i < extrema.size(); ++i)
      if (const double value_N = beyond_those_around(errors_N, i); out.at == nullptr || value_N > out.value_N)
        out = {value_N, beyond_those_around(of_codes_N, i), extrema[i]};
  }
  return out;
}

}  // namespace

void judge_excursion(const Plan& plan, const PlanCase& planned, const CaseRecord& record, CaseChecks& checks) {
  constexpr double kMostOfIt = 0.5;
  if (record.conformance_known) return;
  const Excursion e = largest_excursion(record);
  if (e.at == nullptr) return;
  const CasePair& at = *e.at;
  const Budget budget = mae_budget(plan.uncertainty, record, std::fabs(at.ati_N), std::numeric_limits<double>::quiet_NaN(), 1, planned.half_width_s);
  checks.value_check("output_excursion", "Largest error of the firmware at one extremum beyond those around it", e.value_N, "N", budget.u(), record.pairs.size(),
                     {Limit::Kind::upper, plan.limits.excursion_max_N, "ours: plan"},
                     fmt::format("{} at {:.1f} s: firmware {:.2f} N, ATI {:.2f} N; {}", at.maximum ? "maximum" : "minimum", at.t_s, at.dut_N, at.ati_N, budget.to_text("N", false)));
  if (checks.incomplete_blame == Blame::firmware) checks.judge_even_if_incomplete();
  JudgedCheck& j = checks.list.back();
  if (!j.judgeable || e.value_N <= plan.limits.excursion_max_N) return;
  // In a closed loop the codes follow what the firmware asked for: there the spring is the witness.
  const bool closed = planned.loop == LoopMode::closed, in_the_codes = !closed && e.of_codes_N > kMostOfIt * e.value_N;
  if (!in_the_codes && record.observed.spring_samples > 0) return;
  j.judgeable = false;
  j.check.verdict = Verdict::inconclusive;
  j.check.blame = record.rig.can_move ? (in_the_codes ? Blame::sensor : Blame::rig) : Blame::recording;
  j.check.evidence += in_the_codes ? fmt::format("; the codes have {:.2f} N of it", e.of_codes_N) : "; no wheel angle is there to tell it from one of the ATI";
}

}  // namespace forcegate
