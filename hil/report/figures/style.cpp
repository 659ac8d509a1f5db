#include "hil/report/figures/style.h"

#include <array>
#include <cmath>
#include <utility>

namespace forcegate::figures {
namespace {

constexpr std::array<RoleColours, 12> kRoles{{
    {Role::reference, "rf", "#000000", "#ffffff", "#000000", "#ffffff"},
    {Role::firmware, "fw", "#d55e00", "#f0803c", "#a33f00", "#ff9a5c"},
    {Role::setpoint, "sp", "#767676", "#a0a0a0", "#595959", "#b8b8b8"},
    {Role::golden, "gd", "#0072b2", "#4da6e0", "#00578a", "#7cc0ee"},
    {Role::model, "md", "#0072b2", "#4da6e0", "#00578a", "#7cc0ee"},
    {Role::raw, "rw", "#8c6239", "#c79a6b", "#6e4a28", "#d9b28a"},
    {Role::rising, "up", "#009270", "#2bbd97", "#00664a", "#4fd1ae"},
    {Role::falling, "dn", "#c06a96", "#d98fb7", "#8f3f6b", "#e8a9cb"},
    {Role::muted, "mu", "#8a8a8a", "#7d838a", "#595959", "#a8a5a0"},
    {Role::pass, "ok", "#00795a", "#35b892", "#00664a", "#4fd1ae"},
    {Role::fail, "no", "#c04a00", "#ff8a4a", "#a33f00", "#ff9a5c"},
    {Role::warn, "wa", "#8a6100", "#d9a72e", "#6f4e00", "#e5b84a"},
}};

void add_root(std::string& css, bool dark) {
  const auto add = [&](std::string_view name, std::string_view value) {
    css.append("--").append(name).append(":").append(value).append(";");
  };
  add("page", dark ? kPageDark : kPageLight);
  add("ink", dark ? kInkDark : kInkLight);
  add("quiet", dark ? kQuietDark : kQuietLight);
  add("grid", dark ? kGridDark : kGridLight);
  for (const RoleColours& r : kRoles) {
    add(r.name, dark ? r.line_dark : r.line_light);
    add(std::string(r.name) + "t", dark ? r.text_dark : r.text_light);
  }
}

double luminance(std::string_view colour) {
  const auto digit = [](char c) { return c <= '9' ? c - '0' : (c | 32) - 'a' + 10; };
  const auto channel = [&](std::size_t at) {
    const double v = (digit(colour[at]) * 16 + digit(colour[at + 1])) / 255.0;
    return v <= 0.03928 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
  };
  return 0.2126 * channel(1) + 0.7152 * channel(3) + 0.0722 * channel(5);
}

}  // namespace

std::span<const RoleColours> role_colours() { return kRoles; }

std::string_view role_class(Role role) {
  for (const RoleColours& r : kRoles)
    if (r.role == role) return r.name;
  return "rf";
}

std::string figure_css(bool variables) {
  const auto colour = [&](std::string_view name, std::string_view light) {
    return variables ? "var(--" + std::string(name) + ")" : std::string(light);
  };
  std::string css =
      ".fig{font-family:system-ui,'Segoe UI',Helvetica,Arial,sans-serif;font-size:11px}"
      ".fig text{fill:" +
      colour("quiet", kQuietLight) +
      "}"
      ".fig .b{font-weight:600}"
      ".fig text.k{fill:" +
      colour("ink", kInkLight) +
      "}"
      ".fig .g{stroke:" +
      colour("grid", kGridLight) +
      ";stroke-width:1;fill:none}"
      ".fig .ax{stroke:" +
      colour("quiet", kQuietLight) +
      ";stroke-width:1;fill:none}"
      ".fig .pg{fill:" +
      colour("page", kPageLight) +
      "}"
      ".fig .l{fill:none;stroke:currentColor;stroke-linejoin:round}"
      ".fig .p{fill:none;stroke:currentColor;stroke-linecap:round}"
      ".fig .hole{stroke:" +
      colour("page", kPageLight) +
      "}"
      ".fig .f{fill:currentColor;stroke:none}"
      ".fig .h{fill:" +
      colour("page", kPageLight) +
      ";stroke:currentColor}"
      ".fig text.u{paint-order:stroke;stroke:" +
      colour("page", kPageLight) +
      ";stroke-width:3px;stroke-linejoin:round}"
      ".fig .zo{fill:" +
      colour("grid", kGridLight) +
      "}"
      ".fig text.iw{fill:#fff}.fig text.ib{fill:#000}";
  for (const RoleColours& r : kRoles) {
    const std::string name(r.name);
    css += ".fig ." + name + "{color:" + colour(name, r.line_light) + "}";
    css += ".fig text." + name + "{fill:" + colour(name + "t", r.text_light) + "}";
  }
  return css;
}

std::string theme_css() {
  std::string css = ":root{color-scheme:light dark;";
  add_root(css, false);
  css += "}@media screen and (prefers-color-scheme:dark){:root{";
  add_root(css, true);
  css += "}}";
  return css;
}

double contrast_ratio(std::string_view a, std::string_view b) {
  double la = luminance(a), lb = luminance(b);
  if (la < lb) std::swap(la, lb);
  return (la + 0.05) / (lb + 0.05);
}

}  // namespace forcegate::figures
