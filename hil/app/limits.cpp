#include "hil/app/limits.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hil/gate/statistics.h"

namespace forcegate {
namespace {

constexpr std::size_t kBatch = 25;  // specimens at a time: memory does not grow with n

}  // namespace

Result<DerivedLimits> derive_limits(const LimitsRequest& request, const GateProgress& progress,
                                    const std::atomic<bool>* cancelled) {
  FORCEGATE_TRY(const std::filesystem::path path, find_plan(request.plan));
  FORCEGATE_TRY(const Plan plan, read_plan(path));
  GateRequest gated;
  gated.firmware = request.firmware;
  gated.plan = path.string();
  gated.threads = request.threads;
  gated.single_look = true;
  for (const PlanCase& c : plan.cases)
    if (c.loop == LoopMode::open && c.checks & kCheckAccuracy && !c.maxima_pct)
      gated.only_cases.push_back(c.name);
  if (gated.only_cases.empty())
    return fail(ErrorCode::config, "no case of this plan needs a derived limit", path.string());

  std::map<std::pair<std::string, std::string>, std::vector<double>> values;
  std::map<std::pair<std::string, std::string>, std::string> units;
  DerivedLimits limits;
  limits.plan = plan.name;
  limits.date = request.date;
  for (std::size_t first = 0; first < request.n; first += kBatch) {
    const std::size_t count = std::min(kBatch, request.n - first);
    gated.panel.clear();
    for (std::size_t k = 0; k < count; ++k)
      gated.panel.push_back(fmt::format("seed:{}", request.first_seed + first + k));
    const auto part = [&](double fraction, std::string_view now) {
      if (progress)
        progress((static_cast<double>(first) + fraction * static_cast<double>(count)) /
                     static_cast<double>(request.n),
                 now);
    };
    FORCEGATE_TRY(const RunResult result, gate(gated, part, cancelled));
    if (result.decision.exit_code == 130) return fail(ErrorCode::cancelled, "interrupted");
    limits.firmware_sha256 = result.firmware_sha256;
    limits.rig = result.rig.name + "/" + result.rig.version;
    for (const CaseResult& c : result.cases) {
      const std::string name = c.id.substr(0, c.id.find('/'));
      if (!c.note.empty()) return fail(ErrorCode::config, "a record failed: " + c.note, c.id);
      const bool relative_minima = c.facts.mean_N - c.facts.amplitude_N >= plan.limits.minima_floor_N;
      for (const Check& check : c.checks) {
        if (check.id != "mre_maxima" && check.id != (relative_minima ? "mre_minima" : "mae_minima")) continue;
        if (check.verdict == Verdict::rig_error || !std::isfinite(check.value))
          return fail(ErrorCode::config, "a record gave no value for " + check.id, c.id);
        values[{name, check.id}].push_back(check.value);
        units[{name, check.id}] = check.unit;
      }
    }
  }
  for (const auto& [key, list] : values) {
    DerivedLimit limit;
    limit.n = list.size();
    limit.unit = units[key];
    limit.p99 = sample_quantile(list, 0.99);
    limit.sd = moments(list).sd;
    limit.value = limit.p99 + 2.0 * limit.sd;
    limits.by_case_and_check[key] = limit;
  }
  return limits;
}

}  // namespace forcegate
