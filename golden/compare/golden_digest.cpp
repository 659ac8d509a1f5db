#include "golden/compare/golden_digest.h"

#include "hil/base/digest.h"
#include "hil/base/text.h"

namespace forcegate {

std::string golden_digest(std::string_view text) {
  Sha256 digest;
  for (std::string line : split(std::string(text), '\n')) {
    if (line.ends_with('\r')) line.pop_back();
    if (line.empty() || line.starts_with('#') || line.starts_with("tolerance ") || line.starts_with("digest ")) continue;
    digest.update(line + "\n");
  }
  return digest.hex();
}

}  // namespace forcegate
