#include "hil/gate/budget.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "hil/gate/judged_extrema.h"

namespace forcegate {
namespace {

constexpr const char* kRepeatability = "repeatability";

template <class Counts>
double root_of_squares(const std::vector<BudgetLine>& lines, Counts counts) {
  double sum = 0.0;
  for (const BudgetLine& line : lines)
    if (counts(line)) sum += line.u * line.u;
  return std::sqrt(sum);
}

bool cancels(const BudgetLine& line) { return line.systematic && !line.of_this_record; }

// What the unloaded readings and the spring showed of the reference in this record: half width of a rectangle.
double drift_N(const CaseRecord& record, double typical_N) {
  const RigObservation& o = record.observed;
  double zero_N = 0.0;
  for (const double z : {o.zero_start_N, o.zero_end_N})
    if (std::isfinite(z)) zero_N = std::max(zero_N, std::fabs(z));
  const double slope = o.spring_samples > 0 ? std::fabs(o.spring_slope - 1.0) : 0.0;
  return std::hypot(zero_N, slope * typical_N) / std::sqrt(3.0);
}

}  // namespace

double Budget::u() const {
  return root_of_squares(lines, [](const BudgetLine&) { return true; });
}
double Budget::u_systematic() const {
  return root_of_squares(lines, [](const BudgetLine& line) { return line.systematic; });
}
double Budget::u_against_derived() const {
  return root_of_squares(lines, [](const BudgetLine& line) { return !cancels(line); });
}
double Budget::u_of_this_record() const {
  return root_of_squares(lines, [](const BudgetLine& line) { return line.of_this_record; });
}

double Budget::u_of_readings() const {
  return root_of_squares(lines, [](const BudgetLine& line) { return !line.systematic && line.name != kRepeatability; });
}
double Budget::u_of_scatter() const {
  return root_of_squares(lines, [](const BudgetLine& line) { return line.name == kRepeatability; });
}

double Budget::degrees_of_freedom(double of, std::size_t n) const {
  for (const BudgetLine& line : lines)
    if (line.name == kRepeatability && line.u > 0.0 && n > 1) return static_cast<double>(n - 1) * std::pow(of / line.u, 4);
  return 0.0;
}

std::string Budget::to_text(const std::string& unit, bool derived) const {
  std::string in, out;
  for (const BudgetLine& line : lines) {
    if (line.u < 5e-4) continue;
    if (std::string& list = derived && cancels(line) ? out : in; &list == &in)
      list += fmt::format("{}{} {:.3f}", list.empty() ? "" : ", ", line.name, line.u);
    else
      list += (list.empty() ? "" : ", ") + line.name;
  }
  in = in.empty() ? "u is below 0.0005 " + unit : "u from " + in + " " + unit;
  return out.empty() ? in : in + ", without " + out + ", which stand in the derived limit as well";
}

Budget mre_budget(const PlanUncertainty& plan, const CaseRecord& record, double typical_N,
                  double standard_error, std::size_t n, double half_width_s) {
  Budget b;
  if (n == 0 || !(typical_N > 0.0)) return b;
  const double root_n = std::sqrt(static_cast<double>(n));
  const double averaged = std::sqrt(2.0 * std::floor(half_width_s * record.rig.rate_Hz) + 1.0);
  const double reference = plan.reference_rel > 0.0 ? plan.reference_rel : record.rig.reference_u_rel;
  b.lines.push_back({"ATI calibration", 100.0 * reference, true});
  b.lines.push_back({"alignment", 100.0 * plan.alignment_rel, true});
  if (const double drift = drift_N(record, typical_N); drift > 0.0)
    b.lines.push_back({"drift", 100.0 * drift / typical_N, true, true});
  b.lines.push_back({"resolution",
                     100.0 * record.rig.reference_resolution_N / std::sqrt(12.0) / typical_N / root_n,
                     false});
  b.lines.push_back({"noise", 100.0 * record.rig.reference_noise_N / averaged / typical_N / root_n, false});
  const double period_s = shortest_period_s(record.pairs, record.facts.excitation_start_s);
  const double f_Hz = std::isfinite(period_s) ? 1.0 / period_s : std::isfinite(record.facts.lowest_frequency_Hz) ? record.facts.lowest_frequency_Hz : 0.0;
  const double u_sync_s =
      std::hypot(std::isfinite(record.u_lag_s) ? record.u_lag_s : 0.0, record.rig.reference_u_time_s);
  b.lines.push_back(
      {"synchronisation", 100.0 * (1.0 - std::cos(std::min(std::numbers::pi, 2.0 * std::numbers::pi * f_Hz * u_sync_s))), true});
  if (std::isfinite(standard_error)) b.lines.push_back({kRepeatability, 100.0 * standard_error, false});
  return b;
}

Budget mae_budget(const PlanUncertainty& plan, const CaseRecord& record, double typical_N,
                  double standard_error_N, std::size_t n, double half_width_s) {
  Budget b = mre_budget(plan, record, 1.0, standard_error_N, n, half_width_s);  // in percent of 1 N
  for (BudgetLine& line : b.lines) {
    line.u /= 100.0;
    if (line.systematic) line.u *= typical_N;
    if (line.name == "drift")
      line.u = drift_N(record, typical_N);  // a zero error does not grow with the force
  }
  return b;
}

}  // namespace forcegate
