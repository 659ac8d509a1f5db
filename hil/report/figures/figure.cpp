#include "hil/report/figures/figure.h"

#include <algorithm>

#include "hil/report/figures/colormap.h"
#include "hil/report/figures/draw.h"
#include "hil/report/figures/text.h"
#include "hil/report/figures/ticks.h"

namespace forcegate::figures {
namespace {

constexpr double kFont_px = 11.0, kRow_px = 16.0, kSwatch_px = 18.0, kColumnGap_px = 22.0,
                 kPanelGap_px = 10.0;

std::string axis_label(const Axis& axis) {
  if (axis.unit.empty() || axis.unit == "1") return axis.quantity;
  return axis.quantity + " / " + axis.unit;
}

std::vector<Tick> axis_ticks(const Axis& axis, Range range, double length_px, double spacing_px) {
  std::vector<Tick> ticks;
  if (!axis.categories.empty()) {
    for (std::size_t i = 0; i < axis.categories.size(); ++i)
      ticks.push_back({static_cast<double>(i), axis.categories[i]});
    return ticks;
  }
  const int target = std::max(2, static_cast<int>(length_px / spacing_px));
  if (axis.scale == Scale::logarithmic) return logarithmic_ticks(range.low, range.high, target);
  if (axis.scale == Scale::symmetric_log) return symmetric_log_ticks(range.low, range.high, axis.linear_within, 2 * target);
  ticks = linear_ticks(range.low, range.high, target);
  if (ticks.size() < 3 && length_px / (target + 1) > 20.0)
    for (int more = 1; more <= target && ticks.size() < 3; ++more)
      ticks = linear_ticks(range.low, range.high, target + more);
  // one label is no scale, and zero alone says nothing of the size
  constexpr int kMost = 10;
  for (int more = target + 1; more <= kMost && ticks.size() < 2; ++more) ticks = linear_ticks(range.low, range.high, more);
  return ticks;
}

const HeatMap* colour_bar_of(const Panel& panel) {
  for (const Series& s : panel.series)
    if (const auto* map = std::get_if<HeatMap>(&s); map != nullptr && !map->label.empty()) return map;
  return nullptr;
}

struct Cell {
  const Panel* panel = nullptr;
  PanelRange range;
  double header_px = 0.0, footer_px = 0.0, right_px = 8.0, left_px = 0.0;
  bool y_label_in_header = true;
  PlotArea area;
};

// Legend entries flow after the y label; a new row when the width is used up.
struct HeaderFlow {
  double x, row = 0.0, left, limit;
  double place(double width) {
    if (x + width > limit && x > left) {
      x = left;
      row += 1.0;
    }
    const double at = x;
    x += width;
    return at;
  }
};

std::string draw_header(const Cell& cell, double cell_left, double cell_top, double cell_width,
                        double* height) {
  const Panel& panel = *cell.panel;
  std::string out;
  double top = cell_top;
  if (!panel.title.empty()) {
    out += text_element(cell_left, top + 12.0, panel.title, Anchor::left, "k b");
    top += kRow_px;
  }
  HeaderFlow flow{cell_left, 0.0, cell_left, cell_left + cell_width};
  const std::string y_label = axis_label(panel.y_axis);
  bool any = false;
  if (!y_label.empty()) {
    const double x = flow.place(text_width_px(y_label, kFont_px) + 16.0);
    out += text_element(x, top + 11.0, y_label, Anchor::left, "");
    any = true;
  }
  if (!panel.direct_labels)
    for (const Series& s : panel.series) {
      const std::string label = legend_label(s);
      if (label.empty()) continue;
      const double x = flow.place(kSwatch_px + 5.0 + text_width_px(label, kFont_px) + 14.0);
      const double y = top + flow.row * kRow_px;
      out += draw_swatch(s, x, y + 7.5, kSwatch_px) +
             text_element(x + kSwatch_px + 5.0, y + 11.0, label, Anchor::left, "k");
      any = true;
    }
  if (!any && colour_bar_of(panel) != nullptr) any = true;  // its label stands in this row
  if (any) top += (flow.row + 1.0) * kRow_px;
  *height = top - cell_top + (top > cell_top ? 3.0 : 0.0);
  return out;
}

std::string draw_axes(const Cell& cell) {
  const Panel& panel = *cell.panel;
  const PlotArea& a = cell.area;
  std::string grid, frame, labels;
  const auto h = [](double x0, double y, double x1) {
    return "M" + coordinate(x0) + " " + coordinate(y) + "H" + coordinate(x1);
  };
  const auto v = [](double x, double y0, double y1) {
    return "M" + coordinate(x) + " " + coordinate(y0) + "V" + coordinate(y1);
  };
  const bool y_words = !panel.y_axis.categories.empty(), x_words = !panel.x_axis.categories.empty();
  for (const Tick& tick : axis_ticks(panel.y_axis, cell.range.y, a.height, 34.0)) {
    const double y = std::round(a.top + a.y(tick.value)) + 0.5;
    if (y < a.top - 1.0 || y > a.top + a.height + 1.0) continue;
    if (!y_words && !panel.no_grid && !tick.label.empty()) grid += h(a.left, y, a.left + a.width);
    labels += text_element(a.left - 6.0, y + 3.5, tick.label, Anchor::right, y_words ? "k" : "");
  }
  double last_right = -1e9;
  for (const Tick& tick : axis_ticks(panel.x_axis, cell.range.x, a.width, 78.0)) {
    const double x = std::round(a.left + a.x(tick.value)) + 0.5;
    if (x < a.left - 1.0 || x > a.left + a.width + 1.0) continue;
    if (!x_words && !panel.no_grid && !tick.label.empty()) grid += v(x, a.top, a.top + a.height);
    if (!x_words) frame += v(x, a.top + a.height, a.top + a.height + (tick.label.empty() ? 2.5 : 4.0));
    const double half = text_width_px(tick.label, kFont_px) / 2;
    if (panel.show_x_labels && x - half > last_right + 4.0 && !tick.label.empty()) {
      labels += text_element(x, a.top + a.height + 16.0, tick.label, Anchor::middle, x_words ? "k" : "");
      last_right = x + half;
    }
  }
  frame += h(a.left, std::round(a.top + a.height) + 0.5, a.left + a.width);
  if (panel.show_x_labels)
    labels += text_element(a.left + a.width / 2, a.top + a.height + 31.0, axis_label(panel.x_axis),
                           Anchor::middle, "");
  std::string out;
  if (!grid.empty()) out += "<path class=\"g\" d=\"" + grid + "\"/>";
  return out + "<path class=\"ax\" d=\"" + frame + "\"/>" + labels;
}

std::string draw_colour_bar(const HeatMap& map, const Cell& cell) {
  const Range range = heat_map_range(map);
  const double left = cell.area.left + cell.area.width + 14.0, step = cell.area.height / kColourLevels;
  std::string out;
  for (int level = 0; level < kColourLevels; ++level)
    out += "<rect x=\"" + coordinate(left) + "\" y=\"" +
           coordinate(cell.area.top + cell.area.height - (level + 1) * step) + "\" width=\"11\" height=\"" +
           coordinate(step + 0.3) + "\" fill=\"" +
           (map.diverging ? diverging_colour(level) : sequential_colour(level)) + "\"/>";
  Mapping scale{range, Scale::linear, cell.area.height, true};
  // zero alone tells no size
  constexpr std::size_t kFewest = 3;
  constexpr int kMost = 10;
  std::vector<Tick> ticks;
  for (int target = 4; target <= kMost && ticks.size() < kFewest; ++target) ticks = linear_ticks(range.low, range.high, target);
  for (const Tick& tick : ticks)
    out += text_element(left + 16.0, cell.area.top + scale(tick.value) + 4.0, tick.label, Anchor::left, "");
  const std::string label = map.unit.empty() ? map.label : map.label + " / " + map.unit;
  return out + text_element(left + 52.0, cell.area.top - 6.0, label, Anchor::right, "");
}

// Labels at the right ends of lines and point series, pushed apart to one text height.
std::string draw_direct_labels(const Cell& cell) {
  struct End {
    double y;
    const Style* style;
    std::string label;
  };
  std::vector<End> ends;
  for (const Series& s : cell.panel->series) {
    const auto add = [&](const auto& line) {
      if (line.label.empty()) return;
      for (std::size_t i = std::min(line.x.size(), line.y.size()); i-- > 0;)
        if (!std::isnan(line.y[i])) {
          ends.push_back({cell.area.y(line.y[i]), &line.style, line.label});
          return;
        }
    };
    if (const auto* line = std::get_if<LineSeries>(&s)) add(*line);
    if (const auto* points = std::get_if<PointSeries>(&s)) add(*points);
  }
  std::stable_sort(ends.begin(), ends.end(), [](const End& a, const End& b) { return a.y < b.y; });
  constexpr double kStep = 13.0;
  for (int sweep = 0; sweep < 50; ++sweep)
    for (std::size_t i = 1; i < ends.size(); ++i)
      if (const double overlap = kStep - (ends[i].y - ends[i - 1].y); overlap > 0.01) {
        ends[i - 1].y -= overlap / 2;
        ends[i].y += overlap / 2;
      }
  std::string out;
  for (const End& end : ends)
    out += text_element(cell.area.left + cell.area.width + 6.0,
                        cell.area.top + std::clamp(end.y, 2.0, cell.area.height) + 4.0, end.label,
                        Anchor::left, "b " + std::string(role_class(end.style->role)));
  return out;
}

double right_margin(const Panel& panel) {
  double margin = 17.0;
  if (colour_bar_of(panel) != nullptr) margin = 72.0;
  if (panel.direct_labels)
    for (const Series& s : panel.series)
      margin = std::max(margin, text_width_px(legend_label(s), kFont_px) * 1.06 + 10.0);
  for (const Series& s : panel.series)
    if (const auto* bars = std::get_if<BarSeries>(&s); bars != nullptr && bars->horizontal)
      for (const Bar& b : bars->bars)
        margin = std::max(margin, 12.0 + 0.75 * text_width_px(b.text, kFont_px));
  return margin;
}

// Where the cells stand: columns of one width, filled row by row.
struct Grid {
  std::size_t columns, rows;
  double cell_width_px;
  double left_px(std::size_t cell) const {
    return static_cast<double>(cell % columns) * (cell_width_px + kColumnGap_px);
  }
};

Grid grid_of(const Figure& figure) {
  const std::size_t columns = static_cast<std::size_t>(std::max(1, figure.columns));
  return {columns, (figure.panels().size() + columns - 1) / columns,
          (figure.width_px - kColumnGap_px * static_cast<double>(columns - 1)) / static_cast<double>(columns)};
}

std::vector<Cell> cells_with_data_ranges(const Figure& figure) {
  std::vector<Cell> cells(figure.panels().size());
  for (std::size_t i = 0; i < cells.size(); ++i) {
    cells[i].panel = &figure.panels()[i];
    cells[i].range = data_range(figure.panels()[i]);
  }
  return cells;
}

void share_ranges(const Figure& figure, const Grid& grid, std::vector<Cell>& cells) {
  const auto include = [](Range& range, const Range& other) {
    range.include(other.low);
    range.include(other.high);
  };
  for (std::size_t i = 0; i < cells.size(); ++i)
    for (std::size_t j = 0; j < cells.size(); ++j) {
      if (figure.share_x && i % grid.columns == j % grid.columns) include(cells[i].range.x, data_range(figure.panels()[j]).x);
      if (figure.share_y && i / grid.columns == j / grid.columns) include(cells[i].range.y, data_range(figure.panels()[j]).y);
    }
}

// Fills reach to the edge; points, and texts above bars, want room there.
void pad_ranges(Cell& cell) {
  bool fills = false, points = false, bar_texts = false;
  for (const Series& s : cell.panel->series) {
    fills |= std::holds_alternative<HeatMap>(s) || std::holds_alternative<Density>(s);
    points |= std::holds_alternative<PointSeries>(s);
    if (const auto* bars = std::get_if<BarSeries>(&s))
      for (const Bar& b : bars->bars) bar_texts |= !bars->horizontal && !b.text.empty();
  }
  cell.range.x = finish_range(cell.panel->x_axis, cell.range.x, fills || !points ? 0.0 : 0.02);
  cell.range.y = finish_range(cell.panel->y_axis, cell.range.y, fills ? 0.0 : bar_texts ? 0.14 : 0.06);
}

void set_margins(Cell& cell) {
  const Panel& panel = *cell.panel;
  cell.right_px = right_margin(panel);
  cell.footer_px = panel.show_x_labels ? (axis_label(panel.x_axis).empty() ? 22.0 : 36.0) : 6.0;
  for (const Tick& t : axis_ticks(panel.y_axis, cell.range.y, panel.height_px, 34.0))
    cell.left_px = std::max(cell.left_px, text_width_px(t.label, kFont_px) + 9.0);
}

// Plots of one column stand on one line.
void align_columns(const Grid& grid, std::vector<Cell>& cells) {
  for (std::size_t i = 0; i < cells.size(); ++i)
    for (std::size_t j = i % grid.columns; j < cells.size(); j += grid.columns) {
      cells[i].left_px = std::max(cells[i].left_px, cells[j].left_px);
      cells[i].right_px = std::max(cells[i].right_px, cells[j].right_px);
    }
}

std::vector<Cell> lay_out(const Figure& figure, const Grid& grid) {
  std::vector<Cell> cells = cells_with_data_ranges(figure);
  share_ranges(figure, grid, cells);
  for (Cell& cell : cells) {
    pad_ranges(cell);
    set_margins(cell);
  }
  align_columns(grid, cells);
  return cells;
}

PlotArea plot_area(const Cell& cell, double cell_left, double cell_width, double top) {
  const Axis &x = cell.panel->x_axis, &y = cell.panel->y_axis;
  const double width = std::max(40.0, cell_width - cell.left_px - cell.right_px), height = cell.panel->height_px;
  return {cell_left + cell.left_px,
          top,
          width,
          height,
          Mapping{cell.range.x, x.scale, width, false, x.linear_within},
          Mapping{cell.range.y, y.scale, height, true, y.linear_within}};
}

std::string draw_plot(const Cell& cell) {
  const PlotArea& a = cell.area;
  std::string out = draw_axes(cell);
  out += "<svg x=\"" + coordinate(a.left) + "\" y=\"" + coordinate(a.top) + "\" width=\"" + coordinate(a.width) +
         "\" height=\"" + coordinate(a.height) + "\" viewBox=\"0 0 " + coordinate(a.width * 10) + " " +
         coordinate(a.height * 10) + "\" overflow=\"hidden\">" + draw_clipped(*cell.panel, a) + "</svg>" +
         draw_texts(*cell.panel, a);
  if (const HeatMap* map = colour_bar_of(*cell.panel)) out += draw_colour_bar(*map, cell);
  if (cell.panel->direct_labels) out += draw_direct_labels(cell);
  return out;
}

// The cells of one row from `top` on, which moves down by their height.
std::string draw_row(std::vector<Cell>& cells, const Grid& grid, std::size_t row, double& top) {
  const std::size_t begin = row * grid.columns, end = std::min(cells.size(), begin + grid.columns);
  double header = 0.0, plot = 0.0, footer = 0.0;
  std::vector<std::string> headers;
  for (std::size_t i = begin; i < end; ++i) {
    double height = 0.0;
    headers.push_back(draw_header(cells[i], grid.left_px(i), top, grid.cell_width_px, &height));
    header = std::max(header, height);
    plot = std::max(plot, cells[i].panel->height_px);
    footer = std::max(footer, cells[i].footer_px);
  }
  std::string out;
  for (std::size_t i = begin; i < end; ++i) {
    cells[i].area = plot_area(cells[i], grid.left_px(i), grid.cell_width_px, top + header);
    out += headers[i - begin] + draw_plot(cells[i]);
  }
  top += header + plot + footer + kPanelGap_px;
  return out;
}

std::string svg_element(const Figure& figure, bool alone, double height_px, const std::string& body) {
  const double margin = alone ? 8.0 : 0.0;
  const std::string w = coordinate(figure.width_px + 2 * margin), h = coordinate(height_px + (alone ? 4.0 : 0.0));
  std::string out = "<svg class=\"fig\" role=\"img\" ";
  if (alone) out += "xmlns=\"http://www.w3.org/2000/svg\" ";
  out += "width=\"" + w + "\" height=\"" + h + "\" viewBox=\"" + coordinate(-margin) + " 0 " + w + " " + h + "\">";
  out += "<title>" + escape(figure.title) + "</title>";
  if (!figure.summary.empty()) out += "<desc>" + escape(figure.summary) + "</desc>";
  if (alone)
    out += "<style>" + figure_css(false) + "</style><rect class=\"pg\" x=\"" + coordinate(-margin) +
           "\" width=\"" + w + "\" height=\"" + h + "\"/>";
  return out + body + "</svg>" + (alone ? "\n" : "");
}

}  // namespace

std::string Figure::svg(Target target) const {
  const bool alone = target == Target::standalone;
  const Grid grid = grid_of(*this);
  std::vector<Cell> cells = lay_out(*this, grid);
  std::string body;
  double y = alone ? 6.0 : 2.0;
  if (show_title) {
    body += text_element(0.0, y + 13.0, title, Anchor::left, "k b");
    y += 22.0;
  }
  for (std::size_t row = 0; row < grid.rows; ++row) body += draw_row(cells, grid, row, y);
  return svg_element(*this, alone, y - kPanelGap_px + 2.0, body);
}

}  // namespace forcegate::figures
