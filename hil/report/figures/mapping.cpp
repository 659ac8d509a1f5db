#include "hil/report/figures/mapping.h"

namespace forcegate::figures {
namespace {

struct Collect {
  PanelRange& r;
  bool log_x, log_y;

  void x(double v) const {
    if (!log_x || v > 0.0) r.x.include(v);
  }
  void y(double v) const {
    if (!log_y || v > 0.0) r.y.include(v);
  }
  void operator()(const LineSeries& s) const {
    for (std::size_t i = 0; i < s.x.size() && i < s.y.size(); ++i)
      if (!std::isnan(s.y[i])) x(s.x[i]), y(s.y[i]);
  }
  void operator()(const PointSeries& s) const {
    for (std::size_t i = 0; i < s.x.size() && i < s.y.size(); ++i) {
      if (std::isnan(s.x[i]) || std::isnan(s.y[i])) continue;
      const double ux = i < s.u_x.size() && std::isfinite(s.u_x[i]) ? s.u_x[i] : 0.0;
      const double uy = i < s.u_y.size() && std::isfinite(s.u_y[i]) ? s.u_y[i] : 0.0;
      x(s.x[i] - ux), x(s.x[i] + ux), y(s.y[i] - uy), y(s.y[i] + uy);
    }
  }
  void operator()(const BandSeries& s) const {
    for (const double v : s.x) x(v);
    for (const double v : s.low) y(v);
    for (const double v : s.high) y(v);
  }
  void operator()(const BarSeries& s) const {
    for (const Bar& b : s.bars) {
      const double u = std::isfinite(b.u) ? b.u : 0.0;
      for (const double along : {b.base, b.value - u, b.value + u}) s.horizontal ? x(along) : y(along);
      for (const double across : {b.position - 0.6, b.position + 0.6}) s.horizontal ? y(across) : x(across);
    }
  }
  void operator()(const HeatMap& s) const {
    for (const double v : s.x_edges) x(v);
    for (const double v : s.y_edges) y(v);
  }
  void operator()(const Density& s) const { x(s.x_low), x(s.x_high), y(s.y_low), y(s.y_high); }
  void operator()(const Rule& s) const { s.horizontal ? y(s.at) : x(s.at); }
  void operator()(const Span& s) const { x(s.x_low), x(s.x_high); }
  void operator()(const Note&) const {}
};

}  // namespace

PanelRange data_range(const Panel& panel) {
  PanelRange range;
  const Collect collect{range, panel.x_axis.scale == Scale::logarithmic,
                        panel.y_axis.scale == Scale::logarithmic};
  for (const Series& s : panel.series) std::visit(collect, s);
  return range;
}

Range finish_range(const Axis& axis, Range data, double margin) {
  const bool log = axis.scale == Scale::logarithmic;
  if (!axis.categories.empty()) {
    const double last = static_cast<double>(axis.categories.size()) - 1.0;
    return {std::isnan(axis.low) ? -0.6 : axis.low, std::isnan(axis.high) ? last + 0.6 : axis.high};
  }
  if (!data.known() || !std::isfinite(data.high - data.low)) data = log ? Range{1.0, 10.0} : Range{0.0, 1.0};
  if (axis.include_zero && !log) data.include(0.0);
  if (log) {
    double low = std::log(data.low), high = std::log(data.high);
    if (high - low < 1e-6) low -= 0.5, high += 0.5;
    const double pad = margin * (high - low);
    data = {std::exp(low - pad), std::exp(high + pad)};
  } else {
    if (!(data.high - data.low > 1e-9 * std::max({std::abs(data.low), std::abs(data.high), 1e-300}))) {
      const double half = data.high == 0.0 ? 1.0 : 0.1 * std::abs(data.high);
      data = {data.low - half, data.high + half};
    }
    const bool bent = axis.scale == Scale::symmetric_log;
    const auto position = [&](double v) { return bent ? std::asinh(v / axis.linear_within) : v; };
    const auto value = [&](double at) { return bent ? axis.linear_within * std::sinh(at) : at; };
    const double pad = margin * (position(data.high) - position(data.low));
    const bool zero_edge_low = axis.include_zero && data.low == 0.0,
               zero_edge_high = axis.include_zero && data.high == 0.0;
    data = {zero_edge_low ? 0.0 : value(position(data.low) - pad), zero_edge_high ? 0.0 : value(position(data.high) + pad)};
  }
  if (axis.symmetric) {
    const double reach = std::max(std::abs(data.low), std::abs(data.high));
    data = {-reach, reach};
  }
  if (!std::isnan(axis.low)) data.low = axis.low;
  if (!std::isnan(axis.high)) data.high = axis.high;
  if (!(data.high > data.low)) data.high = log ? data.low * 10.0 : data.low + 1.0;
  return data;
}

}  // namespace forcegate::figures
