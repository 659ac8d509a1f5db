#include "rigs/emulated/hidden/seal.h"

#include <fstream>
#include <nlohmann/json.hpp>

#include "hil/base/digest.h"
#include "hil/base/read_file.h"

namespace forcegate::hidden {
namespace {

constexpr char kAlphabet[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

std::string base64(const std::string& bytes) {
  std::string out;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    unsigned word = 0;
    const std::size_t n = std::min<std::size_t>(3, bytes.size() - i);
    for (std::size_t k = 0; k < 3; ++k)
      word = word << 8 | (k < n ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k) out += k <= n ? kAlphabet[word >> (18 - 6 * k) & 63u] : '=';
  }
  return out;
}

Result<std::string> bytes_of(const std::string& text) {
  std::string out;
  unsigned word = 0;
  int bits = 0;
  for (const char c : text) {
    if (c == '=') break;
    const std::size_t value = std::string_view(kAlphabet).find(c);
    if (value == std::string_view::npos) return fail(ErrorCode::parse, "the sealed sheet is not base64");
    word = word << 6 | static_cast<unsigned>(value);
    bits += 6;
    if (bits >= 8) {
      bits -= 8;
      out += static_cast<char>(word >> bits & 0xffu);
    }
  }
  return out;
}

/// XOR with blocks of 64 characters; its own inverse.
std::string masked(std::string text, const std::string& nonce) {
  std::string block;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (i % 64 == 0) block = sha256_hex(nonce + ":" + std::to_string(i / 64));
    text[i] = static_cast<char>(text[i] ^ block[i % 64]);
  }
  return text;
}

}  // namespace

SealedSheet seal(const std::string& sheet, const std::string& nonce) {
  return {sha256_hex(nonce + sheet), nonce, base64(masked(sheet, nonce))};
}

Result<std::string> open(const SealedSheet& sheet) {
  FORCEGATE_TRY(std::string bytes, bytes_of(sheet.sealed));
  std::string text = masked(std::move(bytes), sheet.nonce);
  if (sha256_hex(sheet.nonce + text) != sheet.commitment)
    return fail(ErrorCode::parse,
                "the sheet does not fit its commitment: it was changed after it was sealed");
  return text;
}

Result<void> write_sealed(const SealedSheet& sheet, const std::filesystem::path& folder) {
  const nlohmann::ordered_json j = {{"format", 1},
                                    {"commitment_sha256", sheet.commitment},
                                    {"nonce", sheet.nonce},
                                    {"sealed", sheet.sealed}};
  std::ofstream file(folder / kSealedFile, std::ios::binary);
  file << j.dump(1) << '\n';
  file.close();
  if (!file) return fail(ErrorCode::io, "cannot write the file", (folder / kSealedFile).string(), "is the folder writable and the disk not full?");
  return {};
}

Result<SealedSheet> read_sealed(const std::filesystem::path& folder) {
  const std::filesystem::path path = folder / kSealedFile;
  const auto text = read_file(path);
  if (!text)
    return fail(ErrorCode::io, "there is no sealed sheet", path.string(),
                "name a folder that `forcegate mystery` has written");
  try {
    const auto j = nlohmann::json::parse(*text);
    if (j.at("format") != 1)
      return fail(ErrorCode::parse, "unknown format of the sealed sheet", path.string());
    return SealedSheet{j.at("commitment_sha256"), j.at("nonce"), j.at("sealed")};
  } catch (const nlohmann::json::exception& e) {
    return fail(ErrorCode::parse, std::string("the sealed sheet is damaged: ") + e.what(), path.string());
  }
}

}  // namespace forcegate::hidden
