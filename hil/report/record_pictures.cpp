#include "hil/report/record_pictures.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "hil/base/quantile.h"
#include "hil/report/figures/plots.h"
#include "hil/report/figures/text.h"

namespace forcegate {
namespace {

using namespace figures;

constexpr double kWidth = 560.0;
constexpr std::size_t kMostRings = 60;

double largest(const std::vector<double>& values) {
  double most = 0.0;
  for (const double v : values)
    if (std::isfinite(v)) most = std::max(most, std::abs(v));
  return most;
}

std::vector<double> scaled(std::vector<double> values, double factor) {
  for (double& v : values) v *= factor;
  return values;
}

std::vector<double> difference(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> out;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) out.push_back(a[i] - b[i]);
  return out;
}

// A value over the larger one of the medians of up to 8 values on either side: a slope is no line. 0 within three values of an end.
double above_neighbours(const std::vector<double>& y, std::size_t at) {
  constexpr std::size_t kReach = 8, kFewest = 3;
  if (at < kFewest || at + kFewest >= y.size()) return 0.0;
  const auto side = [&](std::size_t begin, std::size_t end) {
    return median({y.begin() + static_cast<std::ptrdiff_t>(begin), y.begin() + static_cast<std::ptrdiff_t>(end)});
  };
  const double around = std::max(side(at > kReach ? at - kReach : 0, at), side(at + 1, std::min(y.size(), at + kReach + 1)));
  return around > 0.0 ? y[at] / around : 0.0;
}

struct FoldedLine {
  std::size_t at = 0;
  double mains_Hz = 0.0;
  bool folded = false;
  bool near(std::size_t line) const { return line + 2 >= at && at + 2 >= line; }
};

// Where rows show a line of the mains that the samples have, if it stands above what is around it.
std::optional<FoldedLine> folded_mains(const ResidualSpectrum& s) {
  constexpr double kStands = 2.0;
  std::optional<FoldedLine> out;
  if (s.f_Hz.size() < 8 || s.residual.size() != s.f_Hz.size()) return out;
  const double highest_Hz = s.f_Hz.back(), step_Hz = s.f_Hz[1] - s.f_Hz[0];
  double most = kStands;
  for (const double mains_Hz : {50.0, 60.0}) {
    const double rest_Hz = std::fmod(mains_Hz, 2.0 * highest_Hz), at_Hz = rest_Hz > highest_Hz ? 2.0 * highest_Hz - rest_Hz : rest_Hz;
    const auto bin = static_cast<std::ptrdiff_t>(std::lround((at_Hz - s.f_Hz[0]) / step_Hz));
    for (std::ptrdiff_t i = std::max<std::ptrdiff_t>(0, bin - 1); i <= bin + 1 && i < std::ssize(s.f_Hz); ++i)
      if (const double ratio = above_neighbours(s.residual, static_cast<std::size_t>(i)); ratio > most)
        most = ratio, out = FoldedLine{static_cast<std::size_t>(i), mains_Hz, mains_Hz > highest_Hz};
  }
  return out;
}

// Gone: down to a tenth of what it was, or to the noise.
std::string afterwards(const ResidualSpectrum& s, std::size_t line) {
  constexpr double kGone = 0.1, kNoise = 2.0, kAPart = 0.7;
  if (line >= s.after.size()) return {};
  if (s.after[line] < std::max(kGone * s.residual[line], kNoise * s.noise)) return " Afterwards it is gone.";
  return s.after[line] < kAPart * s.residual[line] ? " Afterwards a part of it is left." : " Afterwards it is still there.";
}

void add_line(Panel& panel, std::vector<double> x, std::vector<double> y, Style style, const std::string& label = {}) {
  break_at_gaps(x, {&y});
  panel.line(std::move(x), std::move(y), style, label);
}

}  // namespace

Figure spectrum_figure(const ResidualSpectrum& s, const std::string& unit, bool mains) {
  Figure figure("Spectrum of the residual, record " + s.record, kWidth);
  const Scaled scale = readable_unit(largest(s.residual), unit);
  Axis x{"Frequency", "Hz"}, y{"Amplitude density", scale.unit + "/\u221aHz"};
  x.scale = y.scale = Scale::logarithmic;
  Panel& panel = figure.panel(x, y, 150.0);
  panel.line(s.f_Hz, scaled(s.load, scale.factor), {Role::muted, Dash::solid, 1.0}, "modelled output");
  panel.line(s.f_Hz, scaled(s.residual, scale.factor), {Role::firmware, Dash::solid, 1.2}, s.after.empty() ? "residual" : "residual before");
  if (!s.after.empty()) panel.line(s.f_Hz, scaled(s.after, scale.factor), {Role::model, Dash::solid, 1.2}, "after");
  if (s.noise > 0.0 && !s.f_Hz.empty())  // in the legend: a word beside the line would lie on the curve that it tells of
    panel.line({s.f_Hz.front(), s.f_Hz.back()}, {s.noise * scale.factor, s.noise * scale.factor}, {Role::reference, Dash::dotted, 1.1}, "noise");
  constexpr double kLine = 4.0, kOfTheLoad = 2.0;
  std::size_t line = 0;
  double most = 0.0;
  for (std::size_t i = 1; i < std::min(s.f_Hz.size(), s.residual.size()); ++i)
    if (const double ratio = above_neighbours(s.residual, i); ratio > most) most = ratio, line = i;
  if (const std::optional<FoldedLine> hum = mains ? folded_mains(s) : std::nullopt; hum && (most < kLine || hum->near(line)))
    figure.summary =
        "The line at " + display(s.f_Hz[hum->at], 3) + " Hz is the hum that is claimed: " +
        (hum->folded ? "rows of " + display(500.0 / s.f_Hz.back(), 2) + " ms fold its " + display(hum->mains_Hz, 2) + " Hz there."
                     : "its frequency is as it was recorded.");
  else if (most < kLine)
    figure.summary = "No line stands out of the residual by more than " + display(kLine, 1) + " times what is around it.";
  else
    figure.summary = "The residual has a line at " + display(s.f_Hz[line], 3) + " Hz" +
                     (above_neighbours(s.command.empty() ? s.load : s.command, line) > kOfTheLoad
                          ? std::string(", where the load has one") + (s.command.empty() ? " by its reference, whose steps can be lines too." : ".")
                          : ", where the load has none: a harmonic that the model lacks, mains or a resonance.") +
                     afterwards(s, line);
  return figure;
}

Figure extrema_figure(const ExtremaDecay& e, const std::string& unit) {
  Figure figure("Maxima and minima over time, record " + e.record, kWidth);
  figure.share_x = true;
  const Axis time{"Time in the record", "s"};
  Panel& above = figure.panel(time, {"Output", unit}, 110.0);
  above.show_x_labels = false;
  const std::vector<double> high = difference(e.maxima.measured, e.maxima.modelled), low = difference(e.minima.measured, e.minima.modelled);
  const Scaled scale = readable_unit(std::max(largest(high), largest(low)), unit);
  const bool both = !e.maxima.after.empty();
  Panel& below = figure.panel(time, {"Measured \u2212 model", scale.unit}, 90.0);
  below.hline(0.0);
  const auto model = [&](const std::vector<double>& t_s, const std::vector<double>& y, Role role, const std::string& label) {
    if (t_s.size() <= kMostRings)
      above.points(t_s, y, {role, Dash::solid, 1.0, Marker::ring, 6.0}, label);
    else
      add_line(above, t_s, y, {role, Dash::dashed, 1.1}, label);
  };
  const auto add = [&](const TurningSeries& s, const std::vector<double>& error, Role role, Marker marker, const std::string& label) {
    const bool first = marker == Marker::up;
    // two colours: before and after; the marks tell maxima from minima
    model(s.t_s, s.modelled, both ? Role::firmware : Role::model, !first ? "" : both ? "model before" : "model");
    if (both) model(s.t_s, s.after, Role::model, first ? "after" : "");
    above.points(s.t_s, s.measured, {both ? Role::reference : role, Dash::solid, 1.0, marker, 5.0, 0.8}, label);
    below.points(s.t_s, scaled(error, scale.factor), {both ? Role::firmware : role, Dash::solid, 1.0, marker, 6.0, 0.8}, label + (both ? " before" : ""));
    if (both) below.points(s.t_s, scaled(difference(s.measured, s.after), scale.factor), {Role::model, Dash::solid, 1.0, marker, 6.0, 0.8}, label + " after");
  };
  add(e.maxima, high, Role::rising, Marker::up, "maxima");
  add(e.minima, low, Role::falling, Marker::down, "minima");
  figure.summary = std::string("What one law of the decay leaves at the turning points of the force") +
                   (both ? ", before and after the effects were taken in." : ".") +
                   " The record has its own gain and zero here, but not its own decay, which the errors above let follow the data: they are smaller.";
  return figure;
}

Figure levels_figure(const RecordPictures& p) {
  Figure figure(p.levels_over_time ? "Level of every record over the campaign" : "Level of every record in its order", 760.0);
  std::vector<double> x, zero, u_zero, gain, u_gain, reference, u_reference;
  double last_s = 0.0;
  for (const RecordLevel& level : p.levels) last_s = std::max(last_s, level.start_s);
  const bool hours = last_s > 7200.0;
  const Axis axis = p.levels_over_time ? Axis{"Start in campaign time", hours ? "h" : "min"} : Axis{"Record, in order", "1"};
  for (std::size_t k = 0; k < p.levels.size(); ++k) {
    const RecordLevel& level = p.levels[k];
    x.push_back(p.levels_over_time ? level.start_s / (hours ? 3600.0 : 60.0) : static_cast<double>(k) + 1.0);
    zero.push_back(level.zero), u_zero.push_back(2.0 * level.u_zero);
    gain.push_back(level.gain_pct), u_gain.push_back(2.0 * level.u_gain_pct);
    reference.push_back(level.reference_N), u_reference.push_back(2.0 * level.u_reference_N);
  }
  const auto known = [](const std::vector<double>& y) { return std::ranges::count_if(y, [](double v) { return std::isfinite(v); }) >= 3; };
  const auto add = [&](std::vector<double> y, std::vector<double> U, const std::string& quantity, const std::string& unit) {
    if (!known(y)) return;
    const Scaled scale = readable_unit(std::max(largest(y), largest(U)), unit);  // its whiskers are read too
    Panel& panel = figure.panel(axis, {quantity, scale.unit}, 120.0);
    panel.hline(0.0).points(x, scaled(std::move(y), scale.factor), {Role::firmware, Dash::solid, 1.0, Marker::dot, 5.0}, "",
                            scaled(std::move(U), scale.factor));
  };
  add(std::move(zero), std::move(u_zero), "Mean residual", p.unit);
  add(std::move(gain), std::move(u_gain), "Departure of the gain", "%");
  add(std::move(reference), std::move(u_reference), "Reference \u2212 rig law", "N");
  figure.columns = static_cast<int>(std::clamp<std::size_t>(figure.panels().size(), 1, 2));
  figure.summary = "One gain and zero for all records would put every point on the dashed line within its whisker (U, k = 2, from tenths of the record).";
  return figure;
}

Figure drift_figure(const DriftCourse& c, const std::string& unit) {
  Figure figure("Drift of the output, record " + c.record, kWidth);
  figure.share_x = true;
  const Axis time{"Time in the record", "s"};
  Panel& above = figure.panel(time, {"Output", unit}, 120.0);
  above.show_x_labels = false;
  add_line(above, c.t_s, c.measured, {Role::reference}, "measured, means of blocks");
  add_line(above, c.t_s, c.modelled, {Role::model, Dash::dashed, 1.4}, "law of time: " + c.form);
  const std::vector<double> rest = difference(c.measured, c.modelled);
  const Scaled scale = readable_unit(largest(rest), unit);
  Panel& below = figure.panel(time, {"Measured \u2212 law", scale.unit}, 80.0);
  below.hline(0.0).points(c.t_s, scaled(rest, scale.factor), {Role::firmware, Dash::solid, 0.8, Marker::dot, 3.0}, "",
                          std::vector<double>(rest.size(), 2.0 * c.noise * scale.factor));
  figure.summary = "Whiskers are U of a block mean, k = 2.";
  return figure;
}

}  // namespace forcegate
