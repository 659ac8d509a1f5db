#include "hil/base/some_of.h"

#include <utility>

#include "hil/base/text.h"

namespace forcegate {

std::string some_of(std::vector<std::string> names, std::size_t most) {
  const std::size_t more = names.size() > most ? names.size() - most : 0;
  names.resize(names.size() - more);
  return join(names, ", ") + (more > 0 ? " and " + std::to_string(more) + " more" : "");
}

std::string shortened(std::string name) {
  constexpr std::size_t kLongest = 80;
  if (name.size() <= kLongest) return name;
  std::size_t end = kLongest;
  while (end > 0 && (static_cast<unsigned char>(name[end]) & 0xC0) == 0x80) --end;  // no half of a character
  return name.substr(0, end) + "...";
}

std::string some_columns(std::vector<std::string> names) {
  constexpr std::size_t kMost = 20;
  for (std::string& name : names) name = shortened(std::move(name));
  return some_of(std::move(names), kMost);
}

}  // namespace forcegate
