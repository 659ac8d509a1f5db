#pragma once
// Text and numbers for SVG and HTML: escaped, locale-free, with a bounded number of digits so that equal
// inputs give equal bytes and files stay small.

#include <string>
#include <string_view>

namespace forcegate::figures {

/// printable_utf8, then & < > " ' as entities: safe as element content and inside a quoted attribute.
std::string escape(std::string_view text);

/// `value` with at most `decimals` decimals, no trailing zeros, never "-0"; "0" when it is not finite.
std::string coordinate(double value, int decimals = 1);

/// A number for people: U+2212 for minus, at most `digits` significant digits, powers of ten written as
/// "2.5e−6" outside [1e-4, 1e6); whole numbers below 1e15 are written out. "not measured" for NaN, "∞" for
/// infinity.
std::string display(double value, int digits = 4);

/// ASCII minus signs that start a number become U+2212.
std::string typographic_minus(std::string_view number);

/// Estimated width of one line in a sans-serif face of `size_px`; a little generous, so that text laid out
/// with it does not collide whatever font the reader has.
double text_width_px(std::string_view utf8, double size_px);

/// The text, shortened in the middle with an ellipsis to at most `max_chars` code points.
std::string shorten(std::string_view utf8, std::size_t max_chars);

}  // namespace forcegate::figures
