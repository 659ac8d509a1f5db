#include "hil/gate/no_worse.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "hil/gate/judged_extrema.h"
#include "hil/gate/runner.h"
#include "hil/gate/statistics.h"

namespace forcegate {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kSameExtremum_s = 0.25;

bool compared(const PlanCase& planned) { return (planned.checks & (kCheckAccuracy | kCheckPromise)) != 0; }

struct Errors {
  std::vector<double> t_s, error_pct;
};

Errors errors_of(const PlanCase& planned, const CaseRecord& record, bool maximum, double from_s) {
  Errors out;
  const bool closed = planned.loop == LoopMode::closed;
  for (const CasePair& p : record.pairs) {
    if (p.maximum != maximum || p.t_s < from_s) continue;
    const double expected = closed ? p.setpoint_N : p.ati_N, actual = closed ? p.ati_N : p.dut_N;
    if (std::fabs(expected) < kExtremumFloor_N) continue;
    out.t_s.push_back(p.t_s);
    out.error_pct.push_back(100.0 * std::fabs(actual - expected) / std::fabs(expected));
  }
  return out;
}

}  // namespace

NoPartner no_partner(const std::string& record, std::span<const Check> accepted, bool stored) {
  const auto first = [&](auto is) {
    const auto at = std::find_if(accepted.begin(), accepted.end(), is);
    return at == accepted.end() ? nullptr : &*at;
  };
  const auto words = [](const Check& c) { return c.evidence.empty() ? c.title : c.evidence; };
  const Check* const dead = first([](const Check& c) { return c.id == "firmware_runs" && c.verdict == Verdict::fail; });
  if (dead != nullptr)
    return {Verdict::not_run, Blame::user, fmt::format("the accepted build gives no record {}: {}; give one that runs (--accepted)", record, words(*dead))};
  const Check* const rig = first([](const Check& c) { return c.required && c.verdict == Verdict::rig_error; });
  if (rig != nullptr && stored)
    return {Verdict::not_run, Blame::user,
            fmt::format("the rig was at fault in {} of the accepted run: {}; give a run on a sound rig (--accepted)", record, words(*rig))};
  if (rig != nullptr)
    return {Verdict::rig_error, rig->blame == Blame::none ? Blame::rig : rig->blame,
            fmt::format("the rig was at fault in the accepted build's record of {}: {}", record, words(*rig))};
  const Check* const missing = first([](const Check& c) { return c.id == "record" && c.verdict == Verdict::not_run; });
  if (missing != nullptr)
    return {Verdict::not_run, missing->blame, fmt::format("the accepted build's record of {} was not played: {}", record, words(*missing))};
  const Check* const part = first([](const Check& c) {
    return (c.id == "coverage" || c.id == "extrema_count" || c.id == "rig_calibration_fits") && c.verdict == Verdict::inconclusive;
  });
  if (part != nullptr)
    return {Verdict::inconclusive, stored ? Blame::user : part->blame, fmt::format("{} of the accepted build is no whole record: {}", record, words(*part))};
  return {};
}

std::vector<ErrorIncrease> error_increases(const Plan& plan, const PlanCase& planned,
                                           const CaseRecord& candidate, const CaseRecord& accepted, const NoPartner& partner) {
  std::vector<ErrorIncrease> out;
  if (!compared(planned)) return out;
  const double low_N = minima_N(planned, candidate);
  const double from_s = std::max(judged_from_s(planned, candidate), judged_from_s(planned, accepted));
  for (const bool maximum : {true, false}) {
    if (!maximum && low_N < plan.limits.minima_floor_N) continue;
    ErrorIncrease e;
    e.case_name = planned.name;
    e.record = candidate.id;
    e.maximum = maximum;
    e.increase_pct = kNan;
    e.no_partner = partner;
    const Errors a = errors_of(planned, candidate, maximum, from_s),
                 b = errors_of(planned, accepted, maximum, from_s);
    bool pairs = !candidate.failure && !accepted.failure && a.t_s.size() == b.t_s.size() && a.t_s.size() > 1;
    std::vector<double> differences;
    for (std::size_t i = 0; pairs && i < a.t_s.size(); ++i) {
      pairs =
          std::fabs(a.t_s[i] - b.t_s[i]) <= kSameExtremum_s && std::isfinite(a.error_pct[i] - b.error_pct[i]);
      differences.push_back(a.error_pct[i] - b.error_pct[i]);
    }
    if (pairs) {
      const Moments m = moments(differences);
      e.increase_pct = m.mean;
      e.u_pct = m.sd / std::sqrt(static_cast<double>(m.n));
      e.n = m.n;
    }
    out.push_back(std::move(e));
  }
  return out;
}

std::vector<ErrorIncrease> error_increases(const PlanCase& planned, const std::string& record,
                                           std::span<const JudgedCheck> candidate, const CaseResult& accepted, bool repeats) {
  std::vector<ErrorIncrease> out;
  if (!compared(planned)) return out;
  const auto find = [](std::span<const Check> checks, std::string_view id) -> const Check* {
    for (const Check& c : checks)
      if (c.id == id) return &c;
    return nullptr;
  };
  const auto own = [&](std::string_view id) -> const JudgedCheck* {
    for (const JudgedCheck& j : candidate)
      if (j.check.id == id) return &j;
    return nullptr;
  };
  const bool promise = (planned.checks & kCheckPromise) != 0;
  const NoPartner partner = no_partner(record, accepted.checks, true);
  for (const bool maximum : {true, false}) {
    const char* id = maximum ? "mre_maxima" : "mre_minima";
    const JudgedCheck* const judged = own(id);
    const Check *a = judged != nullptr ? &judged->check : nullptr, *b = find(accepted.checks, id);
    if (partner.verdict != Verdict::pass) {
      out.push_back({planned.name, record, maximum, kNan, 0.0, 0, partner});
      continue;
    }
    // In a closed loop no single record is judged; in an open one a missing limit means that mae is judged
    // instead.
    if (a == nullptr || (!promise && a->limit.kind == Limit::Kind::none)) continue;
    ErrorIncrease e{planned.name, record, maximum, kNan, 0.0, 0, {}};
    if (b != nullptr && a->verdict != Verdict::rig_error && b->verdict != Verdict::rig_error) {
      e.increase_pct = a->value - b->value;
      const double random = repeats && a->u > 0.0 ? std::sqrt(std::max(0.0, 1.0 - std::pow(judged->u_systematic / a->u, 2))) : 1.0;
      e.u_pct = random * std::hypot(a->u, b->u);
      e.n = a->n;
    }
    out.push_back(std::move(e));
  }
  return out;
}

std::vector<JudgedCheck> judge_no_worse(const Plan& plan, std::span<const ErrorIncrease> increases,
                                        bool repeats) {
  std::map<std::pair<std::string, bool>, std::vector<const ErrorIncrease*>> groups;
  std::vector<std::pair<std::string, bool>> order;
  for (const ErrorIncrease& e : increases) {
    auto& group = groups[{e.case_name, e.maximum}];
    if (group.empty()) order.emplace_back(e.case_name, e.maximum);
    group.push_back(&e);
  }
  std::vector<JudgedCheck> out;
  for (const auto& key : order) {
    const auto& group = groups[key];
    const char* which = key.second ? "maxima" : "minima";
    const auto n = static_cast<double>(group.size());
    double sum = 0.0, squares = 0.0, worst = -std::numeric_limits<double>::infinity();
    const ErrorIncrease* at = group.front();
    for (const ErrorIncrease* e : group) {
      sum += e->increase_pct;
      squares += e->u_pct * e->u_pct;
      if (e->increase_pct > worst) {
        worst = e->increase_pct;
        at = e;
      }
    }
    JudgedCheck j;
    Check& c = j.check;
    c.id = fmt::format("no_worse_{}/{}", which, key.first);
    c.title = fmt::format("Increase of the mean relative error of the {} against the accepted build", which);
    c.value = sum / n;  // NaN when any pair is missing
    c.unit = std::string("%");
    c.n = group.size();
    j.repeatable = true;
    c.u = std::sqrt(squares) / n;
    if (!repeats) c.u = std::hypot(c.u, plan.uncertainty.record_repeat_pct * std::sqrt(2.0 / n));
    c.limit = {Limit::Kind::upper, plan.limits.increase_pct, "ours: plan, percentage points"};
    c.evidence = std::isfinite(c.value)
                     ? fmt::format("{} records, worst {:+.3f} points on {}", group.size(), worst, at->record)
                     : "not every record of the two builds has its partner";
    const auto alone = std::find_if(group.begin(), group.end(), [](const ErrorIncrease* e) { return e->no_partner.verdict != Verdict::pass; });
    if (alone != group.end()) {  // nothing to compare with says nothing of the candidate
      const NoPartner& why = (*alone)->no_partner;
      j.judgeable = false;
      c.verdict = why.verdict;
      c.blame = why.blame;
      c.evidence = why.evidence;
      c.value = kNan;
    }
    out.push_back(std::move(j));
  }
  return out;
}

}  // namespace forcegate
