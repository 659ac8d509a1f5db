#pragma once

#include <set>
#include <span>
#include <string>

namespace forcegate {

/// The first of the names that was there before; nullptr: they are all different.
inline const std::string* first_repeated(std::span<const std::string> names) {
  std::set<std::string_view> seen;
  for (const std::string& name : names)
    if (!seen.insert(name).second) return &name;
  return nullptr;
}

}  // namespace forcegate
