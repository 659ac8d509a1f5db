#include "hil/report/overlay_figure.h"

#include <algorithm>
#include <cctype>
#include <cmath>

#include "hil/report/figures/envelope.h"
#include "hil/report/figures/plots.h"
#include "hil/report/figures/text.h"
#include "hil/trace/extrema.h"

namespace forcegate {
namespace {

using namespace figures;

std::vector<double> difference(const EvidenceSeries& s) {
  std::vector<double> out;
  for (std::size_t i = 0; i < std::min(s.before.size(), s.after.size()); ++i) out.push_back(s.before[i] - s.after[i]);
  return out;
}

std::vector<double> scaled(std::vector<double> values, double factor) {
  for (double& v : values) v *= factor;
  return values;
}

double largest(const std::vector<double>& values) {
  double most = 0.0;
  for (const double v : values)
    if (std::isfinite(v)) most = std::max(most, std::abs(v));
  return most;
}

std::size_t turns_of(const EvidenceSeries& s) {
  constexpr double kProminence = 0.05;  // of the span
  double low = INFINITY, high = -INFINITY;
  for (const double v : s.before)
    if (std::isfinite(v)) low = std::min(low, v), high = std::max(high, v);
  if (!(high > low)) return 0;
  return turning_points(s.x, s.before, kProminence * (high - low)).size();
}

void add_lines(Panel& above, Panel& below, const EvidenceSeries& s, double factor) {
  std::vector<double> x = s.x, measured = s.before, modelled = s.after, residual = scaled(difference(s), factor);
  // a thinned series has uneven steps, eight at most in a stretch; its own gaps are NaN already
  constexpr double kAverageSteps = 9.0;
  if (x.size() > 1 && std::ranges::none_of(measured, [](double v) { return std::isnan(v); }))
    break_at_gaps(x, {&measured, &modelled, &residual}, kAverageSteps * (x.back() - x.front()) / static_cast<double>(x.size() - 1));
  above.line(x, measured, {Role::reference}, "measured").line(x, modelled, {Role::model, Dash::dashed, 1.4}, "model");
  below.line(x, residual, {Role::firmware, Dash::solid, 1.0}).hline(0.0);
}

void add_envelopes(Panel& above, Panel& below, const EvidenceSeries& s, double factor, std::size_t stretches) {
  const Envelope measured = envelope(s.x, s.before, stretches), modelled = envelope(s.x, s.after, stretches);
  add_band(above, measured, Role::reference, 0.35, "measured, smallest to largest");
  above.line(modelled.x, modelled.high, {Role::model, Dash::dashed, 1.4}, "model").line(modelled.x, modelled.low, {Role::model, Dash::dashed, 1.4});
  add_band(below, envelope(s.x, scaled(difference(s), factor), stretches), Role::firmware, 0.6, "");
  below.hline(0.0);
}

}  // namespace

Figure record_overlay_figure(const EvidenceSeries& s, const EvidenceSeries* few_cycles) {
  constexpr std::size_t kMostTurns = 120, kFewestStretches = 40, kMostStretches = 240;
  constexpr double kWidth = 560.0, kBoth = 860.0;
  const std::size_t turns = turns_of(s);
  const bool dense = turns > kMostTurns, both = dense && few_cycles != nullptr;
  Figure figure("Measured and modelled output, record " + s.record, both ? kBoth : kWidth);
  figure.share_x = true;
  figure.columns = both ? 2 : 1;
  std::string x_name = s.x_name.empty() ? "Time" : s.x_name;
  x_name[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(x_name[0])));
  const Axis along{x_name, s.x_unit};
  const double most = largest(difference(s));
  const Scaled scale = readable_unit(most, s.y_unit);
  Panel& above = figure.panel(along, {"Output", s.y_unit}, 120.0);
  Panel* const above_few = both ? &figure.panel(along, {"Output", s.y_unit}, 120.0) : nullptr;
  Panel& below = figure.panel(along, {"Measured \u2212 model", scale.unit}, 70.0);
  Panel* const below_few = both ? &figure.panel(along, {"Measured \u2212 model", scale.unit}, 70.0) : nullptr;
  below.y_axis.symmetric = true;
  above.show_x_labels = false;
  if (dense)
    add_envelopes(above, below, s, scale.factor, std::clamp(turns / 2, kFewestStretches, kMostStretches));
  else
    add_lines(above, below, s, scale.factor);
  if (both) {
    above.title = "Whole record";
    above_few->title = "A few cycles of its middle";
    above_few->show_x_labels = false;
    below_few->y_axis.symmetric = true;
    add_lines(*above_few, *below_few, *few_cycles, scale.factor);
  }
  figure.summary = "Largest departure " + display(most * scale.factor, 3) + " " + scale.unit + ".";
  return figure;
}

}  // namespace forcegate
