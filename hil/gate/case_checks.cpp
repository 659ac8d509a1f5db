#include "hil/gate/case_checks.h"

#include <limits>

namespace forcegate {

Check& CaseChecks::final_check(std::string id, std::string title, Verdict verdict, Blame blame,
                               std::string evidence) {
  JudgedCheck j;
  j.judgeable = false;
  j.check.id = std::move(id);
  j.check.case_id = case_id_;
  j.check.title = std::move(title);
  j.check.value = std::numeric_limits<double>::quiet_NaN();
  j.check.verdict = verdict;
  j.check.blame = blame;
  j.check.evidence = std::move(evidence);
  list.push_back(std::move(j));
  return list.back().check;
}

Check& CaseChecks::value_check(std::string id, std::string title, double value, std::string unit, double u,
                               std::uint64_t n, Limit limit, std::string evidence) {
  JudgedCheck j;
  Check& c = j.check;
  c.id = std::move(id);
  c.case_id = case_id_;
  c.title = std::move(title);
  c.value = value;
  c.unit = std::move(unit);
  c.u = u;
  c.n = n;
  c.limit = std::move(limit);
  c.evidence = std::move(evidence);
  if (c.limit.kind == Limit::Kind::none) c.required = false;
  if (!rig_sound) {
    j.judgeable = false;
    c.verdict = Verdict::rig_error;
    c.blame = rig_blame;
  } else if (!complete && c.limit.kind != Limit::Kind::none) {
    j.judgeable = false;
    c.verdict = Verdict::inconclusive;
    c.blame = incomplete_blame;
  }
  list.push_back(std::move(j));
  return list.back().check;
}

void CaseChecks::keep(Check c) {
  c.case_id = case_id_;
  list.push_back({std::move(c), 0.0, false});
}

void CaseChecks::unsound(Blame blame) {
  if (rig_sound) rig_blame = blame;
  rig_sound = false;
}

void CaseChecks::judge_even_if_incomplete() {
  JudgedCheck& j = list.back();
  if (rig_sound && !complete && j.check.value > j.check.limit.value) {
    j.judgeable = true;
    j.check.blame = Blame::firmware;
  }
}

void CaseChecks::repeatable(double u_systematic) {
  list.back().repeatable = list.back().judgeable;
  list.back().u_systematic = u_systematic;
}

}  // namespace forcegate
