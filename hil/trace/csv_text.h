#pragma once
// Text as other programs write it, before it is cut into lines.

#include <string>
#include <string_view>

namespace forcegate {

/// UTF-32 by its mark, UTF-16 by its mark or by the zero bytes beside Latin letters, or lines that end in CR alone. Looks at the first 64 kB.
bool needs_rewriting(std::string_view bytes);

struct RewrittenText {
  std::string text;  ///< UTF-8 with LF
  std::string note;
};
RewrittenText rewritten(std::string_view bytes);

}  // namespace forcegate
