#pragma once
// Digests: SHA-256 of files and texts (OpenSSL, about 1 GB/s), and XXH3 of samples (xxHash, several times faster).

#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "hil/base/result.h"

namespace forcegate {

class Sha256 {
 public:
  Sha256();
  ~Sha256();
  Sha256(Sha256&&) noexcept;
  Sha256& operator=(Sha256&&) noexcept;

  void update(const void* data, std::size_t size);
  template <class T>
  void update(std::span<const T> values) {
    static_assert(std::is_trivially_copyable_v<T>);
    update(values.data(), values.size_bytes());
  }
  void update(std::string_view text) { update(text.data(), text.size()); }

  /// 64 lower-case hex digits; the object then starts anew.
  std::string hex();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// 128 bits over a stream of samples: tells two records apart, and guards against nothing that is done on purpose.
class SampleDigest {
 public:
  SampleDigest();
  ~SampleDigest();
  SampleDigest(SampleDigest&&) noexcept;
  SampleDigest& operator=(SampleDigest&&) noexcept;

  void update(const void* data, std::size_t size);
  /// 32 lower-case hex digits; the object then starts anew.
  std::string hex();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

std::string sha256_hex(std::string_view bytes);
Result<std::string> sha256_file(const std::filesystem::path& path);

}  // namespace forcegate
