#include "hil/gate/rule.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <limits>

#include "hil/gate/statistics.h"

namespace forcegate {
namespace {

// Distance inside the limit: positive is good.
double inside_by(const Check& c) {
  switch (c.limit.kind) {
    case Limit::Kind::upper: return c.limit.value - c.value;
    case Limit::Kind::lower: return c.value - c.limit.value;
    case Limit::Kind::equal: return -std::fabs(c.value - c.limit.value);
    case Limit::Kind::none: return std::numeric_limits<double>::infinity();
  }
  return std::numeric_limits<double>::quiet_NaN();
}

// Once, although the rule may run again.
void note(Check& c, std::string_view text) {
  if (!c.evidence.ends_with(text)) c.evidence += text;
}

}  // namespace

std::string DecisionRule::to_text() const {
  const std::string more =
      looks > 1
          ? fmt::format(", after up to {} sessions of what is undecided, each look at {:.4g} % and {:.4g} %",
                        looks, 100.0 * coverage_per_look(), 100.0 * alpha_per_look())
          : "";
  return fmt::format(
      "{}: accept when value + U <= limit ({:.4g} % coverage){}; reject when value - U > limit and Holm at "
      "{:.4g} % over the required checks agrees; in between no decision{}",
      name, 100.0 * coverage, name == "simple" ? " or value <= limit" : "", 100.0 * alpha, more);
}

Verdict zone(const Check& check, double expanded_U) {
  const double margin = inside_by(check);
  if (std::isnan(margin) || !(expanded_U >= 0.0)) return Verdict::inconclusive;
  if (check.limit.kind == Limit::Kind::equal && margin == 0.0) return Verdict::pass;
  if (margin >= expanded_U) return Verdict::pass;
  if (margin >= 0.0) return Verdict::marginal;
  return -margin > expanded_U ? Verdict::fail : Verdict::inconclusive;
}

double exceedance_p(const Check& check, double dof) {
  const double margin = inside_by(check);
  if (std::isnan(margin)) return std::numeric_limits<double>::quiet_NaN();
  if (!(check.u > 0.0)) return margin < 0.0 ? 0.0 : 1.0;
  return 1.0 - student_cdf(-margin / check.u, dof);
}

void apply_rule(const DecisionRule& rule, std::vector<JudgedCheck*>& checks) {
  std::vector<double> p_values;
  std::vector<JudgedCheck*> family;
  for (JudgedCheck* j : checks) {
    if (!j->judgeable) continue;
    Check& c = j->check;
    const double U = c.u > 0.0 ? coverage_factor(rule.coverage_per_look(), j->dof) * c.u : c.u;
    c.expanded_u = U;
    c.verdict = zone(c, U);
    if (c.verdict == Verdict::fail && -inside_by(c) <= U + j->explained) {
      c.verdict = Verdict::inconclusive;
      c.blame = Blame::calibration;
      note(c, fmt::format("; up to {:.3g} {} of it may be the calibration, which at the beginning of the record does not fit the ATI better", j->explained, c.unit));
    }
    // An exact count cannot be beyond its limit by chance: it is not part of the family.
    if (c.required && c.limit.kind != Limit::Kind::none && c.u > 0.0) {
      p_values.push_back(exceedance_p(c, j->dof));
      family.push_back(j);
    }
  }
  const std::vector<bool> rejected = holm(p_values, rule.alpha_per_look());
  for (std::size_t i = 0; i < family.size(); ++i)
    if (family[i]->check.verdict == Verdict::fail && !rejected[i]) {
      Check& c = family[i]->check;
      c.verdict = Verdict::inconclusive;
      note(c, "; beyond the limit, but not beyond doubt among this many checks");
    }
  for (JudgedCheck* j : checks) {
    if (!j->judgeable) continue;
    Check& c = j->check;
    if (c.verdict == Verdict::pass || c.verdict == Verdict::marginal)
      c.blame = Blame::none;
    else if (c.blame == Blame::none)
      c.blame = Blame::firmware;
  }
}

std::vector<const JudgedCheck*> worth_another_session(const DecisionRule& rule,
                                                      const std::vector<JudgedCheck*>& checks) {
  std::vector<const JudgedCheck*> open;
  for (const JudgedCheck* j : checks) {
    const Check& c = j->check;
    if (!c.required || c.verdict == Verdict::pass || c.verdict == Verdict::waived) continue;
    if (c.verdict == Verdict::marginal && rule.name == "simple") continue;
    const bool undecided = c.verdict == Verdict::marginal || c.verdict == Verdict::inconclusive;
    if (!undecided || !j->judgeable || !j->repeatable) return {};
    // More sessions move the value by at most about k u_random and leave k u_systematic.
    const double random = std::sqrt(std::max(0.0, c.u * c.u - j->u_systematic * j->u_systematic));
    const double k = coverage_factor(rule.coverage_per_look(), j->dof);
    if (!(std::fabs(inside_by(c)) + k * random > k * j->u_systematic)) return {};
    open.push_back(j);
  }
  return open;
}

}  // namespace forcegate
