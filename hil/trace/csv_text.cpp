#include "hil/trace/csv_text.h"

#include <algorithm>
#include <cstdint>

namespace forcegate {
namespace {

enum class Encoding { plain, utf16_little, utf16_big };

constexpr std::size_t kLookedAt = 65536;

Encoding encoding_of(std::string_view bytes) {
  if (bytes.starts_with("\xFF\xFE")) return Encoding::utf16_little;
  if (bytes.starts_with("\xFE\xFF")) return Encoding::utf16_big;
  constexpr std::size_t kLetters = 8;
  if (bytes.size() < 2 * kLetters) return Encoding::plain;
  std::size_t even = 0, odd = 0;
  for (std::size_t i = 0; i < 2 * kLetters; ++i) (i % 2 == 0 ? even : odd) += bytes[i] == 0;
  return odd == kLetters && even == 0 ? Encoding::utf16_little : even == kLetters && odd == 0 ? Encoding::utf16_big : Encoding::plain;
}

bool ends_lines_in_cr(std::string_view bytes) {
  return bytes.find('\n') == std::string_view::npos && bytes.find('\r') != std::string_view::npos && bytes.find('\0') == std::string_view::npos;
}

void append_utf8(std::uint32_t code, std::string& out) {
  const auto put = [&](std::uint32_t byte) { out += static_cast<char>(byte); };
  if (code < 0x80) return put(code);
  if (code < 0x800) return put(0xC0 | code >> 6), put(0x80 | (code & 0x3F));
  if (code < 0x10000) return put(0xE0 | code >> 12), put(0x80 | (code >> 6 & 0x3F)), put(0x80 | (code & 0x3F));
  put(0xF0 | code >> 18), put(0x80 | (code >> 12 & 0x3F)), put(0x80 | (code >> 6 & 0x3F)), put(0x80 | (code & 0x3F));
}

std::string utf8_of_utf16(std::string_view bytes, bool big) {
  const auto unit = [&](std::size_t i) {
    const auto first = static_cast<unsigned char>(bytes[i]), second = static_cast<unsigned char>(bytes[i + 1]);
    return static_cast<std::uint32_t>(big ? first << 8 | second : second << 8 | first);
  };
  std::string out;
  out.reserve(bytes.size() / 2);
  for (std::size_t i = 0; i + 1 < bytes.size(); i += 2) {
    std::uint32_t code = unit(i);
    if (code == 0xFEFF) continue;
    const bool leads = code >= 0xD800 && code < 0xDC00;
    const std::uint32_t behind = leads && i + 3 < bytes.size() ? unit(i + 2) : 0;
    if (behind >= 0xDC00 && behind < 0xE000) {
      code = 0x10000 + ((code - 0xD800) << 10) + (behind - 0xDC00);
      i += 2;
    } else if (code >= 0xD800 && code < 0xE000) {
      code = 0xFFFD;
    }
    append_utf8(code, out);
  }
  return out;
}

}  // namespace

bool needs_rewriting(std::string_view bytes) {
  bytes = bytes.substr(0, kLookedAt);
  return encoding_of(bytes) != Encoding::plain || ends_lines_in_cr(bytes);
}

RewrittenText rewritten(std::string_view bytes) {
  const Encoding encoding = encoding_of(bytes);
  RewrittenText out;
  out.text = encoding == Encoding::plain ? std::string(bytes) : utf8_of_utf16(bytes, encoding == Encoding::utf16_big);
  if (encoding != Encoding::plain) out.note = "the text is UTF-16";
  if (ends_lines_in_cr(std::string_view(out.text).substr(0, kLookedAt))) {
    std::ranges::replace(out.text, '\r', '\n');
    out.note += out.note.empty() ? "the lines end in CR alone" : ", its lines end in CR alone";
  }
  return out;
}

}  // namespace forcegate
