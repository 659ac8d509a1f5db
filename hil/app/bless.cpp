#include "hil/app/bless.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "hil/app/bundle.h"
#include "hil/app/gate.h"
#include "hil/app/golden.h"
#include "hil/app/write_file.h"
#include "hil/base/read_file.h"
#include "hil/base/text.h"
#include "hil/gate/runner.h"

namespace forcegate {
namespace fs = std::filesystem;
namespace {

constexpr const char* kHeading =
    "# Who changed a golden or a limit, and why\n\nWritten by `forcegate bless`; one line a change.\n\n"
    "| date | plan | who | why | firmware | rig | calibration | from | changes |\n|---|---|---|---|---|---|---|---|---|\n";

std::string cell(std::string text) {
  std::replace(text.begin(), text.end(), '|', '/');
  std::replace(text.begin(), text.end(), '\n', ' ');
  return printable_utf8(text);
}

double furthest_N(const GoldenContent& a, const GoldenContent& b, std::size_t every, GoldenCurve curve) {
  double worst = 0.0;
  const auto look = [&](double x, double y) { worst = std::max(worst, std::fabs(x - y)); };
  const bool ati = curve == GoldenCurve::ati;
  for (std::size_t i = 0; i < a.extrema.size() && i * every < b.extrema.size(); ++i)
    look(ati ? a.extrema[i].ati_N : a.extrema[i].dut_N,
         ati ? b.extrema[i * every].ati_N : b.extrema[i * every].dut_N);
  for (std::size_t w = 0; w < std::min(a.windows.size(), b.windows.size()); ++w) {
    const auto &x = ati ? a.windows[w].ati_N : a.windows[w].dut_N, &y = ati ? b.windows[w].ati_N : b.windows[w].dut_N;
    for (std::size_t i = 0; i < std::min(x.size(), y.size()); ++i) look(x[i], y[i]);
  }
  return worst;
}

std::string change_of(const GoldenRecord* old, const GoldenRecord& now) {
  if (old == nullptr) return "new";
  if (old->extrema_in_all != now.content.extrema.size())
    return fmt::format("{} extrema instead of {}", now.content.extrema.size(), old->extrema_in_all);
  const double ati = furthest_N(old->content, now.content, old->every, GoldenCurve::ati);
  const double dut = furthest_N(old->content, now.content, old->every, GoldenCurve::firmware);
  if (ati < 1e-4 && dut < 1e-4) return "unchanged";
  return fmt::format("ATI by at most {:.4f} N, firmware by at most {:.4f} N", ati, dut);
}

Result<void> refuse_unaccepted(const RunMaterial& m) {
  Plan plan = m.plan;
  for (PlanCase& c : plan.cases) c.checks &= ~static_cast<unsigned>(kCheckGolden);
  RunMaterial without = m;
  without.plan = plan;
  const RunResult judged = to_run_result(without, judge_material(without));
  if (judged.decision.kind == DecisionKind::accept) return {};
  return fail(ErrorCode::usage,
              fmt::format("this run is {} apart from its goldens: {}", to_string(judged.decision.kind),
                          judged.decision.reason),
              {}, "bless a run that is accepted");
}

GoldenRecord golden_of(const RunMaterial& m, const Bundle& bundle, const PlanCase& planned,
                      const PlayedRecord& one, const BlessRequest& request) {
  const CaseRecord& r = one.record;
  GoldenRecord g;
  g.plan = m.plan.name;
  g.case_name = planned.name;
  g.specimen = one.job.specimen;
  g.seed = one.job.seed;
  g.rig = r.rig.name + "/" + r.rig.version;
  g.algorithm = r.firmware.algorithm_id;
  g.ati = {.absolute = 0.08, .time_s = 0.01, .lag_limit_s = 0.01};
  g.firmware = {.absolute = 0.05, .relative = 0.01, .time_s = 0.01, .lag_limit_s = 0.02};
  g.content = golden_content(r);
  g.provenance["firmware_sha256"] = m.head.firmware_sha256;
  g.provenance["bundle"] = bundle.id;
  g.provenance["tool_version"] = bundle.tool_version;
  g.provenance["date"] = m.head.started_at.substr(0, 10);
  g.provenance["calibration"] = std::string(to_string(m.level)) + " " + one.job.calibration.id;
  g.provenance["who"] = cell(request.who);
  g.provenance["reason"] = cell(request.reason);
  double sum = 0.0, n = 0.0;
  for (const CasePair& p : r.pairs)
    if (p.maximum && p.t_s >= judged_from_s(planned, r) && p.ati_N > 0.1) sum += std::fabs(p.dut_N / p.ati_N - 1.0), n += 1.0;
  g.provenance["mre_maxima_pct"] = fmt::format("{:.3f}", n > 0.0 ? 100.0 * sum / n : 0.0);
  return g;
}

Result<void> append_line(const fs::path& path, const std::string& line) {
  std::string text = kHeading;
  std::error_code ignored;
  if (fs::exists(path, ignored) && fs::file_size(path, ignored) > 0) {
    FORCEGATE_TRY(text, read_file(path));
  }
  return write_file_atomically(path, text + line);
}

Result<BlessAnswer> bless_run(const BlessRequest& request) {
  FORCEGATE_TRY(const Bundle bundle, read_bundle(request.source));
  const RunMaterial& m = bundle.material;
  FORCEGATE_CHECK_OK(refuse_unaccepted(m));
  fs::path folder = request.goldens;
  if (folder.empty()) {
    if (m.plan.limits.goldens.empty())
      return fail(ErrorCode::usage, "the plan of this run names no goldens", m.plan.name,
                  "add goldens = \"...\" to its [limits] and \"golden\" to the checks of a case, or give --goldens FOLDER");
    FORCEGATE_TRY(const fs::path plan, find_plan(m.plan.name));
    folder = (plan.parent_path() / m.plan.limits.goldens).lexically_normal();
  }
  FORCEGATE_TRY(const std::vector<GoldenRecord> before, read_goldens(folder));
  BlessAnswer answer;
  std::vector<std::pair<fs::path, std::string>> files;
  std::size_t changed = 0;
  for (const PlayedRecord& one : m.records) {
    const PlanCase& planned = m.plan.cases[one.case_index];
    const bool middle = one.specimen_index == specimens_of(m.plan, planned).size() / 2;
    if (!(planned.checks & kCheckGolden) || !middle || one.superseded || one.job.session != 0) continue;
    GoldenRecord now = golden_of(m, bundle, planned, one, request);
    const auto old = std::find_if(before.begin(), before.end(), [&](const GoldenRecord& g) {
      return g.case_name == now.case_name && g.specimen == now.specimen;
    });
    if (old != before.end()) now.ati = old->ati, now.firmware = old->firmware;
    BlessChange change{golden_file_name(now.case_name, now.specimen),
                       change_of(old == before.end() ? nullptr : &*old, now), true};
    change.changed = change.what != "unchanged";
    if (change.changed) files.emplace_back(folder / change.file, to_text(now));
    changed += change.changed;
    answer.changes.push_back(std::move(change));
  }
  if (answer.changes.empty())
    return fail(ErrorCode::usage, "no case of this run asks for a golden", m.plan.name,
                "add \"golden\" to the checks of a case");
  answer.governance = folder.parent_path() / "CHANGES.md";
  std::string list;
  for (const BlessChange& c : answer.changes)
    if (c.changed) list += (list.empty() ? "" : "; ") + c.file + ": " + c.what;
  answer.line = fmt::format("| {} | {} | {} | {} | {} | {} | {} | bundle {} | {} |\n", m.head.started_at.substr(0, 10),
                            m.plan.name, cell(request.who), cell(request.reason), m.head.firmware_sha256.substr(0, 16),
                            m.records.empty() ? "" : m.records.front().record.rig.id, to_string(m.level), bundle.id.substr(0, 16),
                            list);
  if (request.dry_run || changed == 0) return answer;
  for (const auto& [path, text] : files) FORCEGATE_CHECK_OK(write_file_atomically(path, text));
  FORCEGATE_CHECK_OK(append_line(answer.governance, answer.line));
  answer.written = true;
  return answer;
}

Result<BlessAnswer> bless_limits(const BlessRequest& request) {
  FORCEGATE_TRY(const DerivedLimits now, read_limits(request.source));
  FORCEGATE_TRY(const fs::path plan_path, find_plan(now.plan));
  FORCEGATE_TRY(const Plan plan, read_plan(plan_path));
  if (plan.limits.derived.empty())
    return fail(ErrorCode::usage, "the plan uses no derived limits", plan_path.string());
  const fs::path target = (plan_path.parent_path() / plan.limits.derived).lexically_normal();
  DerivedLimits old;
  std::error_code ignored;
  if (fs::exists(target, ignored)) {
    FORCEGATE_TRY(old, read_limits(target));
  }
  BlessAnswer answer;
  std::string list;
  for (const auto& [key, limit] : now.by_case_and_check) {
    const auto at = old.by_case_and_check.find(key);
    BlessChange change{key.first + " " + key.second, {}, true};
    if (at == old.by_case_and_check.end())
      change.what = fmt::format("new: {:.4g} {}", limit.value, limit.unit);
    else if (at->second.value == limit.value)
      change.what = "unchanged", change.changed = false;
    else
      change.what = fmt::format("{:.4g} to {:.4g} {}", at->second.value, limit.value, limit.unit);
    if (change.changed) list += (list.empty() ? "" : "; ") + change.file + ": " + change.what;
    answer.changes.push_back(std::move(change));
  }
  for (const auto& [key, limit] : old.by_case_and_check)
    if (!now.by_case_and_check.contains(key)) {
      answer.changes.push_back({key.first + " " + key.second, fmt::format("gone, was {:.4g} {}", limit.value, limit.unit), true});
      list += (list.empty() ? "" : "; ") + answer.changes.back().file + ": gone";
    }
  answer.governance = target.parent_path() / "CHANGES.md";
  answer.line = fmt::format("| {} | {} | {} | {} | {} | {} | identified | limits of {} | {} |\n", now.date, now.plan,
                            cell(request.who), cell(request.reason), now.firmware_sha256.substr(0, 16), now.rig, now.date, list);
  if (request.dry_run || list.empty()) return answer;
  FORCEGATE_CHECK_OK(write_file_atomically(target, write_limits(now)));
  FORCEGATE_CHECK_OK(append_line(answer.governance, answer.line));
  answer.written = true;
  return answer;
}

}  // namespace

Result<BlessAnswer> bless(const BlessRequest& request) {
  if (request.reason.find_first_not_of(" \t") == std::string::npos)
    return fail(ErrorCode::usage, "a golden changes only with a reason", {}, "add --reason \"...\"");
  if (request.who.find_first_not_of(" \t") == std::string::npos)
    return fail(ErrorCode::usage, "somebody must answer for the change", {}, "add --who NAME");
  std::error_code ignored;
  return fs::is_regular_file(request.source, ignored) ? bless_limits(request) : bless_run(request);
}

std::string bless_text(const BlessAnswer& a) {
  std::string out;
  for (const BlessChange& c : a.changes) out += fmt::format("  {:<48} {}\n", c.file, c.what);
  out += a.written ? fmt::format("written; noted in {}\n", a.governance.string()) : std::string("nothing was written\n");
  return out;
}

std::string bless_json(const BlessAnswer& a) {
  nlohmann::ordered_json changes = nlohmann::ordered_json::array();
  for (const BlessChange& c : a.changes) changes.push_back({{"file", c.file}, {"change", c.what}, {"changed", c.changed}});
  return nlohmann::ordered_json{{"format", 1}, {"written", a.written}, {"governance", a.governance.string()}, {"changes", changes}}
      .dump(2, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace forcegate
