#include "hil/trace/csv_text.h"

#include <algorithm>
#include <cstdint>

namespace forcegate {
namespace {

enum class Encoding { plain, utf16_little, utf16_big, utf32_little, utf32_big };

constexpr std::size_t kLookedAt = 65536;

Encoding encoding_of(std::string_view bytes) {
  if (bytes.starts_with(std::string_view("\xFF\xFE\0\0", 4))) return Encoding::utf32_little;
  if (bytes.starts_with(std::string_view("\0\0\xFE\xFF", 4))) return Encoding::utf32_big;
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

std::string utf8_of_utf32(std::string_view bytes, bool big) {
  constexpr std::size_t kBytes = 4;
  constexpr std::uint32_t kMark = 0xFEFF, kNoCharacter = 0xFFFD, kLast = 0x10FFFF;
  std::string out;
  out.reserve(bytes.size() / kBytes);
  for (std::size_t i = 0; i + kBytes <= bytes.size(); i += kBytes) {
    std::uint32_t code = 0;
    for (std::size_t k = 0; k < kBytes; ++k) code = code << 8 | static_cast<unsigned char>(bytes[big ? i + k : i + kBytes - 1 - k]);
    if (code != kMark) append_utf8(code > kLast || (code >= 0xD800 && code < 0xE000) ? kNoCharacter : code, out);
  }
  return out;
}

std::string utf8_of(std::string_view bytes, Encoding encoding) {
  switch (encoding) {
    case Encoding::plain: break;
    case Encoding::utf16_little: return utf8_of_utf16(bytes, false);
    case Encoding::utf16_big: return utf8_of_utf16(bytes, true);
    case Encoding::utf32_little: return utf8_of_utf32(bytes, false);
    case Encoding::utf32_big: return utf8_of_utf32(bytes, true);
  }
  return std::string(bytes);
}

}  // namespace

bool needs_rewriting(std::string_view bytes) {
  bytes = bytes.substr(0, kLookedAt);
  return encoding_of(bytes) != Encoding::plain || ends_lines_in_cr(bytes);
}

RewrittenText rewritten(std::string_view bytes) {
  const Encoding encoding = encoding_of(bytes);
  RewrittenText out;
  out.text = utf8_of(bytes, encoding);
  if (encoding != Encoding::plain) out.note = encoding == Encoding::utf32_little || encoding == Encoding::utf32_big ? "the text is UTF-32" : "the text is UTF-16";
  if (ends_lines_in_cr(std::string_view(out.text).substr(0, kLookedAt))) {
    std::ranges::replace(out.text, '\r', '\n');
    out.note += out.note.empty() ? "the lines end in CR alone" : ", its lines end in CR alone";
  }
  return out;
}

}  // namespace forcegate
