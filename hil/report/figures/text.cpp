#include "hil/report/figures/text.h"

#include <fmt/format.h>

#include <cmath>

#include "hil/base/text.h"

namespace forcegate::figures {

std::string escape(std::string_view text) {
  const std::string clean = printable_utf8(text);
  std::string out;
  out.reserve(clean.size() + clean.size() / 8);
  for (const char c : clean) {
    switch (c) {
      case '&': out += "&amp;"; break;
      case '<': out += "&lt;"; break;
      case '>': out += "&gt;"; break;
      case '"': out += "&quot;"; break;
      case '\'': out += "&#39;"; break;
      default: out += c;
    }
  }
  return out;
}

std::string coordinate(double value, int decimals) {
  if (!std::isfinite(value)) return "0";
  std::string text = fmt::format("{:.{}f}", value, decimals);
  if (text.find('.') != std::string::npos) {
    text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.') text.pop_back();
  }
  return text == "-0" ? "0" : text;
}

std::string typographic_minus(std::string_view number) {
  std::string out;
  for (std::size_t i = 0; i < number.size(); ++i) {
    const bool starts_number =
        number[i] == '-' && i + 1 < number.size() &&
        ((number[i + 1] >= '0' && number[i + 1] <= '9') || number[i + 1] == '.') &&
        (i == 0 || number[i - 1] == ' ' || number[i - 1] == '(' || number[i - 1] == 'e');
    if (starts_number)
      out += "\u2212";
    else
      out += number[i];
  }
  return out;
}

std::string display(double value, int digits) {
  if (std::isnan(value)) return "not measured";
  if (std::isinf(value)) return value > 0 ? "\u221e" : "\u2212\u221e";
  if (value == 0.0) return "0";
  const double size = std::abs(value);
  std::string text;
  if (size >= 1e6 && size < 1e15 && value == std::floor(value))
    return typographic_minus(coordinate(value, 0));
  if (size >= 1e-4 && size < 1e6) {
    const int before = static_cast<int>(std::floor(std::log10(size))) + 1;
    text = coordinate(value, std::max(0, digits - before));
  } else {
    text = fmt::format("{:.{}g}", value, digits);
    if (const auto e = text.find('e'); e != std::string::npos) {
      int power = 0;
      const bool negative = text[e + 1] == '-';
      for (const char c : text.substr(e + 2)) power = power * 10 + (c - '0');
      text = text.substr(0, e) + "e" + (negative ? "-" : "") + std::to_string(power);
    }
  }
  return typographic_minus(text);
}

double text_width_px(std::string_view utf8, double size_px) {
  double em = 0.0;
  for (const char ch : utf8) {
    const auto c = static_cast<unsigned char>(ch);
    if ((c & 0xC0) == 0x80) continue;
    if (c >= 0x80)
      em += 0.68;
    else if (std::string_view("iljtfrI.,:;|'!()[]/ ").find(ch) != std::string_view::npos)
      em += 0.37;
    else if (std::string_view("mwMW%@").find(ch) != std::string_view::npos)
      em += 0.93;
    else if (c >= 'A' && c <= 'Z')
      em += 0.69;
    else
      em += 0.62;
  }
  return em * size_px;
}

std::string shorten(std::string_view utf8, std::size_t max_chars) {
  std::size_t count = 0;
  for (const char c : utf8) count += (static_cast<unsigned char>(c) & 0xC0) != 0x80;
  if (count <= max_chars || max_chars < 3) return std::string(utf8);
  const std::size_t head = (max_chars - 1) / 2, tail = max_chars - 1 - head;
  std::string start, end;
  std::size_t at = 0;
  for (std::size_t i = 0; i < utf8.size();) {
    std::size_t next = i + 1;
    while (next < utf8.size() && (static_cast<unsigned char>(utf8[next]) & 0xC0) == 0x80) ++next;
    if (at < head) start += utf8.substr(i, next - i);
    if (at >= count - tail) end += utf8.substr(i, next - i);
    ++at;
    i = next;
  }
  return start + "\u2026" + end;
}

}  // namespace forcegate::figures
