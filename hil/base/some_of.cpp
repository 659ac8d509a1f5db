#include "hil/base/some_of.h"

#include "hil/base/text.h"

namespace forcegate {

std::string some_of(std::vector<std::string> names) {
  constexpr std::size_t kMost = 4;
  const std::size_t more = names.size() > kMost ? names.size() - kMost : 0;
  names.resize(names.size() - more);
  return join(names, ", ") + (more > 0 ? " and " + std::to_string(more) + " more" : "");
}

}  // namespace forcegate
