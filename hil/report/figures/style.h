#pragma once
// What a colour means. Palette of Okabe and Ito (readable with any colour vision); never colour alone: every
// role also has its dash or marker, chosen by the caller, and a word in the legend.

#include <span>
#include <string>
#include <string_view>

namespace forcegate::figures {

enum class Role {
  reference,  ///< ATI: ink (black on white, white on black)
  firmware,   ///< device under test: vermillion
  setpoint,   ///< grey, dashed by convention
  golden,     ///< blue, dashed by convention
  model,      ///< blue
  raw,        ///< sensor without compensation: brown
  rising,     ///< bluish green
  falling,    ///< reddish purple
  muted,      ///< grey: context, not the subject
  pass,       ///< dark green, for words and bars of judged values
  fail,       ///< dark vermillion
  warn,       ///< dark amber: marginal, inconclusive
};

/// Class of the role in the style sheet, two letters: "fw".
std::string_view role_class(Role role);

struct RoleColours {
  Role role;
  std::string_view name;                   ///< class and custom property "--fw"
  std::string_view line_light, line_dark;  ///< contrast to the page >= 3 : 1
  std::string_view text_light, text_dark;  ///< contrast to the page >= 4.5 : 1
};
std::span<const RoleColours> role_colours();

inline constexpr std::string_view kPageLight = "#ffffff", kPageDark = "#14171a";
inline constexpr std::string_view kInkLight = "#1a1a1a", kInkDark = "#e8e6e3";
inline constexpr std::string_view kQuietLight = "#595959", kQuietDark = "#a8a5a0";
inline constexpr std::string_view kGridLight = "#e3e3e3", kGridDark = "#33383d";

/// Rules for elements inside an SVG of class "fig". With variables the colours are custom properties that
/// theme_css() sets, else they are the light ones, written out (viewers outside a browser know no
/// properties).
std::string figure_css(bool variables);

/// :root{--fw:...} for a light page and the same inside prefers-color-scheme: dark. Print is always light.
std::string theme_css();

/// Contrast ratio of two "#rrggbb" colours by WCAG 2.1, 1 to 21.
double contrast_ratio(std::string_view a, std::string_view b);

}  // namespace forcegate::figures
