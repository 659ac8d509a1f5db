#pragma once
// Pictures for reports, tutorials and papers, as SVG text.
//
//   Figure figure("Force over five cycles");
//   Panel& force = figure.panel(Axis{"Time", "s"}, Axis{"Force", "N"}, 180);
//   force.line(t, ati, {Role::reference}, "ATI").line(t, dut, {Role::firmware}, "firmware");
//   Panel& error = figure.panel(Axis{"Time", "s"}, Axis{"Error", "N"}, 80);
//   error.line(t, residual, {Role::firmware}).hline(0.0, {}, Role::muted);
//   figure.summary = "The firmware follows the ATI within 0.05 N.";
//   std::string svg = figure.svg(Figure::Target::standalone);
//
// Same calls, same bytes. NaN breaks a line and hides a point. Long lines are reduced to what the pixels can
// show (M4, then the polyline within 0.15 px); peaks are kept.

#include <cmath>
#include <deque>
#include <limits>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "hil/report/figures/style.h"

namespace forcegate::figures {

inline constexpr double kAuto = std::numeric_limits<double>::quiet_NaN();

/// symmetric_log: asinh(v / Axis::linear_within), linear about zero and logarithmic beyond, for either sign.
enum class Scale { linear, logarithmic, symmetric_log };
enum class Dash { solid, dashed, dotted };
enum class Marker { none, dot, ring, square, up, down, cross };

/// A drawn quantity, labelled "Force / N".
struct Axis {
  std::string quantity;
  std::string unit;  ///< "" for a pure number
  double low = kAuto, high = kAuto;
  Scale scale = Scale::linear;
  bool include_zero = false;
  bool symmetric = false;  ///< low = -high
  double linear_within = 1.0;  ///< of a symmetric_log axis, > 0
  /// Non-empty: positions 0, 1, 2 ... carry these words instead of numbers.
  std::vector<std::string> categories{};
};

struct Style {
  Role role = Role::reference;
  Dash dash = Dash::solid;
  double width_px = 1.4;
  Marker marker = Marker::none;
  double size_px = 4.0;  ///< of the marker
  double opacity = 1.0;
};

struct LineSeries {
  std::vector<double> x, y;
  Style style;
  std::string label;
};
struct PointSeries {
  std::vector<double> x, y, u_x, u_y;  ///< u: half lengths of the error bars, empty = none
  Style style;
  std::string label;
};
struct BandSeries {
  std::vector<double> x, low, high;
  Role role = Role::muted;
  double opacity = 0.18;
  std::string label;
};
/// One bar from `base` to `value`; hollow = outline only ("not significant").
struct Bar {
  double position = 0.0, base = 0.0, value = 0.0;
  double u = 0.0;  ///< half length of the whisker at `value`, 0 = none
  bool hollow = false;
  Role role = Role::model;
  std::string text;  ///< written at the end of the bar
};
struct BarSeries {
  std::vector<Bar> bars;
  bool horizontal = false;
  double thickness = 0.66;  ///< in axis units of the position
  bool connect = false;     ///< thin line from the end of each bar to the next (waterfall)
};
/// Cells over x_edges (nx + 1) and y_edges (ny + 1), row-major from the lowest y. NaN = nothing measured.
struct HeatMap {
  std::vector<double> x_edges, y_edges, value;
  bool diverging = false;  ///< blue - white - vermillion about 0, else cividis from `low` to `high`
  double low = kAuto, high = kAuto;
  std::string label, unit;        ///< of the colour bar; "" = no bar
  std::vector<char> hatched;      ///< empty, or one a cell: too little data behind the value
  std::vector<std::string> text;  ///< empty, or one a cell
};
/// Counts of samples in cells; drawn with the role's colour, denser where there are more (square root).
struct Density {
  double x_low = 0, x_high = 1, y_low = 0, y_high = 1;
  int nx = 0, ny = 0;
  std::vector<double> count;  ///< row-major from the lowest y
  Role role = Role::rising;
  std::string label;
};
struct Rule {
  bool horizontal = true;
  double at = 0.0;
  std::string label;
  Role role = Role::muted;
  Dash dash = Dash::dashed;
};
struct Span {
  double x_low = 0.0, x_high = 0.0;
  std::string label;
  Role role = Role::muted;
};
enum class Anchor { left, middle, right };
struct Note {
  double x = 0.0, y = 0.0;
  std::string text;
  Role role = Role::reference;
  Anchor anchor = Anchor::left;
  double dx_px = 0.0, dy_px = 0.0;
};

using Series =
    std::variant<LineSeries, PointSeries, BandSeries, BarSeries, HeatMap, Density, Rule, Span, Note>;

template <class T>
std::vector<double> doubles(const std::vector<T>& values) {
  return {values.begin(), values.end()};
}

class Panel {
 public:
  Panel(Axis x, Axis y, double height) : x_axis(std::move(x)), y_axis(std::move(y)), height_px(height) {}

  Panel& line(std::vector<double> x, std::vector<double> y, Style style, std::string label = {});
  Panel& points(std::vector<double> x, std::vector<double> y, Style style, std::string label = {},
                std::vector<double> u_y = {}, std::vector<double> u_x = {});
  Panel& band(std::vector<double> x, std::vector<double> low, std::vector<double> high, Role role,
              std::string label = {}, double opacity = 0.18);
  Panel& bars(std::vector<Bar> bars, bool horizontal, bool connect = false, double thickness = 0.66);
  Panel& heat(HeatMap map);
  Panel& density(Density cells);
  Panel& hline(double y, std::string label = {}, Role role = Role::muted, Dash dash = Dash::dashed);
  Panel& vline(double x, std::string label = {}, Role role = Role::muted, Dash dash = Dash::dashed);
  Panel& span(double x_low, double x_high, std::string label = {}, Role role = Role::muted);
  Panel& note(double x, double y, std::string text, Role role = Role::reference, Anchor anchor = Anchor::left,
              double dx_px = 0.0, double dy_px = 0.0);

  Axis x_axis, y_axis;
  double height_px;            ///< of the plot area, without labels
  std::string title;           ///< above the panel, left
  bool direct_labels = false;  ///< line labels at their right ends instead of in a legend row
  bool show_x_labels = true;   ///< false for the upper panel of a stack with shared x
  bool no_grid = false;
  std::vector<Series> series;
};

class Figure {
 public:
  enum class Target {
    standalone,  ///< a file of its own: white page, light colours written out
    embedded,    ///< inside a page that carries figure_css(true) and theme_css()
  };

  explicit Figure(std::string title_text, double width = 720.0)
      : title(std::move(title_text)), width_px(width) {}

  /// Adds a panel; panels fill `columns` row by row. The reference stays valid.
  Panel& panel(Axis x, Axis y, double height_px);

  std::string svg(Target target) const;

  std::string title;    ///< accessible name; also drawn when show_title
  std::string summary;  ///< one or two sentences: what one should see; <desc>
  double width_px;
  int columns = 1;
  bool show_title = false;
  bool share_x = false;  ///< panels of a column have one x range
  bool share_y = false;  ///< panels of a row have one y range
  const std::deque<Panel>& panels() const { return panels_; }

 private:
  std::deque<Panel> panels_;
};

}  // namespace forcegate::figures
