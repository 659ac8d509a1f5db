#include "hil/app/stored/run_diff.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "hil/app/gate/bundle.h"
#include "hil/app/gate/same_conditions.h"
#include "hil/base/json_number.h"
#include "hil/base/plain_number.h"
#include "hil/base/text.h"
#include "hil/gate/statistics.h"

namespace forcegate {
namespace {

std::vector<std::string> named(std::vector<std::string> cases) {
  for (std::string& id : cases)
    if (id.empty()) id = "the checks of the whole run";
  return cases;
}

using Checks = std::map<std::string, const Check*>;  // by id

std::map<std::string, Checks> by_case(const RunResult& r) {
  std::map<std::string, Checks> out;
  for (const Check& c : r.checks) out[""][c.id] = &c;
  for (const CaseResult& one : r.cases)
    for (const Check& c : one.checks) out[one.id][c.id] = &c;
  return out;
}

// The first one stands for all: the emulated rig measures the same calibration again, a bench another one in every session.
void note_calibrations(RunDiff& d) {
  std::size_t other = 0;
  std::string first;
  for (const CaseResult& a : d.a.cases) {
    const auto b = std::find_if(d.b.cases.begin(), d.b.cases.end(), [&](const CaseResult& c) { return c.id == a.id; });
    if (b == d.b.cases.end() || a.samples == 0 || b->samples == 0) continue;
    const std::string what = calibration_difference(a.calibration, b->calibration);
    if (!what.empty() && other++ == 0) first = a.id + " " + what;
  }
  if (other > 0) d.differences.push_back(fmt::format("calibration of {}: {}", counted(other, "record"), first));
}

void compare_conditions(RunDiff& d) {
  const auto note = [&](const char* what, const std::string& a, const std::string& b) {
    if (a != b) d.differences.push_back(fmt::format("{}: {} and {}", what, a, b));
  };
  note("plan", d.a.plan_name + " " + d.a.plan_sha256.substr(0, 12),
       d.b.plan_name + " " + d.b.plan_sha256.substr(0, 12));
  note("seed", std::to_string(d.a.seed), std::to_string(d.b.seed));
  note("rig", d.a.rig.name + "/" + d.a.rig.version + " " + d.a.rig.id,
       d.b.rig.name + "/" + d.b.rig.version + " " + d.b.rig.id);
  note("version", d.a.tool_version, d.b.tool_version);
  for (const char* what : {"faults", "rig options"}) note(what, stated_condition(d.a, what), stated_condition(d.b, what));
  note_calibrations(d);
  d.same_conditions = d.differences.empty();
}

double share_of_limit(const CheckDelta& d, const Check& c) {
  const double scale = c.limit.kind == Limit::Kind::none ? 0.0 : std::fabs(c.limit.value);
  return scale > 0.0 ? std::fabs(d.delta) / scale : std::fabs(d.delta);
}

// A check of an error is better when smaller; rig checks say nothing of the build.
bool is_error(const std::string& id) {
  return id.starts_with("mre_") || id.starts_with("mae_") || id.starts_with("promise_") || id == "lag" ||
         id == "conformance" || id == "hold_amplification" || id == "learning_window";
}

CheckSummary summarise(const std::string& id, const std::string& unit, const std::vector<double>& deltas) {
  const Moments m = moments(deltas);
  CheckSummary s{id, unit, deltas.size(), m.mean, std::nan(""), std::nan(""), std::nan(""), {}};
  if (deltas.size() > 1) {
    s.u = m.sd / std::sqrt(static_cast<double>(deltas.size()));
    const double U = coverage_factor(0.9545, static_cast<double>(deltas.size() - 1)) * s.u;
    s.low = m.mean - U;
    s.high = m.mean + U;
  }
  s.in_words = m.mean == 0.0 && (deltas.size() < 2 || s.u == 0.0) ? "the same"
               : s.high < 0.0                                     ? "better"
               : s.low > 0.0                                      ? "worse"
                                                                  : "no difference shown";
  return s;
}

}  // namespace

Result<RunDiff> diff_runs(const std::filesystem::path& a, const std::filesystem::path& b) {
  RunDiff d;
  FORCEGATE_TRY(d.a, read_run(a));
  FORCEGATE_TRY(d.b, read_run(b));
  compare_conditions(d);
  const auto of_a = by_case(d.a), of_b = by_case(d.b);
  std::map<std::string, std::pair<std::string, std::vector<double>>> deltas;
  std::vector<std::pair<double, CheckDelta>> ranked;
  for (const auto& [case_id, checks] : of_a) {
    const auto partner = of_b.find(case_id);
    if (partner == of_b.end()) {
      d.only_in_a.push_back(case_id);
      continue;
    }
    for (const auto& [id, second] : partner->second) {
      if (checks.contains(id) || second->verdict == Verdict::pass || !second->required) continue;
      d.failures.push_back({case_id, id, second->verdict, true, second->evidence});
    }
    for (const auto& [id, first] : checks) {
      if (!partner->second.contains(id) && first->verdict != Verdict::pass && first->required)
        d.failures.push_back({case_id, id, first->verdict, false, first->evidence});
      const auto at = partner->second.find(id);
      if (at == partner->second.end()) continue;
      const Check& second = *at->second;
      CheckDelta one{case_id,
                     id,
                     first->unit,
                     first->value,
                     second.value,
                     second.value - first->value,
                     std::hypot(first->u, second.u),
                     first->verdict,
                     second.verdict,
                     second.limit.kind != Limit::Kind::none};
      if (is_error(id) && !case_id.empty() && std::isfinite(one.delta)) {
        deltas[id].first = first->unit;
        deltas[id].second.push_back(one.delta);
      }
      if (one.delta != 0.0 || one.verdict_a != one.verdict_b)
        if (std::isfinite(one.delta) || one.verdict_a != one.verdict_b)
          ranked.emplace_back((one.verdict_a != one.verdict_b ? 1e6 : 0.0) + share_of_limit(one, *first),
                              std::move(one));
    }
  }
  for (const auto& [case_id, checks] : of_b)
    if (!of_a.contains(case_id)) d.only_in_b.push_back(case_id);
  std::stable_sort(ranked.begin(), ranked.end(),
                   [](const auto& x, const auto& y) { return x.first > y.first; });
  for (auto& [rank, one] : ranked) d.checks.push_back(std::move(one));
  for (const auto& [id, list] : deltas) d.summary.push_back(summarise(id, list.first, list.second));
  return d;
}

std::string diff_text(const RunDiff& d) {
  std::string out =
      fmt::format("A {} {}: {}\nB {} {}: {}\n", d.a.firmware_path, to_string(d.a.decision.kind),
                  d.a.decision.reason, d.b.firmware_path, to_string(d.b.decision.kind), d.b.decision.reason);
  if (!d.same_conditions)
    out += "NOT the same conditions, differences are not of the builds alone: " + join(d.differences, "; ") +
           "\n";
  if (d.a.firmware_sha256 == d.b.firmware_sha256) out += "the same image on both sides\n";
  out += fmt::format("\n{:<22}{:>5}{:>12}{:>12}   {:<24}{}\n", "B - A, over cases", "n", "mean", "u",
                     "95 % interval", "B is");
  for (const CheckSummary& s : d.summary)
    out += fmt::format(
        "{:<22}{:>5}{:>12}{:>12}   {:<24}{}\n", s.check_id + " " + s.unit, s.n,
        fmt::format("{:+.4g}", s.mean_delta), std::isfinite(s.u) ? fmt::format("{:.2g}", s.u) : "-",
        std::isfinite(s.low) ? fmt::format("{:+.3g} to {:+.3g}", s.low, s.high) : "one pair only",
        s.in_words);
  const auto number = [](double v) { return std::isfinite(v) ? fmt::format("{:.5g}", v) : std::string("-"); };
  if (!d.failures.empty()) out += fmt::format("\n{} checks stand on one side only:\n", d.failures.size());
  for (const OneSided& f : d.failures)
    out += fmt::format("  only in {}  {:<32}{:<20}{}{}\n", f.in_b ? "B" : "A", f.case_id.empty() ? "run" : f.case_id, f.check_id,
                       to_string(f.verdict), f.evidence.empty() ? "" : ": " + f.evidence);
  out += fmt::format("\n{} checks differ{}\n", d.checks.size(),
                     d.checks.empty() ? "" : d.checks.size() > 20 ? ", the first 20:" : ":");
  for (std::size_t i = 0; i < std::min<std::size_t>(20, d.checks.size()); ++i) {
    const CheckDelta& c = d.checks[i];
    out += fmt::format("  {:<32}{:<20}{:>11} -> {:<11} {}{} ({}){}\n", c.case_id.empty() ? "run" : c.case_id,
                       c.check_id, number(c.a), number(c.b),
                       std::isfinite(c.delta) ? with_uncertainty(c.delta, c.u) : "-", c.unit == "1" ? std::string() : " " + c.unit,
                       c.limited || c.verdict_b != Verdict::pass ? to_string(c.verdict_b) : "no limit",
                       c.verdict_a == c.verdict_b ? "" : fmt::format(", was {}", to_string(c.verdict_a)));
  }
  if (!d.only_in_a.empty()) out += "only in A: " + join(named(d.only_in_a), ", ") + "\n";
  if (!d.only_in_b.empty()) out += "only in B: " + join(named(d.only_in_b), ", ") + "\n";
  return out;
}

std::string diff_json(const RunDiff& d) {
  nlohmann::ordered_json checks = nlohmann::ordered_json::array(), summary = nlohmann::ordered_json::array(),
                         failures = nlohmann::ordered_json::array();
  for (const OneSided& f : d.failures)
    failures.push_back({{"case", f.case_id}, {"check", f.check_id}, {"side", f.in_b ? "b" : "a"}, {"verdict", to_string(f.verdict)}, {"evidence", f.evidence}});
  for (const CheckDelta& c : d.checks)
    checks.push_back({{"case", c.case_id},
                      {"check", c.check_id},
                      {"unit", c.unit},
                      {"a", json_number<nlohmann::ordered_json>(c.a)},
                      {"b", json_number<nlohmann::ordered_json>(c.b)},
                      {"delta", json_number<nlohmann::ordered_json>(c.delta)},
                      {"u", json_number<nlohmann::ordered_json>(c.u)},
                      {"verdict_a", to_string(c.verdict_a)},
                      {"verdict_b", to_string(c.verdict_b)},
                      {"has_limit", c.limited}});
  for (const CheckSummary& s : d.summary)
    summary.push_back({{"check", s.check_id},
                       {"unit", s.unit},
                       {"n", s.n},
                       {"mean_delta", json_number<nlohmann::ordered_json>(s.mean_delta)},
                       {"u", json_number<nlohmann::ordered_json>(s.u)},
                       {"low", json_number<nlohmann::ordered_json>(s.low)},
                       {"high", json_number<nlohmann::ordered_json>(s.high)},
                       {"b_is", s.in_words}});
  const auto side = [](const RunResult& r) {
    return nlohmann::ordered_json{{"firmware", r.firmware_path},
                                  {"sha256", r.firmware_sha256},
                                  {"decision", to_string(r.decision.kind)},
                                  {"reason", r.decision.reason}};
  };
  return nlohmann::ordered_json{{"format", 1},
                                {"a", side(d.a)},
                                {"b", side(d.b)},
                                {"same_conditions", d.same_conditions},
                                {"condition_differences", d.differences},
                                {"summary", summary},
                                {"checks", checks},
                                {"one_sided", failures},
                                {"only_in_a", d.only_in_a},
                                {"only_in_b", d.only_in_b}}
      .dump(2, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace forcegate
