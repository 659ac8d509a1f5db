#include "hil/report/figures/colormap.h"
#include "hil/report/figures/draw.h"
#include "hil/report/figures/text.h"

namespace forcegate::figures {

std::string text_element(double x_px, double y_px, std::string_view text, Anchor anchor,
                         std::string_view classes) {
  if (text.empty()) return {};
  std::string out = "<text x=\"" + coordinate(x_px) + "\" y=\"" + coordinate(y_px) + "\"";
  if (anchor == Anchor::middle) out += " text-anchor=\"middle\"";
  if (anchor == Anchor::right) out += " text-anchor=\"end\"";
  if (!classes.empty()) out += " class=\"" + std::string(classes) + "\"";
  return out + ">" + escape(text) + "</text>";
}

namespace {

struct DrawTexts {
  const PlotArea& area;

  bool inside(double x, double y) const {
    return x >= -0.5 && x <= area.width + 0.5 && y >= -0.5 && y <= area.height + 0.5;
  }
  std::string at(double x, double y, std::string_view text, Anchor anchor, Role role) const {
    const double width = text_width_px(text, 11.0);
    double left = anchor == Anchor::left ? x : anchor == Anchor::middle ? x - width / 2 : x - width;
    const double shift = left < 0.0 ? -left : std::min(0.0, area.width - left - width);
    if (width < area.width) x += shift;
    const std::string classes = "u " + std::string(role_class(role));
    return text_element(area.left + x, area.top + std::clamp(y, 9.0, area.height - 2.0), text, anchor,
                        classes);
  }

  std::string operator()(const LineSeries&) const { return {}; }
  std::string operator()(const PointSeries&) const { return {}; }
  std::string operator()(const BandSeries&) const { return {}; }
  std::string operator()(const Density&) const { return {}; }

  std::string operator()(const BarSeries& s) const {
    std::string out;
    for (const Bar& b : s.bars) {
      if (b.text.empty() || !std::isfinite(b.value)) continue;
      const bool down = b.value < b.base;
      const double u = std::isfinite(b.u) ? b.u : 0.0;
      if (s.horizontal) {
        const double x = area.x(std::max(b.base, b.value + u)) + 6.0;
        out += text_element(area.left + x, area.top + area.y(b.position) + 4.0, b.text, Anchor::left,
                            role_class(Role::reference));
      } else {
        // below the end of a bar that hangs, unless the names of the bars stand there
        const double below = area.y(b.value - u) + 13.0;
        const double end = down && below < area.height - 2.0 ? below : area.y(down ? b.base : b.value + u) - 5.0;
        out += text_element(area.left + area.x(b.position), area.top + end, b.text, Anchor::middle,
                            role_class(Role::reference));
      }
    }
    return out;
  }

  std::string operator()(const HeatMap& s) const {
    std::string out;
    if (s.text.empty() || s.x_edges.size() < 2 || s.y_edges.size() < 2) return out;
    const Range range = heat_map_range(s);
    const std::size_t nx = s.x_edges.size() - 1, ny = s.y_edges.size() - 1;
    for (std::size_t j = 0; j < ny; ++j)
      for (std::size_t i = 0; i < nx; ++i) {
        const std::size_t cell = j * nx + i;
        if (cell >= s.text.size() || s.text[cell].empty()) continue;
        const double left = area.x(s.x_edges[i]), right = area.x(s.x_edges[i + 1]);
        if (right - left < text_width_px(s.text[cell], 11.0)) continue;
        const double y = (area.y(s.y_edges[j]) + area.y(s.y_edges[j + 1])) / 2;
        const int level =
            cell < s.value.size() ? colour_level((s.value[cell] - range.low) / (range.high - range.low)) : -1;
        std::string text = text_element(area.left + (left + right) / 2, area.top + y + 4.0, s.text[cell],
                                        Anchor::middle, level < 0 ? "rf" : "");
        if (level >= 0) {
          const std::string ink = ink_on(s.diverging ? diverging_colour(level) : sequential_colour(level));
          text.insert(5, ink == "#fff" ? " class=\"iw\"" : " class=\"ib\"");
        }
        out += text;
      }
    return out;
  }

  std::string operator()(const Rule& s) const {
    if (!std::isfinite(s.at)) return {};
    if (s.horizontal) {
      const double y = area.y(s.at);
      if (!inside(0.0, y)) return {};
      return at(area.width - 4.0, y < 14.0 ? y + 12.0 : y - 4.0, s.label, Anchor::right, s.role);
    }
    const double x = area.x(s.at);
    if (!inside(x, 0.0)) return {};
    const bool left_side = x + 4.0 + text_width_px(s.label, 11.0) > area.width;
    return at(left_side ? x - 4.0 : x + 4.0, 11.0, s.label, left_side ? Anchor::right : Anchor::left, s.role);
  }

  std::string operator()(const Span& s) const {
    if (std::isnan(s.x_low) || std::isnan(s.x_high)) return {};
    const double left = std::clamp(area.x(s.x_low), 0.0, area.width);
    const double right = std::clamp(area.x(s.x_high), 0.0, area.width);
    return at((left + right) / 2, 11.0, s.label, Anchor::middle, s.role);
  }

  std::string operator()(const Note& s) const {
    const double x = area.x(s.x), y = area.y(s.y);
    if (!inside(x, y)) return {};
    return at(x + s.dx_px, y + s.dy_px, s.text, s.anchor, s.role);
  }
};

}  // namespace

std::string draw_texts(const Panel& panel, const PlotArea& area) {
  std::string out;
  const DrawTexts draw{area};
  for (const Series& s : panel.series) out += std::visit(draw, s);
  return out;
}

}  // namespace forcegate::figures
