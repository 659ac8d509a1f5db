#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "hil/gate/judge.h"
#include "hil/gate/statistics.h"

namespace forcegate {
namespace {

JudgedCheck panel_check(const Plan& plan, const PlanCase& planned, bool maximum,
                        const std::vector<std::string>& specimens,
                        const std::vector<const JudgedCase*>& judged) {
  const char* which = maximum ? "maxima" : "minima";
  JudgedCheck j;
  Check& c = j.check;
  c.id = fmt::format("promise_{}/{}", which, planned.name);
  c.title = fmt::format("Mean relative error of the {}, ATI against set-point, mean of {} specimens{}", which,
                        specimens.size(),
                        planned.tail_s > 0.0 ? fmt::format(", last {:.0f} s", planned.tail_s) : "");
  c.unit = "%";
  c.limit = {Limit::Kind::upper, maximum ? *planned.maxima_pct : *planned.minima_pct, planned.limit_source};
  std::vector<double> values;
  double u_systematic = 0.0;
  bool relative = true;
  for (const JudgedCase* one : judged) {
    const PanelValue& v = maximum ? one->maxima : one->minima;
    relative = relative && v.unit == "%";
    if (!v.usable || !std::isfinite(v.value)) continue;
    values.push_back(v.value);
    u_systematic = std::max(u_systematic, v.u_systematic);
  }
  c.n = values.size();
  const Moments m = moments(values);
  c.value = m.mean;
  if (!relative || values.size() < specimens.size() || values.empty()) {
    j.judgeable = false;
    const bool rig = std::any_of(judged.begin(), judged.end(), [](const JudgedCase* one) {
      return std::any_of(one->checks.begin(), one->checks.end(), [](const JudgedCheck& x) {
        return x.check.required && x.check.verdict == Verdict::rig_error;
      });
    });
    c.verdict = rig ? Verdict::rig_error : Verdict::inconclusive;
    c.blame = rig ? Blame::rig : Blame::firmware;
    c.evidence = relative
                     ? fmt::format("only {} of {} specimens gave a value", values.size(), specimens.size())
                     : "the profile's minima are too small for a relative error";
    if (values.size() < 2) c.u = 0.0;
    return j;
  }
  const double n = static_cast<double>(values.size());
  const double repeat = plan.uncertainty.record_repeat_pct / std::sqrt(n);
  c.u = std::hypot(repeat, u_systematic);
  const auto inside =
      std::count_if(values.begin(), values.end(), [&](double v) { return v <= c.limit.value; });
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  c.evidence = fmt::format(
      "specimens {:.2f} to {:.2f} %, standard deviation {:.2f}, {} of {} inside singly; u from repeatability "
      "{:.2f}, "
      "systematic {:.2f}",
      *low, *high, values.size() > 1 ? m.sd : 0.0, inside, values.size(), repeat, u_systematic);
  return j;
}

}  // namespace

std::vector<JudgedCheck> judge_panel(const Plan& plan, const PlanCase& planned,
                                     const std::vector<std::string>& specimens,
                                     const std::vector<const JudgedCase*>& judged) {
  std::vector<JudgedCheck> checks;
  if (!(planned.checks & kCheckPromise) || !planned.maxima_pct || !planned.minima_pct) return checks;
  checks.push_back(panel_check(plan, planned, true, specimens, judged));
  checks.push_back(panel_check(plan, planned, false, specimens, judged));
  return checks;
}

}  // namespace forcegate
