#include "hil/report/figures/plots.h"

#include <algorithm>
#include <cmath>

#include "hil/base/quantile.h"
#include "hil/base/text.h"
#include "hil/report/figures/text.h"

namespace forcegate::figures {

Figure waterfall(const std::string& title, const std::string& start, const std::vector<WaterfallStep>& steps,
                 const std::string& end, const std::string& unit, double noise_floor, const std::string& not_claimed) {
  Figure figure(title, std::clamp(190.0 + 105.0 * static_cast<double>(steps.size()), 420.0, 900.0));
  const double first = steps.empty() ? kAuto : steps.front().before;
  const Scaled scale = readable_unit(first, unit);
  Panel& panel = figure.panel({"Version of the model", ""}, {"RMSE", scale.unit}, 190.0);
  panel.y_axis.include_zero = true;
  constexpr std::size_t kLongestName = 20;  // static_nonlinearity is whole
  panel.x_axis.categories.push_back(shorten(start, 16));
  std::vector<Bar> bars{
      {0.0, 0.0, first * scale.factor, 0.0, false, Role::muted, display(first * scale.factor, 3)}};
  double last = first;
  bool any_unclaimed = false, any_unsure = false;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const WaterfallStep& s = steps[i];
    constexpr double kNone = 1e-4;  // of the first error: rounding of the fit
    const double change = std::abs(s.after - s.before) < kNone * std::abs(first) ? 0.0 : (s.after - s.before) * scale.factor;
    const bool unsure = s.u > 0.0 && std::abs(s.after - s.before) <= 2.0 * s.u, hollow = !s.claimed || unsure;
    any_unclaimed |= !s.claimed;
    any_unsure |= s.claimed && unsure;
    const std::string text =
        s.u > 0.0 ? typographic_minus(with_uncertainty(change, s.u * scale.factor)) : display(change, 3);
    bars.push_back({static_cast<double>(i) + 1.0, s.before * scale.factor, s.after * scale.factor,
                    s.u * scale.factor, hollow,
                    hollow         ? Role::muted
                    : change < 0.0 ? Role::pass
                                   : Role::fail,
                    text});
    panel.x_axis.categories.push_back(shorten(s.name, kLongestName));
    last = s.after;
  }
  bars.push_back({static_cast<double>(steps.size()) + 1.0, 0.0, last * scale.factor, 0.0, false, Role::model,
                  display(last * scale.factor, 3)});
  panel.x_axis.categories.push_back(shorten(end, 16));
  panel.bars(std::move(bars), false, true);
  if (std::isfinite(noise_floor)) {
    panel.x_axis.high = static_cast<double>(panel.x_axis.categories.size()) + 0.2;
    panel.hline(noise_floor * scale.factor, "noise floor", Role::muted, Dash::dotted);
  }
  figure.summary = "The error goes from " + display(first * scale.factor, 3) + " to " +
                   display(last * scale.factor, 3) + " " + scale.unit + "." + (any_unclaimed ? " A hollow bar " + not_claimed + "." : "") +
                   (any_unsure ? " A hollow bar is within twice its uncertainty." : "");
  return figure;
}

Figure before_after_rows(const std::string& title, const std::vector<BeforeAfter>& rows,
                         const std::string& quantity, const std::string& unit) {
  Figure figure(title, 560.0);
  double most = 0.0;
  for (const BeforeAfter& r : rows)
    for (const double v : {r.before, r.after})
      if (std::isfinite(v)) most = std::max(most, v);
  const Scaled scale = readable_unit(most, unit);
  Panel& panel =
      figure.panel({quantity, scale.unit}, {"Record", ""}, 20.0 * static_cast<double>(rows.size()) + 10.0);
  panel.x_axis.include_zero = true;
  std::vector<double> before, after, floors, y;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const BeforeAfter& r = rows[rows.size() - 1 - i];
    panel.y_axis.categories.push_back(shorten(printable_utf8(r.name), 26));
    y.push_back(static_cast<double>(i));
    before.push_back(r.before * scale.factor);
    after.push_back(r.after * scale.factor);
    floors.push_back(r.floor * scale.factor);
    panel.line({before.back(), after.back()}, {y.back(), y.back()}, {Role::muted, Dash::solid, 1.0});
  }
  panel.points(floors, y, {Role::muted, Dash::solid, 1.0, Marker::square, 4.0}, "noise");
  if (before == after) {
    panel.points(before, y, {Role::firmware, Dash::solid, 1.0, Marker::dot, 6.0}, "error");
    return figure;
  }
  panel.points(before, y, {Role::firmware, Dash::solid, 1.0, Marker::ring, 6.0}, "before");
  panel.points(after, y, {Role::model, Dash::solid, 1.0, Marker::dot, 6.5}, "after");
  return figure;
}

void add_directed(Panel& panel, const std::vector<double>& x, const std::vector<double>& y,
                  const std::vector<double>& direction, double y_reach) {
  constexpr std::size_t kFew = 60, kMostMarks = 800;
  const std::size_t n = std::min(x.size(), y.size());
  const bool split = direction.size() >= n && n > 0;
  double x_low = kAuto, x_high = kAuto, y_low = -y_reach, y_high = y_reach;
  const bool find_y = !(y_reach > 0.0);
  if (find_y) y_low = y_high = kAuto;
  for (std::size_t i = 0; i < n; ++i) {
    if (!std::isfinite(x[i]) || !std::isfinite(y[i])) continue;
    if (!(x_low <= x[i])) x_low = x[i];
    if (!(x_high >= x[i])) x_high = x[i];
    if (find_y && !(y_low <= y[i])) y_low = y[i];
    if (find_y && !(y_high >= y[i])) y_high = y[i];
  }
  if (!std::isfinite(x_low) || !(x_high > x_low) || !(y_high > y_low)) return;
  panel.y_axis.low = y_low;
  panel.y_axis.high = y_high;
  struct Side {
    double sign;
    Role role;
    Marker marker;
    const char *label, *block;
  };
  std::vector<Side> sides = {{1.0, Role::rising, Marker::up, "rising", "\u25b2 rising"},
                             {-1.0, Role::falling, Marker::down, "falling", "\u25bc falling"},
                             {0.0, Role::muted, Marker::dot, "held", "\u25cf held"}};
  if (!split) sides = {{0.0, Role::model, Marker::dot, "", ""}};
  const auto sign_of = [&](std::size_t i) { return !split ? 0.0 : direction[i] > 0.0 ? 1.0 : direction[i] < 0.0 ? -1.0 : 0.0; };
  const double dot = n <= kFew ? 6.0 : 3.0;
  const bool marks = n <= kMostMarks || panel.x_axis.scale == Scale::logarithmic;
  for (const Side& side : sides) {
    std::vector<double> sx, sy;
    for (std::size_t i = 0; i < n; ++i)
      if (sign_of(i) == side.sign) sx.push_back(x[i]), sy.push_back(y[i]);
    if (sx.empty()) continue;
    if (marks) {
      panel.points(std::move(sx), std::move(sy), {side.role, Dash::solid, 1.0, side.marker, side.marker == Marker::dot ? dot : 4.0, 0.75}, side.label);
      continue;
    }
    Density cells{x_low, x_high, y_low, y_high, 64, 36, {}, side.role, side.block};
    cells.count.assign(static_cast<std::size_t>(cells.nx * cells.ny), 0.0);
    for (std::size_t i = 0; i < sx.size(); ++i) {
      const double fx = (sx[i] - x_low) / (x_high - x_low), fy = (sy[i] - y_low) / (y_high - y_low);
      if (!(fx >= 0.0 && fx <= 1.0 && fy >= 0.0 && fy <= 1.0)) continue;  // NaN too
      const int ix = std::min(cells.nx - 1, static_cast<int>(fx * cells.nx)), iy = std::min(cells.ny - 1, static_cast<int>(fy * cells.ny));
      cells.count[static_cast<std::size_t>(iy * cells.nx + ix)] += 1.0;
    }
    panel.density(std::move(cells));
  }
}

void break_at_gaps(std::vector<double>& x, std::initializer_list<std::vector<double>*> y, double least) {
  constexpr double kUsualSteps = 4.0;
  if (x.size() < 4) return;
  std::vector<double> steps;
  for (std::size_t i = 1; i < x.size(); ++i)
    if (const double step = std::abs(x[i] - x[i - 1]); step > 0.0) steps.push_back(step);
  if (steps.empty()) return;
  const double most = std::max(least, kUsualSteps * median(std::move(steps)));
  const std::vector<double> old = x;
  const auto rebuild = [&](std::vector<double>& values, bool of_x) {
    std::vector<double> out;
    for (std::size_t i = 0; i < std::min(values.size(), old.size()); ++i) {
      if (i > 0 && std::abs(old[i] - old[i - 1]) > most) out.push_back(of_x ? 0.5 * (old[i] + old[i - 1]) : kAuto);
      out.push_back(values[i]);
    }
    values = std::move(out);
  };
  rebuild(x, true);
  for (std::vector<double>* values : y) rebuild(*values, false);
}

Scaled readable_unit(double magnitude, const std::string& unit) {
  if (unit == "1") return {100.0, "%"};
  const bool prefixable = unit == "V" || unit == "N" || unit == "s" || unit == "F" || unit == "S" || unit == "A";
  const double size = std::abs(magnitude);
  if (!prefixable || !std::isfinite(size) || size >= 0.2 || size == 0.0) return {1.0, unit};
  if (size >= 2e-4) return {1e3, "m" + unit};
  if (size >= 2e-7) return {1e6, "\u00b5" + unit};
  if (size >= 2e-10) return {1e9, "n" + unit};
  return {1e12, "p" + unit};
}

}  // namespace forcegate::figures
