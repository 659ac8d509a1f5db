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
  std::vector<double> t_s, low, high;
};

Envelope envelope(const PlotTrace& trace, int columns) {
  Envelope out;
  if (trace.t_s.empty()) return out;
  const double first = trace.t_s.front(), width = trace.t_s.back() - first;
  if (!(width > 0.0)) return out;
  std::map<int, std::pair<double, double>> cells;
  for (std::size_t i = 0; i < trace.t_s.size(); ++i) {
    const double along = (trace.t_s[i] - first) / width;
    if (!std::isfinite(trace.value[i]) || !(along >= 0.0 && along <= 1.0)) continue;
    const int column = std::min(columns - 1, static_cast<int>(along * columns));
    const double value = trace.value[i];
    const auto [at, added] = cells.try_emplace(column, value, value);
    if (!added) at->second = {std::min(at->second.first, value), std::max(at->second.second, value)};
  }
  for (const auto& [column, range] : cells) {
    out.t_s.push_back(first + (column + 0.5) / columns * width);
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
    const float t_s = out.t_s[i];
    while (k + 2 < expected.t_s.size() && expected.t_s[k + 1] <= t_s) ++k;
    float other = expected.value.empty() ? NAN : expected.value[k];
    if (k + 1 < expected.t_s.size() && t_s > expected.t_s[k]) {
      const float step_s = expected.t_s[k + 1] - expected.t_s[k], change = expected.value[k + 1] - expected.value[k];
      const float share = step_s > 0.0f ? std::min(1.0f, (t_s - expected.t_s[k]) / step_s) : 1.0f;
      other += share == 1.0f ? change : share * change;
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
    const Envelope span = envelope(*trace, kColumns);
    force.line(span.t_s, span.high, {role, Dash::solid, width}, label);
    force.line(span.t_s, span.low, {role, Dash::solid, width});
  };
  if (fast) {
    if (s.ati) {
      const Envelope span = envelope(*s.ati, kColumns);
      force.band(span.t_s, span.low, span.high, Role::muted, s.reference, 0.28);
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
    error.band(span.t_s, span.low, span.high, e.role, e.label, errors.size() > 1 ? 0.5 : 0.75);
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
  double worst_own_N = 0.0, worst_model_N = 0.0;
  for (std::size_t i = 0; i < levels->expected_N.size(); ++i) {
    force_N.push_back(levels->expected_N[i]);
    own_N.push_back(levels->actual_N[i] - levels->expected_N[i]);
    model_N.push_back(levels->raw_N[i] - levels->expected_N[i]);
    if (std::abs(own_N.back()) > std::abs(worst_own_N)) worst_own_N = own_N.back();
    if (std::abs(model_N.back()) > std::abs(worst_model_N)) worst_model_N = model_N.back();
  }
  Panel& panel = figure.panel({"Weights", "N"}, {"Error", "N"}, 254.0);
  panel.hline(0.0);
  panel.points(force_N, model_N, {Role::raw, Dash::solid, 1.0, Marker::ring, 3.4}, "conductance model");
  panel.points(force_N, own_N, {Role::firmware, Dash::solid, 1.0, Marker::dot, 3.0}, "firmware");
  figure.summary =
      "Largest: firmware " + display(worst_own_N, 2) + " N, conductance model " + display(worst_model_N, 2) + " N.";
  return figure;
}

namespace {

struct DrawnExtrema {
  std::vector<double> t_s, expected_N, actual_N, raw_N, error_pct;
};

// The outline of the error, and all extrema where the decay is steep.
std::vector<std::size_t> drawn_indices(const std::vector<double>& t_s, const std::vector<double>& expected_N,
                                       const std::vector<double>& actual_N) {
  constexpr std::size_t kColumns = 18, kSteep = 20;
  std::vector<double> error_N(t_s.size());
  for (std::size_t i = 0; i < t_s.size(); ++i) error_N[i] = actual_N[i] - expected_N[i];
  const std::span<const double> channel = error_N;
  std::vector<std::size_t> out = m4_indices(t_s, {&channel, 1}, kColumns);
  for (std::size_t i = 1; i < std::min(t_s.size(), kSteep); ++i) out.push_back(i);
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

}  // namespace

Figure decay_figure(const CaseResult& c) {
  constexpr double kLeastReading_N = 0.5;  // no error in percent of less
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
  double end_s = 0.0, loss_first_N = NAN, loss_last_N = NAN;  // raw maxima
  for (const ExtremaSeries& e : c.extrema) {
    const std::size_t n = std::min({e.t_s.size(), e.expected_N.size(), e.actual_N.size()});
    const bool maxima = e.name == "maxima";
    const bool has_raw = maxima && e.raw_N.size() >= n;  // the raw minima hold and would only hide the others
    const std::vector<double> actual_N = doubles(e.actual_N), expected_N = doubles(e.expected_N), raw_N = doubles(e.raw_N);
    DrawnExtrema drawn;
    for (const std::size_t i : drawn_indices({e.t_s.begin(), e.t_s.begin() + static_cast<std::ptrdiff_t>(n)}, expected_N, actual_N)) {
      const double error_N = actual_N[i] - expected_N[i], reading_N = std::abs(expected_N[i]);
      drawn.t_s.push_back(e.t_s[i]);
      drawn.expected_N.push_back(expected_N[i]);
      drawn.actual_N.push_back(actual_N[i]);
      if (has_raw) drawn.raw_N.push_back(raw_N[i]);
      drawn.error_pct.push_back(reading_N >= kLeastReading_N ? 100.0 * error_N / reading_N : NAN);
    }
    if (drawn.t_s.empty()) continue;
    end_s = std::max(end_s, drawn.t_s.back());
    const auto label = [&](const char* name) { return maxima ? std::string(name) : std::string(); };
    const Marker shape = maxima ? Marker::dot : Marker::ring;
    const double size = maxima ? 2.6 : 3.4;
    if (has_raw) force.points(drawn.t_s, drawn.raw_N, {Role::raw, Dash::solid, 1.0, shape, size}, label("raw sensor"));
    force.points(drawn.t_s, drawn.expected_N, {closed ? Role::setpoint : Role::reference, Dash::solid, 1.0, shape, size},
                 label(closed ? "set-point" : "ATI"));
    force.points(drawn.t_s, drawn.actual_N, {closed ? Role::reference : Role::firmware, Dash::solid, 1.0, shape, size},
                 label(closed ? "ATI" : "firmware"));
    error.points(drawn.t_s, drawn.error_pct, {closed ? Role::reference : Role::firmware, Dash::solid, 1.0, shape, size}, e.name);
    if (maxima && has_raw) loss_first_N = drawn.raw_N.front(), loss_last_N = drawn.raw_N.back();
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
  } else if (std::isfinite(loss_first_N)) {
    figure.summary =
        "The raw maxima go from " + display(loss_first_N, 3) + " N to " + display(loss_last_N, 3) + " N.";
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
  float force_low = INFINITY, force_high = -INFINITY, error_low = 0.0f, error_high = 0.0f;
  for (std::size_t i = 0; i < n; ++i) {
    if (!std::isfinite(error.value[i]) || !std::isfinite(expected->value[i])) continue;
    force_low = std::min(force_low, expected->value[i]);
    force_high = std::max(force_high, expected->value[i]);
    error_low = std::min(error_low, error.value[i]);
    error_high = std::max(error_high, error.value[i]);
  }
  if (!(force_high > force_low)) return figure;
  const double margin = std::max(1e-3, 0.04 * (error_high - error_low));
  Density rising{force_low, force_high, error_low - margin, error_high + margin, 46, 30, {}, Role::rising, "\u25b2 rising"};
  rising.count.assign(static_cast<std::size_t>(rising.nx * rising.ny), 0.0);
  Density falling = rising;
  falling.role = Role::falling;
  falling.label = "\u25bc falling";
  for (std::size_t i = reach; i + reach < n; ++i) {
    if (!std::isfinite(error.value[i]) || !std::isfinite(expected->value[i])) continue;
    const double across = (expected->value[i] - rising.x_low) / (rising.x_high - rising.x_low);
    const double up = (error.value[i] - rising.y_low) / (rising.y_high - rising.y_low);
    if (!(across >= 0.0 && across <= 1.0 && up >= 0.0 && up <= 1.0)) continue;
    const int column = std::min(static_cast<int>(across * rising.nx), rising.nx - 1),
              row = std::min(static_cast<int>(up * rising.ny), rising.ny - 1);
    Density& branch = direction[i + reach] >= direction[i - reach] ? rising : falling;
    branch.count[static_cast<std::size_t>(row * rising.nx + column)] += 1.0;
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
    Marks& marks = r.check->verdict == Verdict::pass   ? pass
                   : r.check->verdict != Verdict::fail ? look
                   : r.ratio > kEdge                   ? beyond
                                                       : fail;
    marks.x.push_back(std::min(r.ratio, kEdge));
    marks.y.push_back(row + jitter);
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
