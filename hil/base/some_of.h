#pragma once
// Lists of names that may be long.

#include <cstddef>
#include <string>
#include <vector>

namespace forcegate {

/// "r2, r5"; of more than `most` "r1, r2, r3, r4 and 7 more".
std::string some_of(std::vector<std::string> names, std::size_t most = 4);

/// Of UTF-8: up to 80 bytes as they are, else the first of them and "...".
std::string shortened(std::string name);

/// Names of columns, where a file may have thousands of them or a page for each: at most 20, each of them shortened.
std::string some_columns(std::vector<std::string> names);

}  // namespace forcegate
