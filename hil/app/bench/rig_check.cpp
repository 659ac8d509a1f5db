#include "hil/app/bench/rig_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "hil/app/files/find_plan.h"
#include "hil/base/units.h"
#include "hil/gate/statistics.h"

namespace forcegate {
namespace {

std::string sparkline(const ControlChart& chart) {
  static constexpr const char* kBars[] = {"_", ".", "-", "=", "^"};
  std::string out;
  const std::size_t first = chart.x.size() > 30 ? chart.x.size() - 30 : 0;
  for (std::size_t i = first; i < chart.x.size(); ++i) {
    const double z = chart.s > 0.0 ? (chart.x[i] - chart.centre) / chart.s : 0.0;
    out += kBars[static_cast<std::size_t>(std::clamp(std::lround(2.0 + z / 1.5), 0L, 4L))];
  }
  return out;
}

}  // namespace

Result<SelfcheckAnswer> selfcheck(const SelfcheckRequest& request, const GateProgress& progress,
                                  const std::atomic<bool>* cancelled) {
  std::vector<RigVisit> history;
  if (!request.history.empty()) {
    FORCEGATE_TRY(history, read_history(request.history));
  }
  SelfcheckAnswer answer;
  FORCEGATE_TRY(answer.result, gate(request.gate, progress, cancelled));
  const Decision& d = answer.result.decision;
  if (d.exit_code == 130) return fail(ErrorCode::cancelled, "interrupted");
  if (d.kind != DecisionKind::accept)
    answer.reasons.push_back(fmt::format("the known-good build is not accepted: {}", d.reason));
  if (!request.history.empty()) {
    history.push_back(visit_of(answer.result));
    FORCEGATE_CHECK_OK(append_visit(request.history, history.back()));
    answer.charts = control_charts(history);
    answer.visits = charted_visits(history).size();
    const auto of_rig = std::count_if(history.begin(), history.end(), [&](const RigVisit& v) { return v.rig == history.back().rig; });
    answer.left_out = static_cast<std::size_t>(of_rig) - answer.visits;
    for (const ControlChart& chart : answer.charts)
      if (!chart.in_control) answer.reasons.push_back(chart.quantity + " " + chart.text);
  }
  answer.fit = answer.reasons.empty();
  return answer;
}

std::string selfcheck_text(const SelfcheckAnswer& a) {
  std::string out = a.fit ? "fit: the rig can judge a build\n" : "NOT FIT: " + a.reasons.front() + "\n";
  for (std::size_t i = 1; i < a.reasons.size(); ++i) out += "  and " + a.reasons[i] + "\n";
  const RigVisit now = visit_of(a.result);
  out += fmt::format("  rig {}, known-good build {}\n", now.rig, now.firmware_sha256.substr(0, 16));
  for (const CaseResult& c : a.result.cases) {
    out += fmt::format("  {}\n", c.id);
    for (const Check& check : c.checks) {
      const auto at = now.values.find(check.id);
      if (at == now.values.end()) continue;
      const std::string limit =
          check.limit.kind == Limit::Kind::none ? "no limit" : fmt::format("limit {:.4g}", check.limit.value);
      out += fmt::format("    {:<11} {:<26} {:>10.4g} {:<4} {:<16} {}\n", to_string(check.verdict), check.id,
                         check.value, unit_in_text(check.unit), limit, check.evidence);
    }
  }
  if (a.charts.empty()) return out;
  out += fmt::format("  control chart over {} visits (centre and spread from the first {}; {} are needed)\n",
                     a.visits, std::min(a.visits - 1, ControlChart::kBaseline), ControlChart::kNeeded);
  if (a.left_out > 0)
    out += fmt::format("    visits of this rig that are left out: {} (not ACCEPT, or another known-good build)\n", a.left_out);
  std::map<std::string, std::string> units;
  for (const CaseResult& c : a.result.cases)
    for (const Check& check : c.checks) units[check.id] = check.unit;
  for (const ControlChart& chart : a.charts)
    out += fmt::format("    {:<11} {:<26} centre {:>10.4g} {:<4} sd {:<10} {}\n",
                       !chart.enough      ? "too few"
                       : chart.in_control ? "in control"
                                          : "OUT",
                       chart.quantity, chart.centre, unit_in_text(units[chart.quantity]), chart.enough ? fmt::format("{:.2g}", chart.s) : "-", sparkline(chart));
  return out;
}

std::string selfcheck_json(const SelfcheckAnswer& a) {
  nlohmann::ordered_json charts = nlohmann::ordered_json::array();
  for (const ControlChart& c : a.charts)
    charts.push_back({{"quantity", c.quantity},
                      {"centre", c.centre},
                      {"s", c.s},
                      {"last", c.x.back()},
                      {"ewma", c.ewma.back()},
                      {"enough", c.enough},
                      {"in_control", c.in_control},
                      {"text", c.text}});
  const RigVisit now = visit_of(a.result);
  nlohmann::ordered_json values = nlohmann::ordered_json::object();
  for (const auto& [name, value] : now.values) values[name] = value;
  return nlohmann::ordered_json{{"format", 1},     {"fit", a.fit},     {"reasons", a.reasons},
                                {"rig", now.rig},  {"values", values}, {"visits", a.visits},
                                {"left_out", a.left_out},
                                {"charts", charts}}
      .dump(2, ' ', false, nlohmann::json::error_handler_t::replace);
}

Result<RepeatabilityAnswer> repeatability(const RepeatabilityRequest& request, const GateProgress& progress,
                                          const std::atomic<bool>* cancelled) {
  FORCEGATE_TRY(const std::filesystem::path path, find_plan(request.gate.plan));
  FORCEGATE_TRY(const Plan plan, read_plan(path));
  std::map<std::pair<std::string, std::string>, std::vector<double>> values, u;
  std::map<std::pair<std::string, std::string>, Check> like;
  RepeatabilityAnswer answer;
  const std::uint64_t first_seed = request.gate.seed.value_or(plan.seed);
  for (std::size_t k = 0; k < request.n; ++k) {
    GateRequest again = request.gate;
    again.seed = first_seed + k;
    again.makes_limits = true;
    const auto part = [&](double fraction, std::string_view now) {
      if (progress) progress((static_cast<double>(k) + fraction) / static_cast<double>(request.n), now);
    };
    FORCEGATE_TRY(const RunResult result, gate(again, part, cancelled));
    if (result.decision.exit_code == 130) return fail(ErrorCode::cancelled, "interrupted");
    if (result.decision.exit_code == 4)
      return fail(ErrorCode::device, "the rig is not sound: " + result.decision.reason, {},
                  "forcegate bench selfcheck");
    answer.limits.plan = plan.name;
    answer.limits.firmware_sha256 = result.firmware_sha256;
    answer.limits.rig = result.rig.name + "/" + result.rig.version + " " + result.rig.id;
    for (const CaseResult& c : result.cases) {
      if (c.loop != "open") continue;
      const std::string name = c.id.substr(0, c.id.find('/'));
      const bool relative = c.facts.mean_N - c.facts.amplitude_N >= plan.limits.minima_floor_N;
      for (const Check& check : c.checks) {
        if (check.id != "mre_maxima" && check.id != (relative ? "mre_minima" : "mae_minima")) continue;
        if (!std::isfinite(check.value))
          return fail(ErrorCode::device, "a record gave no value for " + check.id, c.id);
        values[{name, check.id}].push_back(check.value);
        u[{name, check.id}].push_back(check.u_against_derived);
        like[{name, check.id}] = check;
      }
    }
  }
  answer.limits.date = request.date;
  for (const auto& [key, list] : values) {
    const Moments m = moments(list);
    // One specimen under one profile repeats better than one of its records is known: a good build must pass by U = 2 u.
    const DerivedLimit derived = derive_limit(list, m.sd + moments(u[key]).mean, like[key].unit);
    const auto planned = std::find_if(plan.cases.begin(), plan.cases.end(),
                                      [&key = key](const PlanCase& c) { return c.name == key.first; });
    double given = std::nan("");  // limit of the plan
    if (planned != plan.cases.end() && key.second == "mre_maxima")
      given = planned->maxima_pct.value_or(given);
    if (planned != plan.cases.end() && key.second == "mre_minima")
      given = planned->minima_pct.value_or(given);
    CheckRepeatability row{key.first,
                           key.second,
                           like[key].unit,
                           list.size(),
                           m.mean,
                           m.sd,
                           *std::max_element(list.begin(), list.end()),
                           given,
                           0.0,
                           false};
    row.gauge_pct = gauge_share_pct(m.sd, std::isnan(given) ? derived.value : given);
    row.resolved = row.gauge_pct <= kGaugeRefused_pct;
    if (row.resolved) answer.limits.by_case_and_check[key] = derived;
    answer.rows.push_back(std::move(row));
  }
  return answer;
}

std::string repeatability_text(const RepeatabilityAnswer& a) {
  std::string out = fmt::format("{:<26}{:<12}{:>4}{:>9}{:>9}{:>9}{:>14}{:>8}\n", "case", "error", "n", "mean",
                                "s", "largest", "plan's limit", "%GRR");
  std::size_t refused = 0;
  for (const CheckRepeatability& r : a.rows) {
    refused += !r.resolved;
    out += fmt::format("{:<26}{:<12}{:>4}{:>9.3f}{:>9.3f}{:>9.3f}{:>14}{:>8.1f}  {}\n", r.case_name,
                       r.check_id, r.n, r.mean, r.s, r.largest,
                       std::isfinite(r.plan_limit) ? fmt::format("{:.3g}", r.plan_limit) : "derived",
                       r.gauge_pct, r.resolved ? "" : "REFUSED: this rig cannot resolve that limit");
  }
  out += fmt::format(
      "%GRR = 100 x 3 s / limit; above {:.0f} the limit is refused. {} of {} limits resolved, rig {}\n",
      kGaugeRefused_pct, a.rows.size() - refused, a.rows.size(), a.limits.rig);
  return out;
}

std::string repeatability_json(const RepeatabilityAnswer& a) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (const CheckRepeatability& r : a.rows) {
    nlohmann::ordered_json one{{"case", r.case_name},   {"check", r.check_id},
                               {"unit", r.unit},        {"n", r.n},
                               {"mean", r.mean},        {"s", r.s},
                               {"largest", r.largest},  {"grr_pct", r.gauge_pct},
                               {"resolved", r.resolved}};
    if (std::isfinite(r.plan_limit)) one["plan_limit"] = r.plan_limit;
    rows.push_back(std::move(one));
  }
  return nlohmann::ordered_json{{"format", 1}, {"rig", a.limits.rig}, {"date", a.limits.date}, {"rows", rows}}
      .dump(2, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace forcegate
