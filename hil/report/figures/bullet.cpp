#include "hil/report/figures/bullet.h"

#include <algorithm>
#include <cmath>

#include "hil/report/figures/text.h"

namespace forcegate::figures {

std::string bullet_svg(const Bullet& b) {
  if (!std::isfinite(b.value) || b.value < 0.0 || !std::isfinite(b.limit) || !(b.limit > 0.0)) return {};
  constexpr double kHeight = 18.0, kBarTop = 6.0, kBarHeight = 6.0, kMost = 2.2;
  const double u = std::isfinite(b.expanded_u) && b.expanded_u > 0.0 ? b.expanded_u : 0.0;
  const double end = std::clamp(1.08 * std::max(b.value + u, b.limit * 1.15), 1e-300, kMost * b.limit);
  const double usable = b.width_px - 8.0;
  const auto at = [&](double v) { return coordinate(std::clamp(v / end, 0.0, 1.0) * usable); };
  const bool beyond = b.value > end;
  const std::string role(role_class(b.role));

  const auto rect = [](const std::string& classes, const std::string& x, const std::string& width, double top,
                       double height) {
    return "<rect class=\"" + classes + "\" x=\"" + x + "\" y=\"" + coordinate(top) + "\" width=\"" + width +
           "\" height=\"" + coordinate(height) + "\"/>";
  };
  std::string out = "<svg class=\"fig bu\" role=\"img\" width=\"" + coordinate(b.width_px) +
                    "\" height=\"18\" viewBox=\"0 0 " + coordinate(b.width_px) + " 18\"><title>" +
                    escape(b.text) + "</title>";
  out += b.lower ? rect("zo", at(b.limit), coordinate(usable - std::min(1.0, b.limit / end) * usable), 2,
                        kHeight - 4)
                 : rect("zo", "0", at(b.limit), 2, kHeight - 4);
  out += rect("f " + role, "0", at(b.value), kBarTop, kBarHeight);
  if (beyond)
    out += "<path class=\"f " + role + "\" d=\"M" + coordinate(usable) + " " + coordinate(kBarTop - 2) +
           "l7 5l-7 5z\"/>";
  else if (u > 0.0)
    out += "<path class=\"l rf\" stroke-width=\"1.3\" d=\"M" + at(b.value - u) + " 9H" + at(b.value + u) +
           "M" + at(b.value - u) + " 5.5v7M" + at(b.value + u) + " 5.5v7\"/>";
  return out + "<path class=\"l rf\" stroke-width=\"2\" d=\"M" + at(b.limit) + " 0V18\"/></svg>";
}

}  // namespace forcegate::figures
