#include "hil/report/figures/draw.h"

#include <array>
#include <map>

#include "hil/report/figures/colormap.h"
#include "hil/report/figures/path.h"
#include "hil/report/figures/text.h"

namespace forcegate::figures {
namespace {

std::string tenths(double px) { return std::to_string(std::lround(px * 10.0)); }

std::string dash_attribute(Dash dash, double width_px, double unit) {
  const auto n = [&](double v) { return coordinate(v * unit); };
  if (dash == Dash::dashed) return " stroke-dasharray=\"" + n(5) + " " + n(3) + "\"";
  if (dash == Dash::dotted)
    return " stroke-dasharray=\"" + n(std::max(1.2, width_px)) + " " + n(2.5 + width_px) + "\"";
  return {};
}

std::string opacity_attribute(double opacity) {
  return opacity < 1.0 ? " opacity=\"" + coordinate(opacity, 2) + "\"" : std::string();
}

std::string open_path(std::string_view kind, Role role) {
  return "<path class=\"" + std::string(kind) + " " + std::string(role_class(role)) + "\"";
}

// The line as pixels: NaN breaks it, long stretches are reduced.
void add_polyline(PathData& path, std::span<const double> x, std::span<const double> y,
                  const PlotArea& area) {
  const std::size_t n = std::min(x.size(), y.size());
  std::size_t begin = 0;
  while (begin < n) {
    while (begin < n && (std::isnan(x[begin]) || std::isnan(y[begin]))) ++begin;
    std::size_t end = begin;
    bool ascending = true;
    while (end < n && !std::isnan(x[end]) && !std::isnan(y[end])) {
      if (end > begin && x[end] < x[end - 1]) ascending = false;
      ++end;
    }
    if (end == begin) break;
    std::vector<Point> points;
    const auto add = [&](std::size_t i) { points.push_back({area.x(x[i]), area.y(y[i])}); };
    const auto columns = static_cast<std::size_t>(0.6 * area.width);
    const bool dense = ascending && end - begin > 4 * columns;
    if (dense) {
      const std::span<const double> segment = y.subspan(begin, end - begin);
      for (const std::size_t i : m4_indices(x.subspan(begin, end - begin), {&segment, 1}, columns))
        add(begin + i);
    } else {
      for (std::size_t i = begin; i < end; ++i) {
        const Point p{area.x(x[i]), area.y(y[i])};
        if (!points.empty() && i + 1 < end && std::hypot(p.x - points.back().x, p.y - points.back().y) < 0.1)
          continue;
        points.push_back(p);
      }
    }
    points = simplify_polyline(points, dense ? 0.25 : 0.15);
    path.move(points[0].x, points[0].y);
    if (points.size() == 1) path.line(points[0].x, points[0].y);
    for (std::size_t i = 1; i < points.size(); ++i) path.line(points[i].x, points[i].y);
    begin = end;
  }
}

std::string marker_path(const Style& style, std::span<const Point> points) {
  PathData path;
  const double r = style.size_px / 2.0;
  std::string attributes;
  std::string kind = "p";
  for (const Point p : points) {
    switch (style.marker) {
      case Marker::none:
      case Marker::dot: path.dot(p.x, p.y); break;
      case Marker::ring: path.dot(p.x, p.y); break;
      case Marker::square: path.rectangle(p.x - r, p.y - r, 2 * r, 2 * r); break;
      case Marker::up:
        path.move(p.x, p.y - 1.15 * r), path.line(p.x + r, p.y + 0.75 * r),
            path.line(p.x - r, p.y + 0.75 * r);
        path.close();
        break;
      case Marker::down:
        path.move(p.x, p.y + 1.15 * r), path.line(p.x + r, p.y - 0.75 * r),
            path.line(p.x - r, p.y - 0.75 * r);
        path.close();
        break;
      case Marker::cross:
        path.move(p.x - r, p.y - r), path.line(p.x + r, p.y + r);
        path.move(p.x - r, p.y + r), path.line(p.x + r, p.y - r);
        break;
    }
  }
  if (path.empty()) return {};
  const auto stroke = [](double px) { return " stroke-width=\"" + tenths(px) + "\""; };
  if (style.marker ==
      Marker::ring)  // a dot with a hole in the colour of the page: far fewer bytes than circles
    return open_path("p", style.role) + stroke(style.size_px + 0.8) + opacity_attribute(style.opacity) +
           " d=\"" + path.text() + "\"/><path class=\"p hole\"" + stroke(style.size_px - 1.2) + " d=\"" +
           path.text() + "\"/>";
  if (style.marker == Marker::dot || style.marker == Marker::none)
    attributes = stroke(style.size_px);
  else if (style.marker == Marker::cross)
    attributes = " stroke-width=\"" + tenths(std::max(1.0, style.size_px / 4.0)) + "\"";
  else
    kind = "f";
  return open_path(kind, style.role) + attributes + opacity_attribute(style.opacity) + " d=\"" + path.text() +
         "\"/>";
}

struct DrawClipped {
  const PlotArea& area;

  std::string operator()(const LineSeries& s) const {
    PathData path;
    add_polyline(path, s.x, s.y, area);
    if (path.empty()) return {};
    std::string out = open_path("l", s.style.role) + " stroke-width=\"" + tenths(s.style.width_px) + "\"" +
                      dash_attribute(s.style.dash, s.style.width_px, 10.0) +
                      opacity_attribute(s.style.opacity) + " d=\"" + path.text() + "\"/>";
    if (s.style.marker != Marker::none) {
      std::vector<Point> points;
      for (std::size_t i = 0; i < std::min(s.x.size(), s.y.size()); ++i)
        if (!std::isnan(s.x[i]) && !std::isnan(s.y[i])) points.push_back({area.x(s.x[i]), area.y(s.y[i])});
      out += marker_path(s.style, points);
    }
    return out;
  }

  std::string operator()(const PointSeries& s) const {
    std::vector<Point> points;
    PathData whiskers;
    for (std::size_t i = 0; i < std::min(s.x.size(), s.y.size()); ++i) {
      if (std::isnan(s.x[i]) || std::isnan(s.y[i])) continue;
      const double x = area.x(s.x[i]), y = area.y(s.y[i]);
      points.push_back({x, y});
      if (i < s.u_y.size() && s.u_y[i] > 0.0) {
        const double top = area.y(s.y[i] + s.u_y[i]), bottom = area.y(s.y[i] - s.u_y[i]);
        whiskers.move(x, top), whiskers.line(x, bottom);
        whiskers.move(x - 3, top), whiskers.line(x + 3, top);
        whiskers.move(x - 3, bottom), whiskers.line(x + 3, bottom);
      }
      if (i < s.u_x.size() && s.u_x[i] > 0.0) {
        const double left = area.x(s.x[i] - s.u_x[i]), right = area.x(s.x[i] + s.u_x[i]);
        whiskers.move(left, y), whiskers.line(right, y);
        whiskers.move(left, y - 3), whiskers.line(left, y + 3);
        whiskers.move(right, y - 3), whiskers.line(right, y + 3);
      }
    }
    std::string out;
    if (!whiskers.empty())
      out += open_path("l", s.style.role) + " stroke-width=\"12\" d=\"" + whiskers.text() + "\"/>";
    return out + marker_path(s.style, points);
  }

  std::string operator()(const BandSeries& s) const {
    const std::size_t n = std::min({s.x.size(), s.low.size(), s.high.size()});
    std::vector<Point> upper, lower;
    for (std::size_t i = 0; i < n; ++i) {
      if (std::isnan(s.x[i]) || std::isnan(s.low[i]) || std::isnan(s.high[i])) continue;
      upper.push_back({area.x(s.x[i]), area.y(s.high[i])});
      lower.push_back({area.x(s.x[i]), area.y(s.low[i])});
    }
    if (upper.size() < 2) return {};
    upper = simplify_polyline(upper, 0.15);
    lower = simplify_polyline(lower, 0.15);
    PathData path;
    path.move(upper[0].x, upper[0].y);
    for (std::size_t i = 1; i < upper.size(); ++i) path.line(upper[i].x, upper[i].y);
    for (std::size_t i = lower.size(); i-- > 0;) path.line(lower[i].x, lower[i].y);
    path.close();
    return open_path("f", s.role) + opacity_attribute(s.opacity) + " d=\"" + path.text() + "\"/>";
  }

  std::string operator()(const BarSeries& s) const {
    std::string out;
    PathData connector;
    const Bar* before = nullptr;
    const auto px = [&](double across, double along) {
      return s.horizontal ? Point{area.x(along), area.y(across)} : Point{area.x(across), area.y(along)};
    };
    for (const Bar& b : s.bars) {
      if (!std::isfinite(b.value) || !std::isfinite(b.base)) continue;
      const Point a = px(b.position - s.thickness / 2, b.base), c = px(b.position + s.thickness / 2, b.value);
      const double inset = b.hollow ? 0.7 : 0.0;
      PathData path;
      path.rectangle(std::min(a.x, c.x) + inset, std::min(a.y, c.y) + inset,
                     std::max(0.4, std::abs(c.x - a.x) - 2 * inset),
                     std::max(0.4, std::abs(c.y - a.y) - 2 * inset));
      out += open_path(b.hollow ? "h" : "f", b.role);
      if (b.hollow) out += " stroke-width=\"14\"";
      out += " d=\"" + path.text() + "\"/>";
      if (b.u > 0.0) {
        const Point low = px(b.position, b.value - b.u), high = px(b.position, b.value + b.u);
        PathData whisker;
        whisker.move(low.x, low.y), whisker.line(high.x, high.y);
        for (const Point e : {low, high}) {
          whisker.move(s.horizontal ? e.x : e.x - 4, s.horizontal ? e.y - 4 : e.y);
          whisker.line(s.horizontal ? e.x : e.x + 4, s.horizontal ? e.y + 4 : e.y);
        }
        out += open_path("l", Role::reference) + " stroke-width=\"13\" d=\"" + whisker.text() + "\"/>";
      }
      if (s.connect && before != nullptr) {
        const Point from = px(before->position + s.thickness / 2, before->value),
                    to = px(b.position - s.thickness / 2, before->value);
        connector.move(from.x, from.y), connector.line(to.x, to.y);
      }
      before = &b;
    }
    if (!connector.empty())
      out = open_path("l", Role::muted) + " stroke-width=\"10\" d=\"" + connector.text() + "\"/>" + out;
    return out;
  }

  std::string operator()(const HeatMap& s) const {
    const std::size_t nx = s.x_edges.empty() ? 0 : s.x_edges.size() - 1;
    const std::size_t ny = s.y_edges.empty() ? 0 : s.y_edges.size() - 1;
    const Range range = heat_range(s);
    std::array<PathData, kColourLevels> cells;
    PathData hatch;
    for (std::size_t j = 0; j < ny; ++j) {
      for (std::size_t i = 0; i < nx; ++i) {
        const std::size_t at = j * nx + i;
        const double left = area.x(s.x_edges[i]), right = area.x(s.x_edges[i + 1]);
        const double top = area.y(s.y_edges[j + 1]), bottom = area.y(s.y_edges[j]);
        const int level =
            at < s.value.size() ? colour_level((s.value[at] - range.low) / (range.high - range.low)) : -1;
        if (level >= 0)
          cells[static_cast<std::size_t>(level)].rectangle(left, top, right - left, bottom - top);
        if (at < s.hatched.size() && s.hatched[at])
          for (double d = 6.0; d < right - left + bottom - top; d += 6.0) {
            const double x0 = std::min(d, right - left), y0 = d - x0;
            const double y1 = std::min(d, bottom - top), x1 = d - y1;
            hatch.move(left + x0, top + y0), hatch.line(left + x1, top + y1);
          }
      }
    }
    std::string out;
    for (int level = 0; level < kColourLevels; ++level) {
      const PathData& path = cells[static_cast<std::size_t>(level)];
      if (path.empty()) continue;
      const std::string colour = s.diverging ? diverging_colour(level) : sequential_colour(level);
      out += "<path fill=\"" + colour + "\" stroke=\"" + colour + "\" stroke-width=\"2\" d=\"" + path.text() +
             "\"/>";
    }
    if (!hatch.empty())
      out += open_path("l", Role::muted) + " stroke-width=\"8\" d=\"" + hatch.text() + "\"/>";
    return out;
  }

  std::string operator()(const Density& s) const {
    static constexpr int kLevels = 6;
    std::array<PathData, kLevels> runs;  // one stroke for neighbours of one level in a row
    double most = 0.0;
    for (const double c : s.count) most = std::max(most, c);
    if (!(most > 0.0)) return {};
    const double dx = (s.x_high - s.x_low) / s.nx, dy = (s.y_high - s.y_low) / s.ny;
    const auto level_of = [&](int i, int j) {
      const double c =
          s.count[static_cast<std::size_t>(j) * static_cast<std::size_t>(s.nx) + static_cast<std::size_t>(i)];
      return c > 0.0 ? static_cast<int>(std::min(kLevels - 1.0, std::sqrt(c / most) * kLevels)) : -1;
    };
    for (int j = 0; j < s.ny; ++j)
      for (int i = 0; i < s.nx;) {
        const int level = level_of(i, j);
        int end = i + 1;
        while (end < s.nx && level_of(end, j) == level) ++end;
        if (level >= 0) {
          PathData& path = runs[static_cast<std::size_t>(level)];
          const double y = area.y(s.y_low + (j + 0.5) * dy);
          path.move(area.x(s.x_low + i * dx), y);
          path.line(area.x(s.x_low + end * dx), y);
        }
        i = end;
      }
    const double height = area.y(s.y_low) - area.y(s.y_low + dy);
    std::string out;
    for (std::size_t level = 0; level < kLevels; ++level)
      if (!runs[level].empty())
        out += open_path("l", s.role) + " stroke-width=\"" + tenths(height) + "\"" +
               opacity_attribute(0.25 + 0.13 * static_cast<double>(level)) + " d=\"" + runs[level].text() +
               "\"/>";
    return out;
  }

  std::string operator()(const Rule& s) const {
    if (!std::isfinite(s.at)) return {};
    PathData path;
    if (s.horizontal)
      path.move(0, area.y(s.at)), path.line(area.width, area.y(s.at));
    else
      path.move(area.x(s.at), 0), path.line(area.x(s.at), area.height);
    return open_path("l", s.role) + " stroke-width=\"11\"" + dash_attribute(s.dash, 1.1, 10.0) + " d=\"" +
           path.text() + "\"/>";
  }

  std::string operator()(const Span& s) const {
    if (std::isnan(s.x_low) || std::isnan(s.x_high)) return {};
    const double left = std::clamp(area.x(s.x_low), 0.0, area.width);
    const double right = std::clamp(area.x(s.x_high), 0.0, area.width);
    PathData path;
    path.rectangle(left, 0, right - left, area.height);
    return open_path("f", s.role) + " opacity=\"0.14\" d=\"" + path.text() + "\"/>";
  }

  std::string operator()(const Note&) const { return {}; }

  static Range heat_range(const HeatMap& s) {
    Range range;
    for (const double v : s.value) range.include(v);
    if (!range.known()) range = {0.0, 1.0};
    if (s.diverging) {
      const double reach = std::max({std::abs(range.low), std::abs(range.high), 1e-300});
      range = {-reach, reach};
    }
    if (!std::isnan(s.low)) range.low = s.low;
    if (!std::isnan(s.high)) range.high = s.high;
    if (!(range.high > range.low)) range.high = range.low + 1.0;
    return range;
  }
};

}  // namespace

std::string draw_clipped(const Panel& panel, const PlotArea& area) {
  std::string out;
  const DrawClipped draw{area};
  for (const Series& s : panel.series) out += std::visit(draw, s);
  return out;
}

Range heat_map_range(const HeatMap& map) { return DrawClipped::heat_range(map); }

std::string draw_swatch(const Series& series, double x_px, double y_px, double width_px) {
  const std::string x0 = coordinate(x_px), x1 = coordinate(x_px + width_px), y = coordinate(y_px);
  const auto line = [&](const Style& style) {
    return "<path class=\"l " + std::string(role_class(style.role)) + "\" stroke-width=\"" +
           coordinate(std::max(1.6, style.width_px)) + "\"" +
           dash_attribute(style.dash, style.width_px, 1.0) + " d=\"M" + x0 + " " + y + "H" + x1 + "\"/>";
  };
  const auto marker = [&](Style style) {
    style.opacity = 1.0;
    style.size_px = std::max(4.5, style.size_px);
    const Point centre{width_px / 2, 0.0};
    return "<g transform=\"translate(" + x0 + " " + y + ")scale(.1)\">" + marker_path(style, {&centre, 1}) +
           "</g>";
  };
  const auto block = [&](Role role, double opacity) {
    return "<rect class=\"f " + std::string(role_class(role)) + "\"" + opacity_attribute(opacity) + " x=\"" +
           x0 + "\" y=\"" + coordinate(y_px - 5) + "\" width=\"" + coordinate(width_px) +
           "\" height=\"10\"/>";
  };
  if (const auto* s = std::get_if<LineSeries>(&series))
    return line(s->style) + (s->style.marker == Marker::none ? std::string() : marker(s->style));
  if (const auto* s = std::get_if<PointSeries>(&series)) return marker(s->style);
  if (const auto* s = std::get_if<BandSeries>(&series)) return block(s->role, std::max(0.25, s->opacity));
  if (const auto* s = std::get_if<Density>(&series)) return block(s->role, 0.7);
  return {};
}

std::string legend_label(const Series& series) {
  if (const auto* s = std::get_if<LineSeries>(&series)) return s->label;
  if (const auto* s = std::get_if<PointSeries>(&series)) return s->label;
  if (const auto* s = std::get_if<BandSeries>(&series)) return s->label;
  if (const auto* s = std::get_if<Density>(&series)) return s->label;
  return {};
}

}  // namespace forcegate::figures
