#pragma once
// Decimal text to double, correctly rounded.

#include <charconv>
#include <cstdint>

namespace forcegate {

/// Reads [-]digits[POINT digits] at p and returns where it ends, or nullptr when the text is something else or
/// needs more than 2^53 (the caller then takes the slow way). Up to 2^53 the digits are exact, as is 10^k up to
/// k = 22, so that the one division rounds correctly (Clinger 1990). The text must end in a byte that is neither a
/// digit nor POINT, for instance the line end.
inline const char* read_plain_decimal(const char* p, char point, double& out) {
  static constexpr double kPowers[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                                       1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
  const bool negative = *p == '-';
  p += negative;
  std::uint64_t digits = 0;
  const char* const start = p;
  unsigned digit;
  while ((digit = static_cast<unsigned char>(*p) - unsigned{'0'}) < 10) digits = digits * 10 + digit, ++p;
  auto count = p - start;
  std::ptrdiff_t decimals = 0;
  if (*p == point) {
    const char* const fraction = ++p;
    while ((digit = static_cast<unsigned char>(*p) - unsigned{'0'}) < 10) digits = digits * 10 + digit, ++p;
    decimals = p - fraction;
    count += decimals;
  }
  if (count == 0 || count > 18 || digits > (std::uint64_t{1} << 53) || (*p | 0x20) == 'e') return nullptr;
  const double value = static_cast<double>(digits) / kPowers[decimals];
  out = negative ? -value : value;
  return p;
}

}  // namespace forcegate
