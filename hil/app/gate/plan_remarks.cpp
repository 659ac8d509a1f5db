#include "hil/app/gate/plan_remarks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <vector>

#include "hil/base/text.h"
#include "hil/gate/judge_accuracy.h"
#include "hil/gate/limits.h"
#include "hil/gate/runner.h"
#include "hil/gate/sinks.h"
#include "hil/interface/rig.h"
#include "hil/interface/stimulus.h"
#include "hil/rig/control_period.h"

namespace forcegate {
namespace {

constexpr double kCommandsPerSwing = 4.0;

// " for its minima": of which kind of extremum nothing says how far off it may be; empty where nothing is said of either.
std::optional<std::string> without_limit(const Plan& plan, const PlanCase& c, const StimulusFacts& facts, const DerivedLimits& limits) {
  const auto derived = [&](const char* id) { return limits.find(c.name, id).kind != Limit::Kind::none; };
  const bool relative = facts.mean_N - facts.amplitude_N >= plan.limits.minima_floor_N;
  const bool maxima = c.maxima_pct || derived("mre_maxima");
  const bool minima = relative ? c.minima_pct || derived("mre_minima") : derived("mae_minima");
  if (maxima && minima) return std::nullopt;
  return maxima ? fmt::format(" for its minima ({})", relative ? "mre_minima" : "mae_minima") : std::string(minima ? " for its maxima (mre_maxima)" : "");
}

double highest_Hz(const StimulusSpec& spec) {
  double f_Hz = 0.0;
  if (const auto one = spec.numbers.find("f_Hz"); one != spec.numbers.end()) f_Hz = one->second;
  if (const auto many = spec.lists.find("f_Hz"); many != spec.lists.end())
    for (const double f : many->second) f_Hz = std::max(f_Hz, f);
  return f_Hz;
}

// Of a force that has been cycled before.
double longest_hold_s(const Stimulus& stimulus) {
  constexpr double kStep_s = 0.01, kMoved_N = 1.0;
  const auto n = static_cast<std::size_t>(stimulus.duration_s() / kStep_s);
  std::vector<double> force_N(n);
  stimulus.fill(0.0, kStep_s, n, force_N.data());
  double moved_N = 0.0, longest_s = 0.0, held_s = 0.0;
  for (std::size_t i = 1; i < n; ++i) {
    const bool still = force_N[i] == force_N[i - 1];
    held_s = still ? held_s + kStep_s : 0.0;
    if (!still && kStep_s * static_cast<double>(i) > stimulus.facts().excitation_start_s) moved_N += std::fabs(force_N[i] - force_N[i - 1]);
    if (moved_N >= kMoved_N) longest_s = std::max(longest_s, held_s);
  }
  return longest_s;
}

// Times that leave nothing to judge, or nothing out: milliseconds where seconds are meant, and the other way round.
void remark_on_times(const Plan& plan, const PlanCase& c, const Stimulus& stimulus, std::vector<std::string>& out) {
  const double f_Hz = highest_Hz(c.stimulus), length_s = stimulus.duration_s();
  if (f_Hz > 0.0 && plan.limits.lag_s >= 0.5 / f_Hz)
    out.push_back(fmt::format("case {}: the lag is never decided, half a period of {:.4g} s is no more than lag_s = {:.4g} s", c.name, 0.5 / f_Hz, plan.limits.lag_s));
  if (c.tail_s <= 0.0 || !(c.checks & (kCheckAccuracy | kCheckPromise))) return;
  if (c.tail_s >= length_s)
    out.push_back(fmt::format("case {}: tail_s = {:.4g} s is no less than the record's {:.4g} s: nothing is left out of it", c.name, c.tail_s, length_s));
  else if (f_Hz > 0.0 && c.tail_s * f_Hz < 2.0)
    out.push_back(fmt::format("case {}: tail_s = {:.4g} s holds fewer than two periods, an accuracy needs two extrema of each kind", c.name, c.tail_s));
}

// A profile of which a check makes nothing, on any rig.
void remark_on_profile(const PlanCase& c, const Stimulus& stimulus, double rate_Hz, std::vector<std::string>& out) {
  if (c.checks & (kCheckAccuracy | kCheckPromise)) {
    const double prominence_N = prominence_of(c, stimulus.facts());
    const std::uint64_t extrema = expected_extrema(stimulus, prominence_N, rate_Hz);
    if (extrema < kExtremaOfAccuracy)
      out.push_back(fmt::format("case {}: its profile has {} extrema that stand out by {:.4g} N (prominence_N), an accuracy needs {}: it is not run; a larger A_N, a higher f_Hz or a longer record",
                                c.name, extrema, prominence_N, kExtremaOfAccuracy));
  }
  if (c.checks & kCheckHold && longest_hold_s(stimulus) <= HoldWatch::kSettle_s)
    out.push_back(fmt::format("case {} asks for 'hold', and its profile holds no force for more than {:g} s after cycling: the check is not run (stimulus jump with f_Hz = [0.5, 0])", c.name,
                              HoldWatch::kSettle_s));
  // With fewer commands the wheel makes something else of the swing: measured on the emulated rig, 25 Hz is followed and 30 Hz is not.
  const double period_s = control_period(rate_Hz).s, f_Hz = highest_Hz(c.stimulus);
  if (stimulus.facts().dynamic && f_Hz * kCommandsPerSwing * period_s > 1.0)
    out.push_back(fmt::format("case {}: the wheel is commanded every {:g} ms and does not follow {:.4g} Hz, at most {:.4g} Hz: the record covers nothing", c.name, 1000.0 * period_s, f_Hz,
                              1.0 / (kCommandsPerSwing * period_s)));
}

}  // namespace

bool lacks_limits(const Plan& plan) {
  return std::ranges::any_of(plan.cases, [&](const PlanCase& c) {
    const auto made = make_stimulus(c.stimulus);
    return c.loop == LoopMode::open && c.checks & kCheckAccuracy && made && (*made)->facts().dynamic && without_limit(plan, c, (*made)->facts(), {});
  });
}

std::string no_limits_file_help(const Plan& plan) {
  return "mend the path, or make the file: forcegate limits GOOD --plan " + file_quoted(plan.path.string()) + " -o new.toml, then forcegate bless new.toml";
}

Result<void> remark_on(const Plan& plan, PlanEstimate& e) {
  std::vector<std::string>& out = e.remarks;
  const auto refused = [&](std::string why) {
    out.push_back(std::move(why));
    e.refused = true;
  };
  FORCEGATE_TRY(const auto rig, make_rig("emulated", {}));
  const double highest_N = rig->info().force_max_N;
  DerivedLimits limits;
  if (!plan.limits.derived.empty()) {
    const std::filesystem::path path = plan.path.parent_path() / plan.limits.derived;
    if (auto read = read_limits(path))
      limits = std::move(*read);
    else if (std::error_code ignored; std::filesystem::exists(path, ignored))
      refused("limits file " + plan.limits.derived + ": " + read.error().text + " (forcegate limits)");
    else if (const std::string why = "limits file " + plan.limits.derived + ": " + read.error().text + " (" + plan.limits.derived_where; lacks_limits(plan))
      refused(why + "): forcegate gate refuses it; " + no_limits_file_help(plan));
    else
      out.push_back(why + "; forcegate limits)");
  }
  const bool with_goldens = std::any_of(plan.cases.begin(), plan.cases.end(), [](const PlanCase& c) { return c.checks & kCheckGolden; });
  if (with_goldens && plan.limits.goldens.empty())
    out.push_back("golden traces: a case asks for 'golden' and [limits] names no folder of them (goldens = \"...\"): without a golden there is no decision");
  else if (std::error_code ignored; with_goldens && !std::filesystem::is_directory(plan.path.parent_path() / plan.limits.goldens, ignored))
    out.push_back("golden traces: there is no folder " + (plan.path.parent_path() / plan.limits.goldens).lexically_normal().string() +
                  ", and without a golden there is no decision (forcegate bless RUN makes them)");
  std::set<std::string> specimens;
  for (const PlanCase& c : plan.cases) {
    specimens.insert(specimens_of(plan, c).begin(), specimens_of(plan, c).end());
    const auto made = make_stimulus(c.stimulus);
    if (made && (*made)->facts().maximum_N > highest_N)
      out.push_back(fmt::format("case {} goes to {:.4g} N, the emulated rig to {:.4g} N", c.name, (*made)->facts().maximum_N, highest_N));
    if (c.checks == 0 && plan.name != "campaign") refused("case " + c.name + " asks for no check: forcegate gate refuses it");
    const bool dynamic = made && (*made)->facts().dynamic;
    if (dynamic && c.checks & kCheckAccuracy)
      if (const auto missing = without_limit(plan, c, (*made)->facts(), limits))
        out.push_back("case " + c.name + " asks for an accuracy and has no limit" + *missing + ": maxima_pct, minima_pct and limit_source, or forcegate limits");
    if (made && !e.replays) remark_on_profile(c, **made, rig->info().rate_Hz, out);
    if (dynamic) remark_on_times(plan, c, **made, out);
    if (dynamic && c.checks & kCheckPromise && (*made)->facts().mean_N - (*made)->facts().amplitude_N < plan.limits.minima_floor_N)
      out.push_back(fmt::format("case {} has minima below {:g} N, which have no relative error: the check 'promise' is never decided", c.name, plan.limits.minima_floor_N));
    if (dynamic && c.checks & (kCheckAccuracy | kCheckPromise) && (*made)->duration_s() <= (*made)->facts().excitation_start_s + plan.limits.learning_s)
      out.push_back(fmt::format("case {} ends within the start window of {:.4g} s: no extremum of it is judged", c.name, plan.limits.learning_s));
  }
  if (e.replays) specimens.clear();  // never played on a rig
  for (const std::string& specimen : specimens) {
    RigRecordRequest probe;
    probe.specimen = specimen;
    probe.duration_s = 1.0;
    probe.force_high_N = 1.0;
    if (auto begun = rig->begin(probe); !begun) refused(begun.error().text + (begun.error().hint.empty() ? "" : " (" + begun.error().hint + ")"));
  }
  return {};
}

}  // namespace forcegate
