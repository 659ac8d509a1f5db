#pragma once
// A value with its expanded uncertainty against its limit, small enough for a table cell.

#include <string>

#include "hil/report/figures/style.h"

namespace forcegate::figures {

struct Bullet {
  double value = 0.0;
  double expanded_u = 0.0;  ///< U = k u; 0 or NaN: no whisker
  double limit = 0.0;       ///< > 0
  bool lower = false;       ///< the value must be at least the limit
  Role role = Role::pass;   ///< colour of the bar; the verdict stands beside it in words
  std::string text;         ///< accessible name: "6.1(4) % against at most 4.5 %"
  double width_px = 190.0;
};

/// Bar from 0 to the value, whisker +-U, tick at the limit over the allowed zone. The axis ends at 2.2
/// limits; a bar that would leave it ends in an arrow. "" when value or limit cannot be drawn (NaN, negative,
/// limit <= 0).
std::string bullet_svg(const Bullet& bullet);

}  // namespace forcegate::figures
