#pragma once
// Commit and reveal. The commitment is the SHA-256 of a nonce and the truth sheet; it is printed before
// anybody answers and proves afterwards that the sheet was not changed. The sheet itself is masked, not
// secret: the key lies beside it so that `reveal` works without a server. Whoever unmasks it by hand plays
// alone.

#include <filesystem>
#include <string>

#include "hil/base/result.h"

namespace forcegate::hidden {

struct SealedSheet {
  std::string commitment;  ///< 64 hex digits
  std::string nonce;       ///< 32 hex digits
  std::string sealed;      ///< base64 of the sheet, XOR with SHA-256(nonce, counter) blocks
};

SealedSheet seal(const std::string& sheet, const std::string& nonce);

/// The sheet. ErrorCode::parse when the commitment does not fit what is sealed.
Result<std::string> open(const SealedSheet& sheet);

inline constexpr const char* kSealedFile = "sealed_truth.json";
Result<void> write_sealed(const SealedSheet& sheet, const std::filesystem::path& folder);
Result<SealedSheet> read_sealed(const std::filesystem::path& folder);

}  // namespace forcegate::hidden
