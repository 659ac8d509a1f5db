#include "hil/app/stored/bless.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "hil/app/files/find_plan.h"
#include "hil/app/files/write_file.h"
#include "hil/app/gate/bundle.h"
#include "hil/app/gate/same_conditions.h"
#include "hil/app/gate/weight_gate.h"
#include "hil/base/read_file.h"
#include "hil/base/text.h"

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

// What the gate asks of a golden before it compares the curves.
std::string identity_change(const GoldenRecord& old, const GoldenRecord& now) {
  std::vector<std::string> out;
  const auto ask = [&](const char* name, const auto& before, const auto& after) {
    if (before != after) out.push_back(fmt::format("{} {} instead of {}", name, after, before));
  };
  ask("rig", old.rig, now.rig);
  ask("algorithm", old.algorithm, now.algorithm);
  ask("seed", old.seed, now.seed);
  const auto before = old.provenance.find("stimulus"), after = now.provenance.find("stimulus");
  if (before != old.provenance.end() && after != now.provenance.end()) ask("profile", before->second, after->second);
  return join(out, ", ");
}

// Windows that one of them does not have, or rows, and what is no number: another curve.
bool same_shape(const GoldenContent& a, const GoldenContent& b) {
  return std::ranges::equal(a.windows, b.windows, [](const auto& x, const auto& y) { return x.ati_N.size() == y.ati_N.size() && x.dut_N.size() == y.dut_N.size(); });
}

double furthest_N(const GoldenContent& a, const GoldenContent& b, std::size_t every, GoldenCurve curve) {
  double worst = 0.0;
  const auto look = [&](double x, double y) {
    if (std::isnan(x) && std::isnan(y)) return;
    worst = std::isnan(x - y) ? std::numeric_limits<double>::infinity() : std::max(worst, std::fabs(x - y));
  };
  const bool ati = curve == GoldenCurve::ati;
  for (std::size_t i = 0; i < a.extrema.size() && i * every < b.extrema.size(); ++i)
    look(ati ? a.extrema[i].ati_N : a.extrema[i].dut_N,
         ati ? b.extrema[i * every].ati_N : b.extrema[i * every].dut_N);
  for (std::size_t w = 0; w < std::min(a.windows.size(), b.windows.size()); ++w) {
    const auto &x = ati ? a.windows[w].ati_N : a.windows[w].dut_N,
               &y = ati ? b.windows[w].ati_N : b.windows[w].dut_N;
    for (std::size_t i = 0; i < std::min(x.size(), y.size()); ++i) look(x[i], y[i]);
  }
  return worst;
}

std::string change_of(const GoldenRecord* old, const GoldenRecord& now, const std::string& truth) {
  if (old == nullptr) return "new";
  if (old->extrema_in_all != now.content.extrema.size())
    return fmt::format("{} extrema instead of {}", now.content.extrema.size(), old->extrema_in_all);
  const double ati = furthest_N(old->content, now.content, old->every, GoldenCurve::ati);
  const double dut = furthest_N(old->content, now.content, old->every, GoldenCurve::firmware);
  const std::string identity = identity_change(*old, now);
  if (!same_shape(old->content, now.content)) return "other windows" + (identity.empty() ? "" : ", " + identity);
  if (ati < 1e-4 && dut < 1e-4) return identity.empty() ? "unchanged" : identity;
  return (identity.empty() ? "" : identity + "; ") + fmt::format("{} by at most {:.4f} N, firmware by at most {:.4f} N", truth, ati, dut);
}

// A run as it is blessed, of whatever kind.
struct BlessedRun {
  const RunResult* head = nullptr;
  std::string level, rig;
  std::string goldens;  ///< folder that the plan names
  Decision without_goldens;
  std::vector<GoldenTarget> targets;
};

BlessedRun blessed(const RunMaterial& m) {
  RunMaterial without = m;
  for (PlanCase& c : without.plan.cases) c.checks &= ~static_cast<unsigned>(kCheckGolden);
  const std::string rig = m.records.empty() ? std::string() : m.records.front().record.rig.id;
  return {&m.head,
          std::string(to_string(m.level)),
          rig,
          m.plan.limits.goldens,
          to_run_result(without, judge_material(without)).decision,
          golden_targets(m)};
}

BlessedRun blessed(const characterize::WeightMaterial& m) {
  characterize::WeightMaterial without = m;
  const RunResult judged = to_run_result(without, judge_material(without));
  without.plan.goldens = ".";  // every sensor has its golden, wherever the first ones are put
  return {&m.head,         std::string(to_string(CalibrationLevel::nominal)),
          m.head.rig.id,   m.plan.goldens,
          judged.decision, golden_targets(without)};
}

GoldenRecord golden_of(const BlessedRun& run, const Bundle& bundle, const GoldenTarget& target,
                       const BlessRequest& request) {
  GoldenRecord g;
  g.plan = run.head->plan_name;
  g.case_name = target.case_name;
  g.specimen = target.specimen;
  g.seed = target.seed;
  g.rig = target.rig;
  g.algorithm = target.algorithm;
  g.ati = target.truth_tube;
  g.firmware = target.firmware_tube;
  g.content = target.content;
  g.provenance["firmware_sha256"] = run.head->firmware_sha256;
  g.provenance["bundle"] = bundle.id;
  g.provenance["tool_version"] = bundle.tool_version;
  g.provenance["date"] = run.head->started_at.substr(0, 10);
  if (!target.stimulus.empty()) g.provenance["stimulus"] = target.stimulus;
  g.provenance["calibration"] = run.level + " " + target.calibration;
  g.provenance["who"] = cell(request.who);
  g.provenance["reason"] = cell(request.reason);
  g.provenance[target.error_name] = fmt::format("{:.3f}", std::isfinite(target.error) ? target.error : 0.0);
  return g;
}

// A golden of another rig than the plan's own says so where it is reviewed.
std::string with_options(const RunResult& head) {
  const std::string options = stated_condition(head, kRigOptions);
  return options == kNoCondition ? "" : " (" + cell(options) + ")";
}

Result<void> append_line(const fs::path& path, const std::string& line) {
  std::string text = kHeading;
  std::error_code ignored;
  if (fs::exists(path, ignored) && fs::file_size(path, ignored) > 0) {
    FORCEGATE_TRY(text, read_file(path));
  }
  return write_file_atomically(path, text + line);
}

Result<std::string> name_of_plan(const fs::path& path) {
  FORCEGATE_TRY(const bool weights, is_weight_plan(path.string()));
  if (weights) {
    FORCEGATE_TRY(const characterize::WeightGatePlan plan, characterize::read_weight_gate_plan(path));
    return plan.name;
  }
  FORCEGATE_TRY(const Plan plan, read_plan(path));
  return plan.name;
}

// Goldens are as seen from the plan's file: the one that is given, that the gate was given, or that of its name in ci/plans.
Result<fs::path> folder_beside_plan(const BlessRequest& request, const Bundle& bundle, const BlessedRun& run) {
  const std::string& name = run.head->plan_name;
  std::error_code ignored;
  const bool known = request.plan.empty() && !bundle.plan_file.empty();
  if (known && !fs::is_regular_file(bundle.plan_file, ignored))
    return fail(ErrorCode::usage, "the plan's file, beside which its goldens are, is not there", bundle.plan_file,
                "run it in the folder where the gate ran, give the file with --plan, or the folder of the goldens with --goldens");
  const std::string asked = known ? bundle.plan_file : request.plan.empty() ? name : request.plan;
  const auto path = find_plan(asked);
  if (!path)
    return fail(ErrorCode::usage, path.error().text + ", beside which its goldens are", path.error().where,
                "give the plan's file: --plan FILE, or the folder of the goldens: --goldens FOLDER");
  FORCEGATE_TRY(const std::string of_file, name_of_plan(*path));
  if (of_file != name)
    return fail(ErrorCode::usage, "the run is of the plan '" + printable_utf8(name) + "', not of '" + printable_utf8(of_file) + "'", path->string(),
                "give the file of its plan: --plan FILE, or the folder of the goldens: --goldens FOLDER");
  return path->parent_path() / run.goldens;
}

Result<BlessAnswer> bless_run(const BlessRequest& request) {
  FORCEGATE_TRY(const Bundle bundle, read_bundle(request.source));
  const BlessedRun run = std::visit([](const auto& m) { return blessed(m); }, bundle.material);
  const RunResult& head = *run.head;
  if (run.without_goldens.kind != DecisionKind::accept)
    return fail(ErrorCode::usage,
                fmt::format("this run is {} apart from its goldens: {}", to_string(run.without_goldens.kind),
                            run.without_goldens.reason),
                {}, "bless a run that is accepted");
  if (const std::string faults = stated_condition(head, kFaults); faults != kNoCondition)
    return fail(ErrorCode::usage, "this run was played with injected faults: " + faults, request.source.string(), "bless a run without --fault");
  fs::path folder = request.goldens;
  if (folder.empty()) {
    if (run.goldens.empty())
      return fail(
          ErrorCode::usage, "the plan of this run names no goldens", head.plan_name,
          "make a folder (mkdir FOLDER), gate with --golden FOLDER and bless that run, or add goldens = \"...\" to its [limits] and \"golden\" to the checks of a case");
    folder = run.goldens;
    if (!folder.is_absolute()) {
      FORCEGATE_TRY(folder, folder_beside_plan(request, bundle, run));
    }
    folder = folder.lexically_normal();
  }
  FORCEGATE_TRY(const std::vector<GoldenRecord> before, read_goldens(folder));
  BlessAnswer answer;
  std::vector<std::pair<fs::path, std::string>> files;
  for (const GoldenTarget& target : run.targets) {
    if (!target.to_bless) continue;
    GoldenRecord now = golden_of(run, bundle, target, request);
    const auto old = std::find_if(before.begin(), before.end(), [&](const GoldenRecord& g) {
      return g.case_name == now.case_name && g.specimen == now.specimen;
    });
    if (old != before.end()) now.ati = old->ati, now.firmware = old->firmware;
    BlessChange change{golden_file_name(now.case_name, now.specimen),
                       change_of(old == before.end() ? nullptr : &*old, now, target.truth), true};
    change.changed = change.what != "unchanged";
    if (change.changed) files.emplace_back(folder / change.file, to_text(now));
    answer.changes.push_back(std::move(change));
  }
  std::error_code unknown;
  const std::string asked_for = request.goldens.empty() ? std::string("FOLDER") : file_quoted(request.goldens.string());
  if (answer.changes.empty())
    return fail(ErrorCode::usage, "no case of this run asks for a golden", head.plan_name,
                (fs::is_directory(request.goldens, unknown) ? "" : "make the folder (mkdir " + asked_for + "), ") + "gate with --golden " + asked_for + " and bless that run, or add \"golden\" to the checks of a case of the plan");
  answer.target = folder;
  answer.governance = folder.parent_path() / "CHANGES.md";
  std::string list;
  for (const BlessChange& c : answer.changes)
    if (c.changed) list += (list.empty() ? "" : "; ") + c.file + ": " + c.what;
  answer.line =
      fmt::format("| {} | {} | {} | {} | {} | {} | {} | bundle {} | {} |\n", head.started_at.substr(0, 10),
                  head.plan_name, cell(request.who), cell(request.reason), head.firmware_sha256.substr(0, 16),
                  run.rig + with_options(head), run.level, bundle.id.substr(0, 16), list);
  if (request.dry_run || files.empty()) return answer;
  for (const auto& [path, text] : files) FORCEGATE_CHECK_OK(write_file_atomically(path, text));
  FORCEGATE_CHECK_OK(append_line(answer.governance, answer.line));
  answer.written = true;
  return answer;
}

Result<BlessAnswer> bless_limits(const BlessRequest& request) {
  FORCEGATE_TRY(const DerivedLimits now, read_limits(request.source));
  auto found = find_plan(request.plan.empty() ? now.plan : request.plan);
  if (!found) {
    found.error().hint = "give its file: --plan FOLDER/" + now.plan + ".toml";
    return Unexpected(found.error());
  }
  const fs::path plan_path = *found;
  FORCEGATE_TRY(const Plan plan, read_plan(plan_path));
  if (plan.name != now.plan)
    return fail(ErrorCode::usage, "the limits are those of the plan '" + printable_utf8(now.plan) + "', not of '" + plan.name + "'", plan_path.string());
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
      answer.changes.push_back(
          {key.first + " " + key.second, fmt::format("gone, was {:.4g} {}", limit.value, limit.unit), true});
      list += (list.empty() ? "" : "; ") + answer.changes.back().file + ": gone";
    }
  answer.target = target;
  answer.governance = target.parent_path() / "CHANGES.md";
  answer.line = fmt::format("| {} | {} | {} | {} | {} | {} | identified | limits of {} | {} |\n", now.date,
                            now.plan, cell(request.who), cell(request.reason),
                            now.firmware_sha256.substr(0, 16), now.rig, now.date, list);
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
  if (!fs::exists(request.source, ignored) && request.source.extension() == ".toml")  // a run is a folder
    return fail(ErrorCode::usage, "there is no such file of limits", request.source.string(), "check the name: it is the file that forcegate limits -o wrote");
  return fs::is_regular_file(request.source, ignored) ? bless_limits(request) : bless_run(request);
}

std::string bless_text(const BlessAnswer& a) {
  std::string out;
  for (const BlessChange& c : a.changes) out += fmt::format("  {:<48} {}\n", c.file, c.what);
  out += a.written ? fmt::format("written; noted in {}\n", a.governance.string())
                   : std::string("nothing was written\n");
  return out;
}

std::string bless_json(const BlessAnswer& a) {
  nlohmann::ordered_json changes = nlohmann::ordered_json::array();
  for (const BlessChange& c : a.changes)
    changes.push_back({{"file", c.file}, {"change", c.what}, {"changed", c.changed}});
  return nlohmann::ordered_json{
      {"format", 1}, {"written", a.written}, {"governance", a.governance.string()}, {"changes", changes}}
      .dump(2, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace forcegate
