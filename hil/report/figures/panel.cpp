#include <utility>

#include "hil/report/figures/figure.h"

namespace forcegate::figures {

Panel& Panel::line(std::vector<double> x, std::vector<double> y, Style style, std::string label) {
  series.emplace_back(LineSeries{std::move(x), std::move(y), style, std::move(label)});
  return *this;
}

Panel& Panel::points(std::vector<double> x, std::vector<double> y, Style style, std::string label,
                     std::vector<double> u_y, std::vector<double> u_x) {
  if (style.marker == Marker::none) style.marker = Marker::dot;
  series.emplace_back(
      PointSeries{std::move(x), std::move(y), std::move(u_x), std::move(u_y), style, std::move(label)});
  return *this;
}

Panel& Panel::band(std::vector<double> x, std::vector<double> low, std::vector<double> high, Role role,
                   std::string label, double opacity) {
  series.emplace_back(
      BandSeries{std::move(x), std::move(low), std::move(high), role, opacity, std::move(label)});
  return *this;
}

Panel& Panel::bars(std::vector<Bar> bars, bool horizontal, bool connect, double thickness) {
  series.emplace_back(BarSeries{std::move(bars), horizontal, thickness, connect});
  return *this;
}

Panel& Panel::heat(HeatMap map) {
  series.emplace_back(std::move(map));
  return *this;
}

Panel& Panel::density(Density cells) {
  series.emplace_back(std::move(cells));
  return *this;
}

Panel& Panel::hline(double y, std::string label, Role role, Dash dash) {
  series.emplace_back(Rule{true, y, std::move(label), role, dash});
  return *this;
}

Panel& Panel::vline(double x, std::string label, Role role, Dash dash) {
  series.emplace_back(Rule{false, x, std::move(label), role, dash});
  return *this;
}

Panel& Panel::span(double x_low, double x_high, std::string label, Role role) {
  series.emplace_back(Span{x_low, x_high, std::move(label), role});
  return *this;
}

Panel& Panel::note(double x, double y, std::string text, Role role, Anchor anchor, double dx_px,
                   double dy_px) {
  series.emplace_back(Note{x, y, std::move(text), role, anchor, dx_px, dy_px});
  return *this;
}

Panel& Figure::panel(Axis x, Axis y, double height_px) {
  return panels_.emplace_back(std::move(x), std::move(y), height_px);
}

}  // namespace forcegate::figures
