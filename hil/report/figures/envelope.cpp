#include "hil/report/figures/envelope.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace forcegate::figures {

Envelope envelope(const std::vector<double>& x, const std::vector<double>& y, std::size_t stretches) {
  Envelope out;
  const double from = x.front(), width = (x.back() - from) / static_cast<double>(stretches);
  for (std::size_t s = 0; s < stretches; ++s) out.x.push_back(from + (static_cast<double>(s) + 0.5) * width);
  out.low.assign(stretches, NAN);
  out.high.assign(stretches, NAN);
  for (std::size_t i = 0; i < std::min(x.size(), y.size()); ++i) {
    if (!std::isfinite(y[i])) continue;
    const std::size_t s = std::min(stretches - 1, static_cast<std::size_t>((x[i] - from) / width));
    out.low[s] = std::fmin(out.low[s], y[i]);
    out.high[s] = std::fmax(out.high[s], y[i]);
  }
  return out;
}

void add_band(Panel& panel, const Envelope& e, Role role, double opacity, std::string label) {
  for (std::size_t i = 0; i < e.x.size();) {
    std::size_t end = i;
    while (end < e.x.size() && std::isfinite(e.low[end])) ++end;
    const auto part = [&](const std::vector<double>& v) {
      return std::vector<double>(v.begin() + static_cast<std::ptrdiff_t>(i), v.begin() + static_cast<std::ptrdiff_t>(end));
    };
    if (end > i + 1) panel.band(part(e.x), part(e.low), part(e.high), role, std::exchange(label, {}), opacity);
    i = end + 1;
  }
}

}  // namespace forcegate::figures
