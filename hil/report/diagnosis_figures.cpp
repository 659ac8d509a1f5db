#include "hil/report/diagnosis_figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "hil/base/text.h"
#include "hil/report/figures/plots.h"
#include "hil/report/figures/text.h"

namespace forcegate {
namespace {

using namespace figures;

constexpr double kWidth = 560.0, kMapWidth = 640.0;
constexpr int kBlocksNeeded = 3;

bool spans_decades(const std::vector<double>& x) {
  double low = INFINITY, high = 0.0;
  for (const double v : x) {
    if (std::isnan(v)) continue;
    if (v <= 0.0) return false;
    low = std::min(low, v);
    high = std::max(high, v);
  }
  return high > 50.0 * low;
}

/// 99 % quantile of |y| times 1.15: one wild sample must not flatten the picture; what lies beyond is
/// clipped.
double reach_of(const EvidenceSeries& s) {
  std::vector<double> size;
  for (const std::vector<double>* y : {&s.before, &s.after})
    for (const double v : *y)
      if (std::isfinite(v)) size.push_back(std::abs(v));
  if (size.empty()) return 0.0;
  const std::size_t at = std::min(size.size() - 1, size.size() * 99 / 100);
  std::nth_element(size.begin(), size.begin() + static_cast<std::ptrdiff_t>(at), size.end());
  return 1.15 * size[at];
}

std::vector<double> scaled(const std::vector<double>& values, double factor) {
  std::vector<double> out = values;
  for (double& v : out) v *= factor;
  return out;
}

// The engine's words begin in lower case, an axis does not; a temperature is in degrees.
std::string capitalised(std::string text) {
  if (!text.empty()) text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
  return text;
}
std::string shown_unit(const std::string& unit) { return unit == "degC" ? "\u00b0C" : unit; }

// Cells hold equal shares of the rows, so that a coordinate which mostly stands still has nearly all of them at one place.
void spread_crowded(const std::vector<MapCell>& cells, Axis& axis) {
  constexpr double kNear = 0.02, kCrowded = 0.4;  // of the range; of the gaps
  std::vector<double> x;
  for (const MapCell& c : cells)
    if (c.n > 0) x.push_back(c.x);
  std::ranges::sort(x);
  if (x.size() < 5 || !(x.back() > x.front())) return;
  std::size_t near = 0;
  for (std::size_t i = 1; i < x.size(); ++i) near += x[i] - x[i - 1] < kNear * (x.back() - x.front()) ? 1 : 0;
  if (static_cast<double>(near) < kCrowded * static_cast<double>(x.size() - 1)) return;
  if (spans_decades(x)) {
    axis.scale = Scale::logarithmic;
    return;
  }
  constexpr double kLeast = 1e-4;  // of the largest: nearer to zero is none
  std::vector<double> size;
  for (const double v : x) size.push_back(std::abs(v));
  std::ranges::sort(size);
  axis.scale = Scale::symmetric_log;
  axis.linear_within = std::max(0.5 * size[size.size() / 2], kLeast * size.back());
}

// Of the values of a coordinate: no sensor conducts a siemens.
Scaled scale_of_coordinate(const ResidualMap& m) {
  if (m.unit != "S") return {1.0, shown_unit(m.unit)};
  double most = 0.0;
  for (const MapCell& c : m.cells)
    if (c.n > 0) most = std::max(most, std::abs(c.x));
  return readable_unit(most, m.unit);
}

// "force while unloading, 0.5 to 4 N": a row of the map has a range and a unit of its own.
std::string named_range(const ResidualMap& m) {
  double low = INFINITY, high = -INFINITY;
  for (const MapCell& c : m.cells)
    if (c.n > 0) low = std::min(low, c.x), high = std::max(high, c.x);
  if (!(high >= low)) return m.coordinate;
  const bool logarithm = m.unit == kLogOfTime;
  if (logarithm) low = seconds_of_log(low), high = seconds_of_log(high);
  const Scaled scale = logarithm ? Scaled{1.0, "s"} : scale_of_coordinate(m);
  return m.coordinate + ", " + typographic_minus(display(scale.factor * low, 2)) + " to " + typographic_minus(display(scale.factor * high, 2)) +
         (scale.unit.empty() ? "" : " " + scale.unit);
}

}  // namespace

Figure diagnosis_waterfall(const Diagnosis& d) {
  std::vector<WaterfallStep> steps;
  double error = d.error_before;
  const auto claims = [&](const std::string& effect) {
    return std::ranges::any_of(d.findings, [&](const Finding& f) { return f.effect == effect && !f.of_samples() && f.claimed(); });
  };
  std::vector<std::string> raw;
  for (const Finding& f : d.findings)
    if (f.of_samples() && f.claimed()) raw.push_back(f.effect);
  for (const ModelStep& step : d.steps) {
    const std::string name = step.effect.empty() ? join(raw, ", ") : step.effect;
    if (name.empty()) continue;
    steps.push_back({name, error, step.error, 0.0, step.effect.empty() || claims(step.effect)});
    error = step.error;
  }
  if (steps.empty())
    steps.push_back({d.not_separable.empty() ? "no effect added" : join(d.not_separable.front(), " or "),
                     d.error_before, d.error_after, 0.0, false});
  else
    steps.back().after = d.error_after;
  return waterfall(error_title(d.judged_by) + " over the model's versions", "start", steps, "now", d.unit,
                   d.floor > 0.0 ? d.floor : NAN);
}

bool is_of_rig(const Diagnosis& d, const Finding& f) {
  // what the drive does is held against its command
  return d.errors.contains("F") && f.claimed() && f.shown_in == ShownIn::rig;
}

bool claims_hum(const Diagnosis& d) {
  return std::ranges::any_of(d.findings, [](const Finding& f) { return f.effect == "hum" && f.claimed(); });
}

bool shows_rig(const Diagnosis& d) {
  return std::ranges::any_of(d.findings, [&](const Finding& f) { return is_of_rig(d, f); });
}

Figure rig_waterfall(const Diagnosis& d) {
  const ErrorPair& rig = d.errors.at("F");
  std::vector<Finding> claims;  // of the rig's law, in the order in which they entered it
  for (const Finding& f : d.findings)
    if (is_of_rig(d, f)) claims.push_back(f);
  std::ranges::stable_sort(claims, std::greater{}, &Finding::error_before);
  std::vector<WaterfallStep> steps;
  double error = rig.before;
  for (const Finding& f : claims) {
    steps.push_back({f.effect, error, f.error_after, 0.0, true});
    error = f.error_after;
  }
  if (!steps.empty()) steps.back().after = rig.after;
  return waterfall("Error of F_ref against the rig's law", "start", steps, "now", rig.unit, NAN);
}

std::string error_title(JudgedBy judged_by) { return judged_by == JudgedBy::whole ? "Error of the whole recording" : "Held-out error"; }

namespace {

void draw_probabilities(const Diagnosis& d, std::size_t n, double height, Figure& figure) {
  Panel& p = figure.panel({"Probability", ""}, {"Effect", ""}, height);
  p.x_axis.low = 0.0;
  p.x_axis.high = 1.0;
  std::vector<Bar> probability;
  for (std::size_t i = 0; i < n; ++i) {
    const RankedEffect& r = d.ranking[n - 1 - i];
    p.y_axis.categories.push_back(shorten(printable_utf8(r.effect), 22));
    const bool claim = r.probability >= kClaim;
    probability.push_back({static_cast<double>(i), 0.0, r.probability, 0.0, !claim, claim ? Role::model : Role::muted, ""});
  }
  p.bars(std::move(probability), true, false, 0.6);
  p.vline(kClaim, "", Role::muted, Dash::dotted);
}

void draw_shares(const Diagnosis& d, std::size_t n, double height, Figure& figure) {
  Panel& share = figure.panel({"Share of the explainable residual", "%"}, {"Effect, as left", ""}, height);
  share.x_axis.include_zero = true;
  std::vector<double> alone, unique, y;
  for (std::size_t i = 0; i < n; ++i) {
    const RankedEffect& r = d.ranking[n - 1 - i];
    const double at = static_cast<double>(i);
    share.y_axis.categories.push_back("");
    y.push_back(at);
    alone.push_back(100.0 * r.alone);
    unique.push_back(100.0 * r.unique);
    share.line({alone.back(), unique.back()}, {at, at}, {Role::muted, Dash::solid, 1.0});
  }
  share.points(alone, y, {Role::firmware, Dash::solid, 1.0, Marker::ring, 6.0}, "alone");
  share.points(unique, y, {Role::model, Dash::solid, 1.0, Marker::dot, 6.0}, "only it");
}

// Of a residual that is noise alone nothing takes a share: what differs from record to record may be all there is to explain.
bool shows_shares(const Diagnosis& d, std::size_t n) {
  constexpr double kVisible = 1e-3;
  return std::any_of(d.ranking.begin(), d.ranking.begin() + static_cast<std::ptrdiff_t>(n),
                     [](const RankedEffect& r) { return std::abs(r.alone) > kVisible || std::abs(r.unique) > kVisible; });
}

}  // namespace

Figure ranking_figure(const Diagnosis& d) {
  Figure figure("Ranking of the effects", 640.0);
  const std::size_t n = std::min<std::size_t>(12, d.ranking.size());
  if (n == 0) return figure;
  const bool shares = shows_shares(d, n);
  figure.columns = shares ? 2 : 1;
  const double height = 24.0 * static_cast<double>(n) + 6.0;
  draw_probabilities(d, n, height, figure);
  if (shares) draw_shares(d, n, height, figure);
  const RankedEffect& first = d.ranking.front();
  const bool claims = std::ranges::any_of(d.ranking, [](const RankedEffect& r) { return r.probability >= kClaim; });
  const bool of_samples = std::ranges::any_of(d.findings, [](const Finding& f) { return f.of_samples() && f.claimed(); });
  figure.summary = (claims ? "First: " + first.effect + ", probability " + probability_text(first.probability) + "; right of the dotted line is a claim."
                           : "Nothing is right of the dotted line, where a claim begins.") +
                   (of_samples ? " What the samples themselves show is claimed without a fit and not ranked here." : "") +
                   (shares ? " A wide gap between ring and dot means that another effect explains the same data." : "");
  return figure;
}

Figure record_error_figure(const Diagnosis& d) {
  std::vector<BeforeAfter> rows;
  for (const RecordError& r : d.records)
    rows.push_back({r.record + (r.kind.empty() ? "" : ", " + r.kind) + (r.heldout ? " *" : ""), r.before,
                    r.after, r.floor > 0.0 ? r.floor : NAN});
  Figure figure = before_after_rows("Error of every record", rows, "RMSE", d.unit);
  if (std::ranges::any_of(d.records, &RecordError::heldout))
    figure.summary = "* held out: never seen by the fit.";
  else if (d.records.size() > 1)
    figure.summary = "Each record is judged with the strengths that the others give.";
  return figure;
}

bool has_after(const Diagnosis& d) {
  constexpr double kSame = 1e-6;  // of the largest mean
  for (const ResidualMap& after : d.maps_after) {
    const auto before = std::ranges::find(d.maps, after.coordinate, &ResidualMap::coordinate);
    if (before == d.maps.end() || before->cells.size() != after.cells.size()) return true;
    double most = 0.0, apart = 0.0;
    for (std::size_t i = 0; i < after.cells.size(); ++i) {
      most = std::max(most, std::abs(before->cells[i].mean));
      apart = std::max(apart, std::abs(before->cells[i].mean - after.cells[i].mean));
    }
    if (apart > kSame * most) return true;
  }
  return false;
}

Figure residual_map_figure(const Diagnosis& d, bool after) {
  const std::vector<ResidualMap>& maps = after ? d.maps_after : d.maps;
  Figure figure(after ? "Residual map after" : has_after(d) ? "Residual map before" : "Residual map", kMapWidth);
  constexpr std::size_t kMostRows = 12;
  std::size_t columns = 0;
  double most = 0.0;
  // both pictures have the same rows in one order, that of the first
  std::vector<const ResidualMap*> rows, by_share;
  for (const ResidualMap& m : d.maps) {
    if (rows.size() == kMostRows) break;
    const auto at = std::ranges::find(maps, m.coordinate, &ResidualMap::coordinate);
    if (at == maps.end() || at->cells.empty()) continue;
    rows.push_back(&*at);
    columns = std::max(columns, at->cells.size());
  }
  for (const ResidualMap& m : maps)
    if (std::ranges::find(rows, &m) != rows.end()) by_share.push_back(&m);
  for (const std::vector<ResidualMap>* all : {&d.maps, &d.maps_after})
    for (const ResidualMap& m : *all)
      for (const MapCell& c : m.cells)
        if (c.blocks >= kBlocksNeeded) most = std::max(most, std::abs(c.mean));
  if (rows.empty()) return figure;
  const Scaled scale = readable_unit(most, d.unit);
  HeatMap map;
  map.diverging = true;
  map.low = -most * scale.factor;
  map.high = most * scale.factor;
  map.label = "Residual";
  map.unit = scale.unit;
  for (std::size_t i = 0; i <= columns; ++i)
    map.x_edges.push_back(100.0 * static_cast<double>(i) / static_cast<double>(columns));
  Panel& panel = figure.panel({"Position in the range that stands beside the coordinate", "%"}, {"Coordinate, lowest to highest", ""},
                              22.0 * static_cast<double>(rows.size()));
  for (std::size_t j = 0; j < rows.size(); ++j) {
    const ResidualMap& m = *rows[rows.size() - 1 - j];
    panel.y_axis.categories.push_back(named_range(m));
    map.y_edges.push_back(static_cast<double>(j) - 0.5);
    for (std::size_t i = 0; i < columns; ++i) {
      const std::size_t at = i * m.cells.size() / columns;
      const MapCell& c = m.cells[at];
      map.value.push_back(c.n > 0 && c.blocks >= kBlocksNeeded ? c.mean * scale.factor : NAN);
      map.hatched.push_back(c.blocks < kBlocksNeeded);
    }
  }
  map.y_edges.push_back(static_cast<double>(rows.size()) - 0.5);
  panel.y_axis.low = -0.5;
  panel.y_axis.high = static_cast<double>(rows.size()) - 0.5;
  panel.no_grid = true;
  panel.heat(std::move(map));
  figure.summary = "Hatched: fewer than three blocks of data, no statement.";
  for (const ResidualMap* m : by_share)
    if (m->share > 0.0 && !m->sentence.empty()) {
      figure.summary = m->sentence + ". " + figure.summary;
      break;
    }
  return figure;
}

Figure coordinate_figure(const ResidualMap& before, const ResidualMap* after, const std::string& residual_unit, const std::string& residual) {
  Figure figure(residual + " against " + before.coordinate, 380.0);
  double most = 0.0;
  for (const MapCell& c : before.cells)
    if (c.blocks >= kBlocksNeeded) most = std::max({most, std::abs(c.mean), 2.0 * c.standard_error});
  const Scaled scale = readable_unit(most, residual_unit);
  const bool logarithm = before.unit == kLogOfTime;
  const Scaled x_scale = scale_of_coordinate(before);
  Axis x_axis{capitalised(before.coordinate), x_scale.unit};
  if (logarithm) {
    x_axis = {"1 s + " + before.coordinate, "s", kAuto, kAuto, Scale::logarithmic};
  } else {
    spread_crowded(before.cells, x_axis);
    x_axis.linear_within *= x_scale.factor;
  }
  Panel& panel = figure.panel(x_axis, {residual, scale.unit}, 150.0);
  panel.hline(0.0);
  const auto add = [&](const ResidualMap& map, Style style, const std::string& label) {
    std::vector<double> x, y, U, thin_x, thin_y;
    for (const MapCell& c : map.cells) {
      if (c.n == 0) continue;
      const bool enough = c.blocks >= kBlocksNeeded;
      (enough ? x : thin_x).push_back(logarithm ? std::pow(10.0, c.x) : x_scale.factor * c.x);
      (enough ? y : thin_y).push_back(c.mean * scale.factor);
      if (enough) U.push_back(2.0 * c.standard_error * scale.factor);
    }
    panel.line(x, y, {style.role, style.dash, 1.0, Marker::none, 1.0, 0.6});
    panel.points(x, y, style, label, U);
    if (!thin_x.empty()) panel.points(thin_x, thin_y, {Role::muted, Dash::solid, 1.0, Marker::cross, 5.0});
  };
  add(before, {Role::firmware, Dash::solid, 1.0, Marker::ring, 5.0}, after != nullptr ? "before" : "");
  if (after != nullptr) add(*after, {Role::model, Dash::dashed, 1.0, Marker::dot, 5.0}, "after");
  figure.summary = before.sentence;
  if (panel.x_axis.scale == Scale::symmetric_log) figure.summary += (figure.summary.empty() ? "" : ". ") + std::string("The axis is straight about zero and logarithmic beyond.");
  return figure;
}

Figure rig_coordinate_figure(const ResidualMap& map) { return coordinate_figure(map, nullptr, "N", "F_ref less the rig's law"); }

Figure evidence_figure(const EvidenceSeries& s) {
  Figure figure(s.title + (s.record.empty() ? "" : ", record " + s.record), 760.0);
  const double reach = reach_of(s);
  const Scaled scale = readable_unit(reach, s.y_unit);
  figure.columns = 2;
  const bool frequency = s.x_name.find("frequency") != std::string::npos;
  for (const bool is_after : {false, true}) {
    const std::vector<double> y = scaled(is_after ? s.after : s.before, scale.factor);
    Panel& panel =
        figure.panel({capitalised(s.x_name), shown_unit(s.x_unit)}, {frequency ? "Amplitude" : "Residual", scale.unit}, 190.0);
    panel.title = is_after ? "With the effect" : "Without the effect";
    if ((s.x_unit == "s" || s.x_unit == "Hz") && spans_decades(s.x)) panel.x_axis.scale = Scale::logarithmic;
    if (frequency) {
      if (spans_decades(s.before) && spans_decades(s.after)) panel.y_axis.scale = Scale::logarithmic;
      panel.line(s.x, y, {is_after ? Role::model : Role::firmware, Dash::solid, 1.1});
      figure.share_y = true;
    } else {
      add_directed(panel, s.x, y, s.colour, reach * scale.factor);
      panel.hline(0.0);
    }
  }
  figure.summary = capitalised(s.title) + ": residual without and with the effect, same scale.";
  return figure;
}

Figure sample_figure(const SampleWindow& w) {
  Figure figure(capitalised(w.quantity) + " as recorded, record " + w.record, 760.0);
  double most = 0.0;
  for (const double v : w.recorded)
    if (std::isfinite(v)) most = std::max(most, std::abs(v));
  const Scaled scale = readable_unit(most, w.unit);
  Panel& panel = figure.panel({"Time", "s"}, {capitalised(w.quantity), scale.unit}, 190.0);
  panel.line(w.t_s, scaled(w.beside, scale.factor), {Role::model, Dash::dashed, 1.4}, w.beside_name);
  panel.line(w.t_s, scaled(w.recorded, scale.factor), {Role::reference, Dash::solid, 1.1}, "as recorded");
  if (!w.named.empty()) panel.points(w.named_t_s, scaled(w.named, scale.factor), {Role::firmware, Dash::solid, 1.0, Marker::ring, 5.0}, "named");
  figure.summary = w.named.empty() ? capitalised(w.quantity) + " as recorded and " + w.beside_name + "."
                                   : std::to_string(w.named.size()) + " samples of this cut are named; the dashed line is the " + w.quantity + " " + w.beside_name + ".";
  return figure;
}

}  // namespace forcegate
