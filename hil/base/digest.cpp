#include "hil/base/digest.h"

#include <openssl/evp.h>
#include <xxhash.h>

#include <array>
#include <fstream>
#include <span>

namespace forcegate {
namespace {

std::string hex_of(std::span<const unsigned char> bytes) {
  static constexpr char kDigits[] = "0123456789abcdef";
  std::string out;
  for (const unsigned char b : bytes) {
    out += kDigits[b >> 4];
    out += kDigits[b & 15];
  }
  return out;
}

}  // namespace

struct Sha256::Impl {
  EVP_MD_CTX* context = EVP_MD_CTX_new();
  ~Impl() { EVP_MD_CTX_free(context); }
  void start() { EVP_DigestInit_ex(context, EVP_sha256(), nullptr); }
};

Sha256::Sha256() : impl_(std::make_unique<Impl>()) { impl_->start(); }
Sha256::~Sha256() = default;
Sha256::Sha256(Sha256&&) noexcept = default;
Sha256& Sha256::operator=(Sha256&&) noexcept = default;

void Sha256::update(const void* data, std::size_t size) { EVP_DigestUpdate(impl_->context, data, size); }

std::string Sha256::hex() {
  std::array<unsigned char, 32> bytes{};
  EVP_DigestFinal_ex(impl_->context, bytes.data(), nullptr);
  impl_->start();
  return hex_of(bytes);
}

struct SampleDigest::Impl {
  XXH3_state_t* state = XXH3_createState();
  Impl() { XXH3_128bits_reset(state); }
  ~Impl() { XXH3_freeState(state); }
};

SampleDigest::SampleDigest() : impl_(std::make_unique<Impl>()) {}
SampleDigest::~SampleDigest() = default;
SampleDigest::SampleDigest(SampleDigest&&) noexcept = default;
SampleDigest& SampleDigest::operator=(SampleDigest&&) noexcept = default;

void SampleDigest::update(const void* data, std::size_t size) {
  XXH3_128bits_update(impl_->state, data, size);
}

std::string SampleDigest::hex() {
  XXH128_canonical_t bytes;
  XXH128_canonicalFromHash(&bytes, XXH3_128bits_digest(impl_->state));
  XXH3_128bits_reset(impl_->state);
  return hex_of(bytes.digest);
}

std::string sha256_hex(std::string_view bytes) {
  Sha256 h;
  h.update(bytes);
  return h.hex();
}

Result<std::string> sha256_file(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in)
    return fail(ErrorCode::io, "cannot open file", path.string(), "check the path and its permissions");
  Sha256 h;
  std::array<char, 65536> buffer;
  while (in.read(buffer.data(), buffer.size()) || in.gcount() > 0)
    h.update(buffer.data(), static_cast<std::size_t>(in.gcount()));
  return h.hex();
}

}  // namespace forcegate
