#pragma once
// Draws the series of one panel inside its plot rectangle. Private to the figures library.

#include <string>

#include "hil/report/figures/figure.h"
#include "hil/report/figures/mapping.h"

namespace forcegate::figures {

struct PlotArea {
  double left = 0, top = 0, width = 0, height = 0;  ///< px in the figure
  Mapping x, y;                                     ///< data to px inside the plot
};

/// Marks that the plot rectangle clips (coordinates in tenths of a pixel from its upper left corner).
std::string draw_clipped(const Panel& panel, const PlotArea& area);

/// Texts that may reach over the rectangle (figure coordinates).
std::string draw_texts(const Panel& panel, const PlotArea& area);

/// Limits of the colours of a map.
Range heat_map_range(const HeatMap& map);

/// Swatch of a series for a legend: `width_px` wide, centred at y (figure coordinates).
std::string draw_swatch(const Series& series, double x_px, double y_px, double width_px);

/// Label of a series for the legend, "" for those that have none.
std::string legend_label(const Series& series);

/// <text>; `classes` such as "k b fw".
std::string text_element(double x_px, double y_px, std::string_view text, Anchor anchor,
                         std::string_view classes);

}  // namespace forcegate::figures
