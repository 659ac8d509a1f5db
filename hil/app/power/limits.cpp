#include "hil/app/power/limits.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "hil/app/files/find_plan.h"
#include "hil/base/digest.h"
#include "hil/base/text.h"
#include "hil/gate/run_judge.h"
#include "hil/gate/statistics.h"

namespace forcegate {
namespace {

constexpr std::size_t kBatch = 25;  // specimens at a time: memory does not grow with n
constexpr std::size_t kFewestRecordings = 5;

// The gate judges small minima by their absolute error (hil/gate/judge_accuracy.cpp), for which a plan gives no limit.
bool needs_derived(const Plan& plan, const PlanCase& c) {
  if (!c.maxima_pct || !c.minima_pct) return true;
  const auto profile = make_stimulus(c.stimulus);
  return profile && (*profile)->facts().mean_N - (*profile)->facts().amplitude_N < plan.limits.minima_floor_N;
}

class Derivation {
 public:
  explicit Derivation(std::string date) { limits_.date = std::move(date); }

  Result<void> from_rig(const LimitsRequest& request, const GateProgress& progress,
                        const std::atomic<bool>* cancelled) {
    FORCEGATE_TRY(const std::filesystem::path path, find_plan(request.plan));
    FORCEGATE_TRY(const Plan plan, read_plan(path));
    GateRequest gated = common(request, path);
    for (const PlanCase& c : plan.cases)
      if (c.loop == LoopMode::open && c.checks & kCheckAccuracy && needs_derived(plan, c))
        gated.only_cases.push_back(c.name);
    if (gated.only_cases.empty())
      return fail(ErrorCode::config, "no case of this plan needs a derived limit", path.string());
    for (std::size_t first = 0; first < request.n; first += kBatch) {
      const std::size_t count = std::min(kBatch, request.n - first);
      gated.panel.clear();
      for (std::size_t k = 0; k < count; ++k)
        gated.panel.push_back(fmt::format("seed:{}", request.first_seed + first + k));
      FORCEGATE_CHECK_OK(take(gated, plan.name, first, count, request.n, progress, cancelled));
    }
    return {};
  }

  Result<void> from_recordings(const LimitsRequest& request, const GateProgress& progress,
                               const std::atomic<bool>* cancelled) {
    if (request.records.size() < kFewestRecordings)
      return fail(ErrorCode::usage,
                  fmt::format("{} recordings do not show what repeats", request.records.size()), "--record",
                  fmt::format("give at least {} of the same profile", kFewestRecordings));
    FORCEGATE_TRY(const std::filesystem::path path, find_plan(request.plan));
    FORCEGATE_TRY(const Plan plan, read_plan(path));
    std::map<std::string, std::string> seen;  // digest, name: a recording that is given twice repeats by itself
    for (const std::filesystem::path& record : request.records) {
      FORCEGATE_TRY(const std::string digest, sha256_file(record));
      if (const auto [at, added] = seen.emplace(digest, record.string()); !added)
        return fail(ErrorCode::usage, at->second == record.string() ? "a recording is given twice" : "two recordings are the same, byte for byte: the other is " + at->second,
                    record.string(), fmt::format("give at least {} that were made one after the other", kFewestRecordings));
    }
    GateRequest gated = common(request, path);
    gated.only_cases = request.only_cases;
    gated.rig = "replay";
    gated.calibration_file = request.calibration_file;
    if (!request.map.empty()) gated.rig_options["map"] = request.map;
    for (std::size_t k = 0; k < request.records.size(); ++k) {
      gated.rig_options["record"] = request.records[k].string();
      FORCEGATE_CHECK_OK(take(gated, plan.name, k, 1, request.records.size(), progress, cancelled));
    }
    return {};
  }

  MadeLimits limits() {
    for (const auto& [key, list] : values_) {
      // Few recordings of one specimen repeat better than one of them is known: a good one must pass by U = 2 u.
      const double sd = limits_.rig.starts_with("replay") ? moments(list).sd + moments(u_[key]).mean
                                                          : std::max(moments(list).sd, moments(u_[key]).mean);
      limits_.by_case_and_check[key] = derive_limit(list, sd, units_[key]);
    }
    MadeLimits made{std::move(limits_), {}};
    for (const auto& [check, failed] : failed_)
      made.notes.push_back(fmt::format("the build fails the check {} in {} of {} records ({}): these are no limits of a known-good build (forcegate gate shows it)",
                                       check, failed.records, records_, printable_utf8(failed.evidence)));
    return made;
  }

 private:
  static GateRequest common(const LimitsRequest& request, const std::filesystem::path& plan) {
    GateRequest gated;
    gated.firmware = request.firmware;
    gated.plan = plan.string();
    gated.threads = request.threads;
    gated.single_look = true;
    gated.makes_limits = true;
    gated.without_limits = !request.records.empty();
    return gated;
  }

  Result<void> take(const GateRequest& gated, const std::string& plan, std::size_t first, std::size_t count,
                    std::size_t all, const GateProgress& progress, const std::atomic<bool>* cancelled) {
    const auto part = [&](double fraction, std::string_view now) {
      if (progress)
        progress(
            (static_cast<double>(first) + fraction * static_cast<double>(count)) / static_cast<double>(all),
            now);
    };
    FORCEGATE_TRY(const RunResult result, gate(gated, part, cancelled));
    if (result.decision.exit_code == 130) return fail(ErrorCode::cancelled, "interrupted");
    limits_.plan = plan;
    limits_.firmware_sha256 = result.firmware_sha256;
    limits_.rig = result.rig.name + "/" + result.rig.version;
    for (const CaseResult& c : result.cases) FORCEGATE_CHECK_OK(take(c, gated));
    return {};
  }

  Result<void> take(const CaseResult& c, const GateRequest& gated) {
    const std::string name = c.id.substr(0, c.id.find('/'));
    const std::string where = gated.rig == "replay" ? gated.rig_options.at("record") : c.id;
    if (is_superseded(c)) return {};  // a later attempt stands for it
    if (!c.note.empty()) return fail(ErrorCode::config, "a record failed: " + c.note, where);
    // Relative or absolute error of the minima: the one that the gate judges.
    const bool absolute_minima =
        std::any_of(c.checks.begin(), c.checks.end(),
                    [](const Check& check) {
                      return check.id == "mae_minima" && check.limit.kind != Limit::Kind::none;
                    }) ||
        std::any_of(c.checks.begin(), c.checks.end(), [](const Check& check) {
          return check.id == "accuracy_minima" && check.evidence.find("mae_minima") != std::string::npos;
        });
    ++records_;
    for (const Check& check : c.checks) {
      if (check.verdict == Verdict::fail && check.required && !is_error(check.id))
        if (++failed_[check.id].records == 1) failed_[check.id].evidence = check.evidence;
      if (check.id == "rig_calibration_fits" && check.verdict != Verdict::pass)
        return fail(ErrorCode::config, "the calibration does not fit the record: " + check.evidence, where, "give that of the specimen (--cal FILE)");
      if (check.id != "mre_maxima" && check.id != (absolute_minima ? "mae_minima" : "mre_minima")) continue;
      if (check.verdict == Verdict::rig_error || !std::isfinite(check.value))
        return fail(ErrorCode::config, "a record gave no value for " + check.id, where);
      values_[{name, check.id}].push_back(check.value);
      u_[{name, check.id}].push_back(check.u);
      units_[{name, check.id}] = check.unit;
    }
    return {};
  }

  // What the derived limits are made for.
  static bool is_error(const std::string& id) { return id.starts_with("mre_") || id.starts_with("mae_") || id.starts_with("accuracy_"); }

  struct Failed {
    std::size_t records = 0;
    std::string evidence;  ///< of the first
  };
  std::size_t records_ = 0;
  std::map<std::string, Failed> failed_;
  std::map<std::pair<std::string, std::string>, std::vector<double>> values_, u_;
  std::map<std::pair<std::string, std::string>, std::string> units_;
  DerivedLimits limits_;
};

}  // namespace

Result<MadeLimits> derive_limits(const LimitsRequest& request, const GateProgress& progress,
                                 const std::atomic<bool>* cancelled) {
  Derivation derivation(request.date);
  FORCEGATE_CHECK_OK(request.records.empty() ? derivation.from_rig(request, progress, cancelled)
                                             : derivation.from_recordings(request, progress, cancelled));
  return derivation.limits();
}

std::string made_limits_text(const MadeLimits& made) {
  std::string out;
  for (const std::string& note : made.notes) out += "# note: " + note + "\n";
  return out + write_limits(made.limits);
}

std::string made_limits_json(const MadeLimits& made) {
  auto out = nlohmann::ordered_json::parse(limits_json(made.limits));
  out["notes"] = made.notes;
  return out.dump(2);
}

Result<void> check_limits_output(const std::filesystem::path& output, const std::string& plan) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(output, ignored)) return {};
  bool in_force = std::filesystem::exists(output.parent_path() / "CHANGES.md", ignored);
  if (const auto path = find_plan(plan); !in_force && path)
    if (const auto read = read_plan(*path); read && !read->limits.derived.empty())
      in_force = std::filesystem::equivalent(output, path->parent_path() / read->limits.derived, ignored);
  if (!in_force) return {};
  return fail(ErrorCode::usage, "these limits are in force, and change only with a reason", output.string(),
              "write others beside (-o new.toml) and put them in force: forcegate bless new.toml --reason \"...\" --who NAME");
}

bool takes_derived_limits(const std::string& name) {
  const auto path = find_plan(name);
  if (!path) return false;
  const auto plan = read_plan(*path);
  return plan && !plan->limits.derived.empty();
}

}  // namespace forcegate
