#pragma once
// Text for people: printable filter, suggestions, numbers with uncertainty.

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace forcegate {

/// Replaces control bytes, and bytes that are not valid UTF-8, by U+FFFD; keeps \n and \t. Every text
/// that comes from a device or a foreign file passes here before any report.
std::string printable_utf8(std::string_view bytes);

/// Damerau-Levenshtein distance (insert, delete, replace, swap neighbours).
std::size_t edit_distance(std::string_view a, std::string_view b);

/// The candidate nearest to `word` if it is near enough to be a typing mistake, else "".
std::string nearest_name(std::string_view word, std::span<const std::string> candidates);

/// "4.5(3)": the value to the last digit of its standard uncertainty u (two digits of u when its
/// leading digit is 1 or 2: "4.52(12)"). u <= 0 or not finite: four significant digits.
std::string with_uncertainty(double value, double u);

/// Shortest text that reads back as the same double; "nan", "inf", "-inf" for those.
std::string shortest(double value);

std::vector<std::string> split(std::string_view text, char separator);
std::string_view trim(std::string_view text);
/// A to Z only, whatever the locale.
std::string ascii_lower(std::string_view text);
/// Order of file names for people: "run2" before "run10". Runs of digits compare as numbers; equal ones by their bytes.
bool natural_less(std::string_view a, std::string_view b);
/// `text` as one word of a POSIX shell.
std::string shell_quoted(std::string_view text);
/// The same of a file, which may not be taken for an option: "./-q.csv".
std::string file_quoted(std::string_view file);
std::string join(std::span<const std::string> parts, std::string_view separator);

}  // namespace forcegate
