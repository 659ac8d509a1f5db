#include "hil/app/bench/rig_history.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>

#include "hil/base/read_file.h"
#include "hil/base/text.h"
#include "hil/gate/statistics.h"

namespace forcegate {
namespace {

constexpr double kLambda = 0.2, kMovingRangeDof = 0.62;

bool belongs_to_rig(const Check& c) {
  return c.id.starts_with("rig_") || c.id == "mre_maxima" || c.id == "mre_minima" || c.id == "lag" ||
         c.id == "coverage" || c.id == "link_intact" || c.id == "conformance";
}

}  // namespace

RigVisit visit_of(const RunResult& result) {
  RigVisit v;
  v.date = result.started_at;
  v.rig = result.rig.name + "/" + result.rig.version + " " + result.rig.id;
  v.firmware_sha256 = result.firmware_sha256;
  v.decision = std::string(to_string(result.decision.kind));
  for (const CaseResult& c : result.cases)
    for (const Check& check : c.checks) {
      if (!belongs_to_rig(check) || !std::isfinite(check.value)) continue;
      const auto [at, fresh] = v.values.try_emplace(check.id, check.value);
      if (!fresh) at->second = std::max(at->second, check.value);
    }
  return v;
}

Result<std::vector<RigVisit>> read_history(const std::filesystem::path& path) {
  std::vector<RigVisit> visits;
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) return visits;
  if (!std::filesystem::is_regular_file(path, ignored))
    return fail(ErrorCode::usage, "a rig's history is a file that is read and added to, and this is none", path.string(), "name a file with --history; it need not exist yet");
  FORCEGATE_TRY(const std::string text, read_file(path));
  const std::vector<std::string> lines = split(text, '\n');  // the last one has no end: empty, or what was not written whole
  std::size_t line_number = 0;
  for (const std::string& line : lines) {
    ++line_number;
    if (line.empty()) continue;
    const auto j = nlohmann::json::parse(line, nullptr, false);
    const bool cut = line_number == lines.size() && line.front() == '{' && j.is_discarded();
    if (cut)
      return fail(ErrorCode::parse, "the last line of the rig's history is cut off: its visit was not written whole", fmt::format("{}:{}", path.string(), line_number),
                  fmt::format("remove line {}; the visits before it are kept", line_number));
    if (!j.is_object() || j.value("format", 0) != 1 || !j.contains("values") || !j["values"].is_object())
      return fail(ErrorCode::parse, "this is no line of a rig's history",
                  fmt::format("{}:{}", path.string(), line_number),
                  "give the file that forcegate bench selfcheck --history wrote");
    RigVisit v{
        j.value("date", ""), j.value("rig", ""), j.value("firmware_sha256", ""), j.value("decision", ""), {}};
    for (const auto& [name, value] : j["values"].items())
      if (value.is_number()) v.values[name] = value.get<double>();
    visits.push_back(std::move(v));
  }
  return visits;
}

Result<void> append_visit(const std::filesystem::path& path, const RigVisit& v) {
  std::error_code ignored;
  if (path.has_parent_path()) std::filesystem::create_directories(path.parent_path(), ignored);
  nlohmann::ordered_json values = nlohmann::ordered_json::object();
  for (const auto& [name, value] : v.values) values[name] = value;
  const nlohmann::ordered_json j{{"format", 1},
                                 {"date", v.date},
                                 {"rig", v.rig},
                                 {"firmware_sha256", v.firmware_sha256},
                                 {"decision", v.decision},
                                 {"values", values}};
  bool open_end = false;  // a last line without its end would be one with this visit
  if (std::ifstream before(path, std::ios::binary | std::ios::ate); before && before.tellg() > 0) open_end = before.seekg(-1, std::ios::end).get() != '\n';
  std::ofstream out(path, std::ios::app | std::ios::binary);
  out << (open_end ? "\n" : "") << j.dump() << "\n" << std::flush;
  if (!out) return fail(ErrorCode::io, "the history cannot be written", path.string());
  return {};
}

ControlChart control_chart(const std::string& quantity, const std::vector<double>& x, double resolution, std::size_t charts) {
  ControlChart chart;
  chart.quantity = quantity;
  chart.x = x;
  if (x.empty()) return chart;
  // The visit that is judged is never part of what it is judged by.
  const std::size_t before = x.size() - 1, base = std::min(before, ControlChart::kBaseline);
  chart.enough = before >= ControlChart::kNeeded;
  double sum = 0.0, moves = 0.0;
  for (std::size_t i = 0; i < base; ++i) {
    sum += x[i];
    if (i > 0) moves += std::fabs(x[i] - x[i - 1]);
  }
  chart.centre = base > 0 ? sum / static_cast<double>(base) : x.front();
  chart.s = std::max(resolution, base > 1 ? moves / static_cast<double>(base - 1) / 1.128 : 0.0);
  double z = chart.centre;
  for (std::size_t i = 0; i < x.size(); ++i) chart.ewma.push_back(z = kLambda * x[i] + (1.0 - kLambda) * z);
  if (!chart.enough) return chart;
  const auto n = static_cast<double>(base);
  const double t = coverage_factor(1.0 - ControlChart::kFalseAlarm / (2.0 * static_cast<double>(charts)), kMovingRangeDof * (n - 1.0));
  const double width = t * chart.s * std::sqrt(kLambda / (2.0 - kLambda) + 1.0 / n);
  if (std::fabs(x.back() - chart.centre) > t * chart.s * std::sqrt(1.0 + 1.0 / n))
    chart.text = fmt::format("{:.4g} is {:.1f} standard deviations from {:.4g}", x.back(),
                             std::fabs(x.back() - chart.centre) / chart.s, chart.centre);
  else if (std::fabs(z - chart.centre) > width)
    chart.text = fmt::format("has drifted: its moving mean is {:.4g}, {:.4g} +- {:.2g} at the beginning", z,
                             chart.centre, width);
  chart.in_control = chart.text.empty();
  return chart;
}

std::vector<const RigVisit*> charted_visits(const std::vector<RigVisit>& history) {
  std::vector<const RigVisit*> out;
  if (history.empty()) return out;
  const RigVisit& last = history.back();
  for (const RigVisit& v : history)
    if (&v == &last || (v.rig == last.rig && v.firmware_sha256 == last.firmware_sha256 && v.decision == to_string(DecisionKind::accept)))
      out.push_back(&v);
  return out;
}

std::vector<ControlChart> control_charts(const std::vector<RigVisit>& history) {
  std::vector<ControlChart> charts;
  if (history.empty()) return charts;
  const std::vector<const RigVisit*> visits = charted_visits(history);
  for (const auto& [name, last] : history.back().values) {
    std::vector<double> x;
    for (const RigVisit* v : visits)
      if (const auto at = v->values.find(name); at != v->values.end()) x.push_back(at->second);
    charts.push_back(control_chart(name, x, std::max(1e-4 * std::fabs(x.front()), 1e-6), history.back().values.size()));
  }
  return charts;
}

double gauge_share_pct(double s, double limit) {
  return limit > 0.0 && s >= 0.0 ? 100.0 * 3.0 * s / limit : std::numeric_limits<double>::infinity();
}

}  // namespace forcegate
