#include "hil/gate/judge_accuracy.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "hil/gate/input_checks.h"
#include "hil/gate/judged_extrema.h"
#include "hil/gate/statistics.h"
#include "hil/trace/extrema.h"

namespace forcegate {

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kFewMissing = 0.02;
constexpr std::size_t kOfEachKind = kExtremaOfAccuracy / 2;

Limit limit_of(const std::string& id, const std::optional<double>& given, const PlanCase& planned,
               const DerivedLimits& limits) {
  if (given) return {Limit::Kind::upper, *given, planned.limit_source};
  return limits.find(planned.name, id);
}

double sum_of_differences(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i)
    if (std::isfinite(a[i] - b[i])) sum += a[i] - b[i];
  return sum;
}

// Of the maxima, or of the minima.
struct Accuracy {
  bool maximum = true;
  std::size_t expected = 0, items = 0;  // extrema of the case; those with a value
  RelativeError error;
  double mre_pct = kNan, mae_N = kNan;
  double typical_N = 0.0;
  double misfit = 0.0;  // share of the force by which the calibration may be off that way
  Budget relative, absolute;
  bool is_relative = true;  // which of the two is judged
  std::string tail;         // " over the last 60 s"

  const char* which() const { return maximum ? "maxima" : "minima"; }
  std::string id(bool of_relative) const { return fmt::format("{}_{}", of_relative ? "mre" : "mae", which()); }
  std::string title(bool of_relative, const char* against) const {
    return fmt::format("Mean {} error of the {}, {}{}", of_relative ? "relative" : "absolute", which(), against, tail);
  }
};

Accuracy accuracy_of(const Plan& plan, const PlanCase& planned, const CaseRecord& record, bool maximum) {
  const JudgedExtrema s = judged_extrema(planned, record, maximum);
  Accuracy out;
  out.maximum = maximum;
  out.expected = s.expected.size();
  const RelativeError& e = out.error = mean_relative_error(s.actual, s.expected, kExtremumFloor_N);
  out.items = e.n + e.left_out;
  out.typical_N = std::fabs(moments(s.expected).mean);
  // In a closed loop the ATI goes where the firmware does not read it.
  const double off_N = sum_of_differences(s.actual, s.expected);
  const bool reads_high = planned.loop == LoopMode::closed ? off_N < 0.0 : off_N > 0.0;
  out.misfit = reads_high ? calibration_misfit(record).reads_high : calibration_misfit(record).reads_low;
  out.relative = mre_budget(plan.uncertainty, record, out.typical_N, e.standard_error, e.n, planned.half_width_s);
  out.absolute = mae_budget(plan.uncertainty, record, out.typical_N, e.standard_error_absolute, out.items, planned.half_width_s);
  out.is_relative = maximum || minima_N(planned, record) >= plan.limits.minima_floor_N;
  if (planned.tail_s > 0.0) out.tail = fmt::format(" over the last {:.0f} s", planned.tail_s);
  // A few extrema may fall into a gap of the reference; more, and their mean is not that of the record.
  if (static_cast<double>(e.not_finite) <= kFewMissing * static_cast<double>(out.expected)) out.mre_pct = 100.0 * e.mean, out.mae_N = e.mean_absolute;
  return out;
}

PanelValue panel_of(const Accuracy& a, const CaseChecks& checks) {
  PanelValue panel;
  panel.usable = checks.rig_sound && checks.complete && a.error.not_finite == 0 && a.error.n > 0;
  panel.value = a.is_relative ? a.mre_pct : a.mae_N;
  panel.unit = a.is_relative ? "%" : "N";
  const Budget& budget = a.is_relative ? a.relative : a.absolute;
  panel.u_systematic = budget.u_systematic();
  panel.u_readings = budget.u_of_readings();
  panel.u_scatter = budget.u_of_scatter();
  panel.explained = a.is_relative ? 100.0 * a.misfit : a.misfit * a.typical_N;
  return panel;
}

// Why there are not enough of them; empty: there are.
std::string too_few(const Accuracy& a, const Plan& plan, const CaseRecord& record) {
  if (a.items == 0 && record.duration_s <= record.facts.excitation_start_s + plan.limits.learning_s)
    return fmt::format("the record ends at {:.0f} s, no {} is behind the start window, which may last {:.0f} s: play a longer profile", record.duration_s,
                       a.maximum ? "maximum" : "minimum", plan.limits.learning_s);
  if (a.items >= kOfEachKind) return {};
  const char* lie = a.items == 1 ? (a.maximum ? "maximum lies" : "minimum lies") : a.maximum ? "maxima lie" : "minima lie";
  return fmt::format("{} {} behind the start window{}, an accuracy needs {}: play a longer profile", a.items, lie, a.tail, kOfEachKind);
}

}  // namespace

void judge_accuracy(const Plan& plan, const PlanCase& planned, const CaseRecord& record,
                    const DerivedLimits& limits, CaseChecks& checks, JudgedCase& out) {
  const Blame of_profile = record.rig.can_move ? Blame::user : Blame::recording;
  if (const std::size_t n = record.pairs.size(); planned.checks & kCheckAccuracy && n < kExtremaOfAccuracy)
    checks.final_check("accuracy", "Extrema to judge the accuracy on", Verdict::not_run, of_profile,
                       fmt::format("the record holds {} extrema, an accuracy needs {}", n, kExtremaOfAccuracy));
  if (!record.facts.dynamic && record.pairs.empty()) return;
  const bool closed = planned.loop == LoopMode::closed;
  const char* against = closed ? "ATI against set-point" : "firmware against ATI";
  const bool wanted = planned.checks & kCheckAccuracy && !closed;
  const Limit none{};
  for (const bool maximum : {true, false}) {
    const Accuracy a = accuracy_of(plan, planned, record, maximum);
    if (closed) (maximum ? out.maxima : out.minima) = panel_of(a, checks);
    if (wanted)
      if (const std::string why = too_few(a, plan, record); !why.empty()) {
        checks.final_check(a.id(a.is_relative), a.title(a.is_relative, against), Verdict::not_run, of_profile, why);
        continue;
      }
    std::optional<double> given;
    if (a.is_relative) given = maximum ? planned.maxima_pct : planned.minima_pct;
    const Limit limit = wanted ? limit_of(a.id(a.is_relative), given, planned, limits) : none;
    const bool derived = wanted && !given;
    // What the limit was derived with is left out of the value that is held against it, and of no other. Another rig has another
    // reference: nothing cancels.
    const auto add = [&](bool relative, std::size_t n, const std::string& evidence) {
      const Budget& budget = relative ? a.relative : a.absolute;
      const char* unit = relative ? "%" : "N";
      const bool judged = relative == a.is_relative, cancelled = derived && judged && limits.of_rig(record.rig);
      checks.value_check(a.id(relative), a.title(relative, against), relative ? a.mre_pct : a.mae_N, unit, cancelled ? budget.u_against_derived() : budget.u(), n,
                         judged ? limit : none, evidence + "; " + budget.to_text(unit, cancelled));
      checks.list.back().check.u_against_derived = budget.u_against_derived();
      checks.list.back().dof = budget.degrees_of_freedom(cancelled ? budget.u_against_derived() : budget.u(), n);
      checks.repeatable(cancelled ? budget.u_of_this_record() : budget.u_systematic());
      checks.explained_by_calibration(relative ? 100.0 * a.misfit : a.misfit * a.typical_N);
    };
    add(true, a.error.n, fmt::format("{} {}, largest {:.2f} %", a.error.n, a.which(), 100.0 * a.error.largest));
    add(false, a.items, fmt::format("{} {}", a.items, a.which()));
    if (wanted && limit.kind == Limit::Kind::none)
      checks.final_check(fmt::format("accuracy_{}", a.which()), a.title(a.is_relative, against), Verdict::not_run, Blame::user,
                         fmt::format("there is no limit for {} of {}: derive limits first (forcegate limits)", a.id(a.is_relative), planned.name));
  }
}

}  // namespace forcegate
