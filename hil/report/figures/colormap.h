#pragma once
// Colours for maps. Sequential: cividis (Nunez et al. 2018), even in lightness for every colour vision.
// Signed: blue - white - vermillion, symmetric about 0. Fraction in [0, 1]; quantised to 17 levels to keep
// files small.

#include <string>

namespace forcegate::figures {

inline constexpr int kColourLevels = 17;

/// Level 0 ... kColourLevels - 1 of a fraction; NaN gives -1.
int colour_level(double fraction);

/// "#rrggbb" of a level.
std::string sequential_colour(int level);
std::string diverging_colour(int level);

/// Ink that reads on that colour: "#000" or "#fff".
std::string ink_on(const std::string& colour);

}  // namespace forcegate::figures
