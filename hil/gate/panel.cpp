#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "hil/gate/judge.h"
#include "hil/gate/statistics.h"

namespace forcegate {
namespace {

// Values of a closed-loop case, specimen by specimen.
struct PanelTable {
  std::vector<std::vector<double>> values;
  std::vector<std::vector<const PanelValue*>> records;  // of the values
  double u_systematic = 0.0, explained = 0.0;  // of the worst session, mean over the records
  bool relative = true, whole = true;
  Blame missing = Blame::user;    // who is asked for the values that are not there: the profile has none of them
  bool rig_error = false;
  std::size_t n = 0;
};

PanelTable table_of(bool maximum, const std::vector<SpecimenSessions>& specimens) {
  PanelTable table;
  for (const SpecimenSessions& one : specimens) {
    std::vector<double> row;
    std::vector<const PanelValue*> records;
    for (const JudgedCase* session : one.sessions) {
      const PanelValue& v = maximum ? session->maxima : session->minima;
      table.relative = table.relative && v.unit == "%";
      for (const JudgedCheck& j : session->checks) {
        if (!j.check.required) continue;
        if (j.check.verdict == Verdict::rig_error && !table.rig_error) table.rig_error = true, table.missing = j.check.blame;
        if (j.check.verdict == Verdict::fail && !table.rig_error) table.missing = Blame::firmware;
      }
      if (!v.usable || !std::isfinite(v.value)) continue;
      row.push_back(v.value);
      records.push_back(&v);
      table.u_systematic = std::max(table.u_systematic, v.u_systematic);
      table.explained += v.explained;
    }
    table.whole = table.whole && !row.empty() && row.size() == one.sessions.size();
    table.n += row.size();
    if (row.empty()) continue;
    table.values.push_back(std::move(row));
    table.records.push_back(std::move(records));
  }
  table.explained /= std::max(1.0, static_cast<double>(table.n));
  return table;
}

// Of the mean over the specimens, each the mean of its sessions: the square of what differs from record to record. `believed`: `s` is
// what the plan declares, of a bench whose readings were no worse than it says; else it was observed here, noise of the readings and all.
double random_variance(const PanelTable& table, double s, bool believed) {
  double sum = 0.0;
  for (const auto& records : table.records) {
    double of_one = 0.0;
    for (const PanelValue* v : records) {
      const double readings = v->u_readings * v->u_readings, scatter = v->u_scatter * v->u_scatter;
      of_one += believed ? std::max(s * s, scatter) + readings : std::max(s * s, scatter + readings);
    }
    sum += of_one / static_cast<double>(records.size() * records.size());
  }
  return sum / static_cast<double>(table.records.size() * table.records.size());
}

JudgedCheck promise(const Plan& plan, const PlanCase& planned, bool maximum,
                    const std::vector<SpecimenSessions>& specimens) {
  const char* which = maximum ? "maxima" : "minima";
  const PanelTable table = table_of(maximum, specimens);
  JudgedCheck j;
  Check& c = j.check;
  c.id = fmt::format("promise_{}/{}", which, planned.name);
  c.title = fmt::format("Mean relative error of the {}, ATI against set-point, mean of {} specimens{}", which,
                        specimens.size(),
                        planned.tail_s > 0.0 ? fmt::format(", last {:.0f} s", planned.tail_s) : "");
  c.unit = std::string("%");
  c.limit = {Limit::Kind::upper, maximum ? *planned.maxima_pct : *planned.minima_pct, planned.limit_source};
  c.n = table.n;
  std::vector<double> means;
  double squares = 0.0, dof = 0.0;
  for (const std::vector<double>& row : table.values) {
    const Moments m = moments(row);
    means.push_back(m.mean);
    if (row.size() > 1) squares += m.sd * m.sd * static_cast<double>(row.size() - 1);
    dof += static_cast<double>(row.size() - 1);
  }
  const Moments m = moments(means);
  c.value = m.mean;
  if (!table.relative || !table.whole || means.empty()) {
    j.judgeable = false;
    c.value = std::numeric_limits<double>::quiet_NaN();  // newtons, or the mean of a part
    c.verdict = table.rig_error ? Verdict::rig_error : Verdict::inconclusive;
    c.blame = table.missing == Blame::none ? Blame::rig : table.missing;
    c.evidence = table.relative
                     ? fmt::format("{} records of {} specimens gave a value", table.n, specimens.size())
                     : fmt::format("the profile's minima are below {:g} N, too small for a relative error", plan.limits.minima_floor_N);
    return j;
  }
  const double observed = dof > 0.0 ? std::sqrt(squares / dof) : 0.0;
  const double declared = plan.uncertainty.record_repeat_pct;
  const bool believed = dof == 0.0 || observed * observed * dof <= declared * declared * chi_square_99(dof);
  if (!believed) j.dof = dof;
  const double random = std::sqrt(random_variance(table, believed ? declared : observed, believed));
  const double own = std::sqrt(random_variance(table, 0.0, false));
  c.u = std::hypot(random, table.u_systematic);
  j.u_systematic = table.u_systematic;
  j.explained = table.explained;
  j.repeatable = true;
  const auto inside = std::count_if(means.begin(), means.end(), [&](double v) { return v <= c.limit.value; });
  const auto [low, high] = std::minmax_element(means.begin(), means.end());
  c.evidence = fmt::format(
      "specimens {:.2f} to {:.2f} %, standard deviation {:.2f}, {} of {} inside singly; u from repeatability "
      "{:.2f}, of which the records' own {:.2f}, systematic {:.2f}",
      *low, *high, means.size() > 1 ? m.sd : 0.0, inside, means.size(), random, own, table.u_systematic);
  if (dof > 0.0)
    c.evidence += fmt::format("; {} sessions, standard deviation within a specimen {:.2f}{}",
                              specimens.front().sessions.size(), observed,
                              believed ? "" : ", more than declared: the observed one counts");
  return j;
}

const JudgedCheck* find(const JudgedCase& one, const std::string& id) {
  const auto at = std::find_if(one.checks.begin(), one.checks.end(),
                               [&](const JudgedCheck& j) { return j.check.id == id; });
  return at != one.checks.end() && at->judgeable && std::isfinite(at->check.value) ? &*at : nullptr;
}

// The mean over the sessions takes the place of the required checks of the single records.
void join_sessions(const PlanCase& planned, const SpecimenSessions& one, std::vector<JudgedCheck>& out) {
  if (one.sessions.size() < 2) return;
  const double n = static_cast<double>(one.sessions.size());
  std::vector<std::string> joined;
  for (const JudgedCheck& first : one.sessions.front()->checks) {
    if (!first.repeatable || !first.check.required || first.check.limit.kind == Limit::Kind::none) continue;
    JudgedCheck mean = first;
    Check& c = mean.check;
    double value = 0.0, random = 0.0;
    std::string list;
    std::size_t found = 0;
    c.n = 0;
    for (const JudgedCase* session : one.sessions) {
      const JudgedCheck* j = find(*session, first.check.id);
      if (j == nullptr) continue;
      ++found;
      value += j->check.value;
      mean.u_systematic = std::max(mean.u_systematic, j->u_systematic);
      mean.explained = std::max(mean.explained, j->explained);
      random += j->check.u * j->check.u - j->u_systematic * j->u_systematic;
      c.n += j->check.n;
      list += fmt::format("{}{:.3f}", list.empty() ? "" : ", ", j->check.value);
    }
    if (found < one.sessions.size()) continue;  // the record without a value says why
    c.id = fmt::format("{}/{}/{}", first.check.id, planned.name, one.specimen);
    c.case_id.clear();
    c.title = fmt::format("{}, {} on {}, mean of {} sessions", first.check.title, planned.name, one.specimen,
                          found);
    c.value = value / n;
    c.u = std::hypot(mean.u_systematic, std::sqrt(std::max(0.0, random)) / n);
    c.evidence = "sessions " + list + " " + c.unit;
    joined.push_back(first.check.id);
    out.push_back(std::move(mean));
  }
  for (JudgedCase* session : one.sessions)
    for (JudgedCheck& j : session->checks)
      if (std::find(joined.begin(), joined.end(), j.check.id) != joined.end()) j.check.required = false;
}

}  // namespace

std::vector<JudgedCheck> judge_panel(const Plan& plan, const PlanCase& planned,
                                     const std::vector<SpecimenSessions>& specimens) {
  std::vector<JudgedCheck> checks;
  for (const SpecimenSessions& one : specimens) join_sessions(planned, one, checks);
  if (!(planned.checks & kCheckPromise) || !planned.maxima_pct || !planned.minima_pct) return checks;
  checks.push_back(promise(plan, planned, true, specimens));
  checks.push_back(promise(plan, planned, false, specimens));
  return checks;
}

}  // namespace forcegate
