#include "adapters/ati/record.h"

#include <algorithm>

namespace forcegate::ati {
namespace {

constexpr std::size_t kLongestLine = 120;
constexpr int kLargestError = 9;  // one digit in text

// Blanks, sign, one to six digits, blanks. False when the text is anything else.
bool read_number(std::string_view text, int& out) {
  std::size_t i = 0;
  while (i < text.size() && text[i] == ' ') ++i;
  bool negative = false;
  if (i < text.size() && (text[i] == '-' || text[i] == '+')) negative = text[i++] == '-';
  int value = 0, digits = 0;
  for (; i < text.size() && text[i] >= '0' && text[i] <= '9' && digits < 7; ++i, ++digits)
    value = value * 10 + (text[i] - '0');
  while (i < text.size() && text[i] == ' ') ++i;
  if (i != text.size() || digits == 0 || digits > 6) return false;
  out = negative ? -value : value;
  return true;
}

}  // namespace

ParseResult parse_binary(std::span<const std::uint8_t> stream, bool checksum) {
  ParseResult result;
  const std::size_t size = checksum ? 14 : 13;
  if (stream.size() < size) return result;
  result.consumed = size;
  if (checksum) {
    unsigned sum = 0;
    for (std::size_t i = 0; i < 13; ++i) sum += stream[i];
    if ((sum & 0xFFU) != stream[13]) {
      result.kind = Parse::invalid;
      result.reason = "checksum";
      return result;
    }
  }
  if (stream[0] > kLargestError) {
    result.kind = Parse::invalid;
    result.reason = "error byte";
    return result;
  }
  result.kind = Parse::value;
  result.record.error = stream[0];
  for (std::size_t axis = 0; axis < 6; ++axis) {
    const auto bits = static_cast<std::uint16_t>(stream[1 + 2 * axis] << 8 | stream[2 + 2 * axis]);
    result.record.counts[axis] = static_cast<std::int16_t>(bits);
  }
  return result;
}

ParseResult parse_ascii(std::span<const std::uint8_t> stream, std::size_t width) {
  ParseResult result;
  const auto end = std::find(stream.begin(), stream.end(), std::uint8_t{'\n'});
  if (end == stream.end()) {
    if (stream.size() > kLongestLine) result = {Parse::invalid, stream.size(), {}, "line too long"};
    return result;
  }
  result.consumed = static_cast<std::size_t>(end - stream.begin()) + 1;
  const auto invalid = [&](std::string_view reason) {
    result.kind = Parse::invalid;
    result.reason = reason;
    return result;
  };
  if (width != 0 && result.consumed != width) return invalid("line length");
  std::string_view line(reinterpret_cast<const char*>(stream.data()), result.consumed - 1);
  if (line.empty() || line.back() != '\r') return invalid("no CR before LF");
  line.remove_suffix(1);
  int field = 0, values[7] = {};
  while (field < 7) {
    const std::size_t comma = line.find(',');
    if (!read_number(line.substr(0, comma), values[field])) return invalid("not a number");
    ++field;
    if (comma == std::string_view::npos) {
      line = {};
      break;
    }
    line.remove_prefix(comma + 1);
    if (field == 7) return invalid("too many fields");
  }
  if (field != 7) return invalid("too few fields");
  if (values[0] < 0 || values[0] > kLargestError) return invalid("error digit");
  result.record.error = static_cast<std::uint8_t>(values[0]);
  for (std::size_t axis = 0; axis < 6; ++axis) {
    if (values[axis + 1] < -32768 || values[axis + 1] > 32767) return invalid("count out of range");
    result.record.counts[axis] = values[axis + 1];
  }
  result.kind = Parse::value;
  return result;
}

}  // namespace forcegate::ati
