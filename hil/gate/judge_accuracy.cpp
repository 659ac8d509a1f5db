#include "hil/gate/judge_accuracy.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>

#include "hil/gate/input_checks.h"
#include "hil/gate/judged_extrema.h"
#include "hil/gate/statistics.h"
#include "hil/trace/extrema.h"

namespace forcegate {

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kFewMissing = 0.02;
constexpr std::size_t kOfEachKind = 2, kExtremaNeeded = 2 * kOfEachKind;  // one has no spread

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

}  // namespace

void judge_accuracy(const Plan& plan, const PlanCase& planned, const CaseRecord& record,
                    const DerivedLimits& limits, CaseChecks& checks, JudgedCase& out) {
  const Blame of_profile = record.rig.can_move ? Blame::user : Blame::recording;
  if (const std::size_t n = record.pairs.size(); planned.checks & kCheckAccuracy && n < kExtremaNeeded)
    checks.final_check("accuracy", "Extrema to judge the accuracy on", Verdict::not_run, of_profile,
                       fmt::format("the record holds {} extrema, an accuracy needs {}", n, kExtremaNeeded));
  if (!record.facts.dynamic && record.pairs.empty()) return;
  const bool closed = planned.loop == LoopMode::closed;
  const char* against = closed ? "ATI against set-point" : "firmware against ATI";
  const double low_N = minima_N(planned, record);
  for (const bool maximum : {true, false}) {
    const JudgedExtrema s = judged_extrema(planned, record, maximum);
    const char* which = maximum ? "maxima" : "minima";
    const RelativeError e = mean_relative_error(s.actual, s.expected, kExtremumFloor_N);
    const double typical_N = std::fabs(moments(s.expected).mean);
    const std::size_t items = e.n + e.left_out;
    // In a closed loop the ATI goes where the firmware does not read it.
    const double off_N = sum_of_differences(s.actual, s.expected);
    const double misfit = (closed ? off_N < 0.0 : off_N > 0.0) ? calibration_misfit(record).reads_high : calibration_misfit(record).reads_low;
    const Budget relative =
        mre_budget(plan.uncertainty, record, typical_N, e.standard_error, e.n, planned.half_width_s);
    const Budget absolute = mae_budget(plan.uncertainty, record, typical_N, e.standard_error_absolute, items, planned.half_width_s);
    const bool judge_relative = maximum || low_N >= plan.limits.minima_floor_N;
    const std::string mre_id = fmt::format("mre_{}", which), mae_id = fmt::format("mae_{}", which);
    const std::string tail =
        planned.tail_s > 0.0 ? fmt::format(" over the last {:.0f} s", planned.tail_s) : "";
    const std::string mre_title = fmt::format("Mean relative error of the {}, {}{}", which, against, tail);
    const std::string mae_title = fmt::format("Mean absolute error of the {}, {}{}", which, against, tail);
    // A few extrema may fall into a gap of the reference; more, and their mean is not that of the record.
    const bool whole =
        static_cast<double>(e.not_finite) <= kFewMissing * static_cast<double>(s.expected.size());
    const double mre = whole ? 100.0 * e.mean : kNan, mae = whole ? e.mean_absolute : kNan;
    if (closed) {
      PanelValue& panel = maximum ? out.maxima : out.minima;
      panel.usable = checks.rig_sound && checks.complete && e.not_finite == 0 && e.n > 0;
      panel.value = judge_relative ? mre : mae;
      panel.unit = judge_relative ? "%" : "N";
      panel.u_systematic = judge_relative ? relative.u_systematic() : absolute.u_systematic();
      panel.explained = judge_relative ? 100.0 * misfit : misfit * typical_N;
    }
    const bool wanted = planned.checks & kCheckAccuracy && !closed;
    const Limit none{};
    const std::string judged_id = judge_relative ? mre_id : mae_id;
    const std::optional<double> given = maximum ? planned.maxima_pct : planned.minima_pct;
    const Limit limit =
        wanted ? limit_of(judged_id, judge_relative ? given : std::nullopt, planned, limits) : none;
    const bool derived = wanted && !(judge_relative && given);
    if (wanted && items == 0 && record.duration_s <= record.facts.excitation_start_s + plan.limits.learning_s) {
      checks.final_check(judged_id, judge_relative ? mre_title : mae_title, Verdict::not_run, of_profile,
                         fmt::format("the record ends at {:.0f} s, no {} is behind the start window, which may last {:.0f} s: "
                                     "play a longer profile",
                                     record.duration_s, maximum ? "maximum" : "minimum", plan.limits.learning_s));
      continue;
    }
    if (wanted && items < kOfEachKind) {
      checks.final_check(judged_id, judge_relative ? mre_title : mae_title, Verdict::not_run, of_profile,
                         fmt::format("{} {} behind the start window{}, an accuracy needs {}: play a longer profile", items,
                                     items == 1 ? (maximum ? "maximum lies" : "minimum lies")
                                     : maximum  ? "maxima lie"
                                                : "minima lie",
                                     tail, kOfEachKind));
      continue;
    }
    // What the limit was derived with is left out of the value that is held against it, and of no other. Another rig has another
    // reference: nothing cancels.
    const auto add = [&](const std::string& id, const std::string& title, double value, const char* unit, const Budget& budget, std::size_t n, bool judged,
                         const std::string& evidence) {
      const bool cancelled = derived && judged && limits.of_rig(record.rig);
      checks.value_check(id, title, value, unit, cancelled ? budget.u_against_derived() : budget.u(), n, judged ? limit : none,
                         evidence + "; " + budget.to_text(unit, cancelled));
      checks.list.back().check.u_against_derived = budget.u_against_derived();
      checks.list.back().dof = budget.degrees_of_freedom(cancelled ? budget.u_against_derived() : budget.u(), n);
      checks.repeatable(cancelled ? budget.u_of_this_record() : budget.u_systematic());
      checks.explained_by_calibration(std::string_view(unit) == "%" ? 100.0 * misfit : misfit * typical_N);
    };
    add(mre_id, mre_title, mre, "%", relative, e.n, judge_relative, fmt::format("{} {}, largest {:.2f} %", e.n, which, 100.0 * e.largest));
    add(mae_id, mae_title, mae, "N", absolute, items, !judge_relative, fmt::format("{} {}", items, which));
    if (wanted && limit.kind == Limit::Kind::none)
      checks.final_check("accuracy_" + std::string(which), judge_relative ? mre_title : mae_title,
                         Verdict::not_run, Blame::user,
                         fmt::format("there is no limit for {} of {}: derive limits first (forcegate limits)",
                                     judged_id, planned.name));
  }
}

}  // namespace forcegate
