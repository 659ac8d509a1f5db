#include "hil/report/case_figures.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "hil/base/text.h"
#include "hil/report/figures/decimate.h"
#include "hil/report/figures/text.h"
#include "hil/report/judged.h"

namespace forcegate {
namespace {

using namespace figures;

constexpr double kWidth = 560.0;

struct Signals {
  const PlotTrace *setpoint, *ati, *firmware, *raw;
  std::string reference;  ///< name of what the firmware is held against: the ATI, or weights
};

Signals signals_of(const std::vector<PlotTrace>& traces) {
  const PlotTrace* const weights = find_trace(traces, "weights");
  return {find_trace(traces, "set-point"), weights != nullptr ? weights : find_trace(traces, "ATI"),
          find_trace(traces, "firmware"), find_trace(traces, "raw"), weights != nullptr ? "weights" : "ATI"};
}

struct ErrorTrace {
  PlotTrace trace;
  std::string label;
  Role role;
};

// Open loop: what the firmware says against the ATI. Closed loop: what the ATI feels against the set-point,
// too.
std::vector<ErrorTrace> errors_of(const CaseResult& c, const Signals& s) {
  std::vector<ErrorTrace> out;
  if (c.loop == "closed" && s.ati && s.setpoint)
    out.push_back({difference(*s.ati, *s.setpoint), "ATI \u2212 set-point", Role::reference});
  if (s.firmware && s.ati)
    out.push_back({difference(*s.firmware, *s.ati), "firmware \u2212 " + s.reference, Role::firmware});
  return out;
}

std::string largest_error_sentence(const std::vector<ErrorTrace>& errors) {
  std::string out;
  for (const ErrorTrace& e : errors) {
    double worst = 0.0, at = 0.0;
    for (std::size_t i = 0; i < e.trace.value.size(); ++i)
      if (std::abs(e.trace.value[i]) > std::abs(worst)) worst = e.trace.value[i], at = e.trace.t_s[i];
    out += e.label + ": largest " + display(worst, 2) + " N at " + display(at, 6) + " s. ";
  }
  return out;
}

struct Envelope {
  std::vector<double> t, low, high;
};

Envelope envelope(const PlotTrace& trace, int columns) {
  Envelope out;
  if (trace.t_s.empty()) return out;
  const double first = trace.t_s.front(), width = trace.t_s.back() - first;
  if (!(width > 0.0)) return out;
  std::map<int, std::pair<double, double>> cells;
  for (std::size_t i = 0; i < trace.t_s.size(); ++i) {
    const double f = (trace.t_s[i] - first) / width;
    if (!std::isfinite(trace.value[i]) || !(f >= 0.0 && f <= 1.0)) continue;
    const int column = std::min(columns - 1, static_cast<int>(f * columns));
    const double v = trace.value[i];
    const auto [at, added] = cells.try_emplace(column, v, v);
    if (!added) at->second = {std::min(at->second.first, v), std::max(at->second.second, v)};
  }
  for (const auto& [column, range] : cells) {
    out.t.push_back(first + (column + 0.5) / columns * width);
    out.low.push_back(range.first);
    out.high.push_back(range.second);
  }
  return out;
}

}  // namespace

const PlotTrace* find_trace(const std::vector<PlotTrace>& traces, std::string_view name) {
  for (const PlotTrace& t : traces)
    if (t.name == name && !t.t_s.empty() && t.t_s.size() == t.value.size()) return &t;
  return nullptr;
}

PlotTrace difference(const PlotTrace& actual, const PlotTrace& expected) {
  PlotTrace out{"error", actual.unit, actual.t_s, actual.value};
  std::size_t k = 0;
  for (std::size_t i = 0; i < out.t_s.size(); ++i) {
    const float t = out.t_s[i];
    while (k + 2 < expected.t_s.size() && expected.t_s[k + 1] <= t) ++k;
    float other = expected.value.empty() ? NAN : expected.value[k];
    if (k + 1 < expected.t_s.size() && t > expected.t_s[k]) {
      const float step = expected.t_s[k + 1] - expected.t_s[k];
      const float f = step > 0.0f ? std::min(1.0f, (t - expected.t_s[k]) / step) : 1.0f;
      other += f == 1.0f ? expected.value[k + 1] - expected.value[k]
                         : f * (expected.value[k + 1] - expected.value[k]);
    }
    out.value[i] -= other;
  }
  return out;
}

Figure window_figure(const CaseResult& c) {
  Figure figure("Force over chosen cycles of " + c.id, kWidth);
  const Signals s = signals_of(c.window);
  if (s.ati == nullptr && s.firmware == nullptr) return figure;
  figure.share_x = true;
  Panel& force = figure.panel({"", ""}, {"Force", "N"}, 170.0);
  if (s.ati) force.line(doubles(s.ati->t_s), doubles(s.ati->value), {Role::reference}, s.reference);
  if (s.firmware)
    force.line(doubles(s.firmware->t_s), doubles(s.firmware->value), {Role::firmware}, "firmware");
  if (s.setpoint)
    force.line(doubles(s.setpoint->t_s), doubles(s.setpoint->value), {Role::setpoint, Dash::dashed},
               "set-point");
  force.show_x_labels = false;
  const std::vector<ErrorTrace> errors = errors_of(c, s);
  Panel& error = figure.panel({"Time", "s"}, {"Error", "N"}, 78.0);
  error.hline(0.0);
  error.y_axis.symmetric = true;
  for (const ErrorTrace& e : errors)
    error.line(doubles(e.trace.t_s), doubles(e.trace.value), {e.role, Dash::solid, 1.1}, e.label);
  figure.summary = largest_error_sentence(errors);
  return figure;
}

Figure overview_figure(const CaseResult& c) {
  Figure figure("Whole record of " + c.id, kWidth);
  const Signals s = signals_of(c.overview);
  if (s.ati == nullptr && s.firmware == nullptr) return figure;
  figure.share_x = true;
  constexpr int kColumns = 120;
  const bool fast = c.facts.lowest_frequency_Hz * c.duration_s > 40.0;
  Panel& force = figure.panel({"", ""}, {fast ? "Force, span of the cycles" : "Force", "N"}, 170.0);
  force.show_x_labels = false;
  const auto edges = [&](const PlotTrace* trace, Role role, const std::string& label, double width) {
    if (trace == nullptr) return;
    const Envelope e = envelope(*trace, kColumns);
    force.line(e.t, e.high, {role, Dash::solid, width}, label);
    force.line(e.t, e.low, {role, Dash::solid, width});
  };
  if (fast) {
    if (s.ati) {
      const Envelope e = envelope(*s.ati, kColumns);
      force.band(e.t, e.low, e.high, Role::muted, s.reference, 0.28);
    }
    edges(s.raw, Role::raw, "raw sensor", 1.1);
    edges(s.firmware, Role::firmware, "firmware", 1.4);
  } else {
    if (s.raw)
      force.line(doubles(s.raw->t_s), doubles(s.raw->value), {Role::raw, Dash::solid, 1.0}, "raw sensor");
    if (s.ati)
      force.line(doubles(s.ati->t_s), doubles(s.ati->value), {Role::reference, Dash::solid, 1.2},
                 s.reference);
    if (s.firmware)
      force.line(doubles(s.firmware->t_s), doubles(s.firmware->value), {Role::firmware, Dash::solid, 1.0},
                 "firmware");
  }
  const std::vector<ErrorTrace> errors = errors_of(c, s);
  Panel& error = figure.panel({"Time", "s"}, {"Error", "N"}, 78.0);
  for (Panel* panel : {&force, &error}) panel->x_axis.low = 0.0, panel->x_axis.high = c.duration_s;
  for (const ErrorTrace& e : errors) {
    if (e.trace.t_s.size() < 3 * kColumns) {
      error.line(doubles(e.trace.t_s), doubles(e.trace.value), {e.role, Dash::solid, 1.1}, e.label);
      continue;
    }
    const Envelope span = envelope(e.trace, kColumns);
    error.band(span.t, span.low, span.high, e.role, e.label, errors.size() > 1 ? 0.5 : 0.75);
  }
  error.hline(0.0);
  figure.summary = largest_error_sentence(errors);
  return figure;
}

const ExtremaSeries* levels_of(const CaseResult& c) {
  for (const ExtremaSeries& e : c.extrema)
    if (e.name == "levels" && e.raw_N.size() == e.expected_N.size() &&
        e.actual_N.size() == e.expected_N.size())
      return &e;
  return nullptr;
}

Figure levels_figure(const CaseResult& c) {
  Figure figure("Error over force of " + c.id, kWidth);
  const ExtremaSeries* levels = levels_of(c);
  if (levels == nullptr) return figure;
  std::vector<double> force_N, own_N, model_N;
  double own = 0.0, model = 0.0;
  for (std::size_t i = 0; i < levels->expected_N.size(); ++i) {
    force_N.push_back(levels->expected_N[i]);
    own_N.push_back(levels->actual_N[i] - levels->expected_N[i]);
    model_N.push_back(levels->raw_N[i] - levels->expected_N[i]);
    if (std::abs(own_N.back()) > std::abs(own)) own = own_N.back();
    if (std::abs(model_N.back()) > std::abs(model)) model = model_N.back();
  }
  Panel& panel = figure.panel({"Weights", "N"}, {"Error", "N"}, 254.0);
  panel.hline(0.0);
  panel.points(force_N, model_N, {Role::raw, Dash::solid, 1.0, Marker::ring, 3.4}, "conductance model");
  panel.points(force_N, own_N, {Role::firmware, Dash::solid, 1.0, Marker::dot, 3.0}, "firmware");
  figure.summary =
      "Largest: firmware " + display(own, 2) + " N, conductance model " + display(model, 2) + " N.";
  return figure;
}

Figure decay_figure(const CaseResult& c) {
  Figure figure("Extrema of " + c.id + " over time", kWidth);
  if (levels_of(c) != nullptr) return figure;
  const bool closed = c.loop == "closed";
  bool any = false;
  for (const ExtremaSeries& e : c.extrema) any |= !e.t_s.empty();
  if (!any) return figure;
  figure.share_x = true;
  Panel& force = figure.panel({"", ""}, {"Extrema", "N"}, 170.0);
  force.show_x_labels = false;
  Panel& error = figure.panel({"Time", "s"}, {"Error", "% of reading"}, 78.0);
  error.hline(0.0);
  for (Panel* panel : {&force, &error}) panel->x_axis.low = 0.0, panel->x_axis.high = c.duration_s;
  double end_s = 0.0, loss_first = NAN, loss_last = NAN;
  for (const ExtremaSeries& e : c.extrema) {
    const std::size_t n = std::min({e.t_s.size(), e.expected_N.size(), e.actual_N.size()});
    const bool maxima = e.name == "maxima";
    const bool has_raw = maxima && e.raw_N.size() >= n;  // the raw minima hold and would only hide the others
    const std::vector<double> t(e.t_s.begin(), e.t_s.begin() + static_cast<std::ptrdiff_t>(n));
    const std::vector<double> actual = doubles(e.actual_N), expected = doubles(e.expected_N),
                              raw = doubles(e.raw_N);
    std::vector<double> difference_N(n);
    for (std::size_t i = 0; i < n; ++i) difference_N[i] = actual[i] - expected[i];
    const std::span<const double> channel = difference_N;
    std::vector<double> pt, pe, pa, pr, px;
    std::vector<std::size_t> keep = m4_indices(t, {&channel, 1}, 18);
    for (std::size_t i = 1; i < std::min<std::size_t>(n, 20); ++i)
      keep.push_back(i);  // where the decay is steep
    std::sort(keep.begin(), keep.end());
    keep.erase(std::unique(keep.begin(), keep.end()), keep.end());
    for (const std::size_t i : keep) {
      pt.push_back(t[i]);
      pe.push_back(expected[i]);
      pa.push_back(actual[i]);
      if (has_raw) pr.push_back(raw[i]);
      px.push_back(std::abs(expected[i]) >= 0.5 ? 100.0 * (actual[i] - expected[i]) / std::abs(expected[i])
                                                : NAN);
    }
    if (pt.empty()) continue;
    end_s = std::max(end_s, pt.back());
    const auto label = [&](const char* name) { return maxima ? std::string(name) : std::string(); };
    const Marker shape = maxima ? Marker::dot : Marker::ring;
    const double size = maxima ? 2.6 : 3.4;
    if (has_raw) force.points(pt, pr, {Role::raw, Dash::solid, 1.0, shape, size}, label("raw sensor"));
    force.points(pt, pe, {closed ? Role::setpoint : Role::reference, Dash::solid, 1.0, shape, size},
                 label(closed ? "set-point" : "ATI"));
    force.points(pt, pa, {closed ? Role::reference : Role::firmware, Dash::solid, 1.0, shape, size},
                 label(closed ? "ATI" : "firmware"));
    error.points(pt, px, {closed ? Role::reference : Role::firmware, Dash::solid, 1.0, shape, size}, e.name);
    if (maxima && has_raw) loss_first = pr.front(), loss_last = pr.back();
  }
  if (c.decay.valid) {
    std::vector<double> t, fit;
    const double start = c.facts.excitation_start_s;
    for (int i = 0; i <= 120; ++i) {
      t.push_back(start + (end_s - start) * i / 120.0);
      const double volts =
          c.decay.u_min_V + c.decay.c_V + c.decay.a_V * std::exp(-c.decay.b_per_s * (t.back() - start));
      fit.push_back(c.calibration.gain_N_per_V * volts + c.calibration.offset_N);
    }
    force.line(t, fit, {Role::model, Dash::dashed, 1.6}, "fit of eq. (3)");
    figure.summary =
        "Decay rate b = " + typographic_minus(with_uncertainty(c.decay.b_per_s, c.decay.u_b_per_s)) +
        " 1/s; the raw sensor loses " + display(c.decay.loss_pct, 3) + " % of the span of its maxima.";
  } else if (std::isfinite(loss_first)) {
    figure.summary =
        "The raw maxima go from " + display(loss_first, 3) + " N to " + display(loss_last, 3) + " N.";
  }
  return figure;
}

Figure loop_figure(const CaseResult& c) {
  Figure figure("Error over force in the window of " + c.id, kWidth);
  const Signals s = signals_of(c.window);
  const bool closed = c.loop == "closed";
  const PlotTrace* expected = closed ? s.setpoint : s.ati;
  const PlotTrace* actual = closed ? s.ati : s.firmware;
  if (expected == nullptr || actual == nullptr || expected->value.size() != actual->value.size())
    return figure;
  const PlotTrace error = difference(*actual, *expected);
  const std::vector<float>& direction =
      s.setpoint && s.setpoint->value.size() == error.value.size() ? s.setpoint->value : expected->value;
  const std::size_t n = error.value.size(), reach = std::max<std::size_t>(1, n / 400);
  float x_low = INFINITY, x_high = -INFINITY, e_low = 0.0f, e_high = 0.0f;
  for (std::size_t i = 0; i < n; ++i) {
    if (!std::isfinite(error.value[i]) || !std::isfinite(expected->value[i])) continue;
    x_low = std::min(x_low, expected->value[i]);
    x_high = std::max(x_high, expected->value[i]);
    e_low = std::min(e_low, error.value[i]);
    e_high = std::max(e_high, error.value[i]);
  }
  if (!(x_high > x_low)) return figure;
  const double margin = std::max(1e-3, 0.04 * (e_high - e_low));
  Density rising{x_low, x_high, e_low - margin, e_high + margin, 46, 30, {}, Role::rising, "\u25b2 rising"};
  rising.count.assign(static_cast<std::size_t>(rising.nx * rising.ny), 0.0);
  Density falling = rising;
  falling.role = Role::falling;
  falling.label = "\u25bc falling";
  for (std::size_t i = reach; i + reach < n; ++i) {
    if (!std::isfinite(error.value[i]) || !std::isfinite(expected->value[i])) continue;
    const double fx = (expected->value[i] - rising.x_low) / (rising.x_high - rising.x_low);
    const double fy = (error.value[i] - rising.y_low) / (rising.y_high - rising.y_low);
    if (!(fx >= 0.0 && fx <= 1.0 && fy >= 0.0 && fy <= 1.0)) continue;
    const int ix = std::min(static_cast<int>(fx * rising.nx), rising.nx - 1),
              iy = std::min(static_cast<int>(fy * rising.ny), rising.ny - 1);
    Density& side = direction[i + reach] >= direction[i - reach] ? rising : falling;
    side.count[static_cast<std::size_t>(iy * rising.nx + ix)] += 1.0;
  }
  Panel& panel = figure.panel({closed ? "Set-point" : "ATI", "N"},
                              {closed ? "ATI \u2212 set-point" : "Firmware \u2212 ATI", "N"}, 254.0);
  panel.density(std::move(rising)).density(std::move(falling)).hline(0.0);
  figure.summary =
      "A closed loop between rising and falling force means lag or hysteresis; a slope means a gain error.";
  return figure;
}

Figure ratio_figure(const RunResult& result) {
  Figure figure("Every check against its limit", kWidth);
  std::vector<std::string> ids;
  const std::vector<JudgedRow> rows = judged_rows(result);
  for (const JudgedRow& r : rows)
    if (!std::isnan(r.ratio) && std::find(ids.begin(), ids.end(), r.check->id) == ids.end())
      ids.push_back(r.check->id);
  if (ids.empty()) return figure;
  constexpr double kEdge = 2.0;
  struct Marks {
    std::vector<double> x, y;
  };
  Marks pass, look, fail, beyond;
  std::map<std::string, int> seen;
  std::size_t passed = 0, undecided = 0, failed = 0, not_drawn = 0;  // required ones
  for (const JudgedRow& r : rows) {
    if (r.check->required) {
      ++(r.check->verdict == Verdict::pass ? passed : r.check->verdict == Verdict::fail ? failed : undecided);
      not_drawn += std::isnan(r.ratio) ? 1 : 0;
    }
    if (std::isnan(r.ratio)) continue;
    const auto row = static_cast<double>(ids.end() - std::find(ids.begin(), ids.end(), r.check->id) - 1);
    static constexpr double kJitter[] = {0.0, 0.13, -0.13, 0.26, -0.26};
    const double jitter = kJitter[seen[r.check->id]++ % 5];
    Marks& m = r.check->verdict == Verdict::pass   ? pass
               : r.check->verdict != Verdict::fail ? look
               : r.ratio > kEdge                   ? beyond
                                                   : fail;
    m.x.push_back(std::min(r.ratio, kEdge));
    m.y.push_back(row + jitter);
  }
  std::vector<std::string> names;
  for (auto it = ids.rbegin(); it != ids.rend(); ++it) names.push_back(shorten(printable_utf8(*it), 30));
  Panel& panel = figure.panel({"Value over limit (above 2 at the edge)", ""}, {"", ""},
                              26.0 * static_cast<double>(ids.size()) + 8.0);
  panel.y_axis.categories = std::move(names);
  panel.x_axis.low = 0.0;
  panel.x_axis.high = kEdge + 0.04;
  panel.vline(1.0, "", Role::reference, Dash::solid);
  panel.points(pass.x, pass.y, {Role::pass, Dash::solid, 1.0, Marker::dot, 5.5}, "pass");
  if (!look.x.empty())
    panel.points(look.x, look.y, {Role::warn, Dash::solid, 1.0, Marker::square, 5.5},
                 "marginal or not decided");
  if (!fail.x.empty() || !beyond.x.empty())
    panel.points(fail.x, fail.y, {Role::fail, Dash::solid, 1.0, Marker::cross, 7.0}, "fail");
  if (!beyond.x.empty()) panel.points(beyond.x, beyond.y, {Role::fail, Dash::solid, 1.0, Marker::cross, 7.0});
  figure.summary = "Of the required checks " + std::to_string(passed) + " pass, " + std::to_string(undecided) +
                   " are marginal or not decided, " + std::to_string(failed) + " fail" +
                   (not_drawn > 0 ? "; " + std::to_string(not_drawn) + " have no ratio and are not drawn." : ".");
  return figure;
}

}  // namespace forcegate
