#pragma once
// Lists of names that may be long.

#include <string>
#include <vector>

namespace forcegate {

/// "r2, r5"; of more than four "r1, r2, r3, r4 and 7 more".
std::string some_of(std::vector<std::string> names);

}  // namespace forcegate
