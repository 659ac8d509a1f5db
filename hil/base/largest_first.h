#pragma once
// parallel_for over items of unequal size: the largest first, so that no thread begins a long one when the others are done.

#include <algorithm>
#include <numeric>
#include <span>

#include "hil/base/parallel.h"

namespace forcegate {

/// Calls body(i) once for each i in [0, size.size()), in falling order of size[i]. threads = 0: one per processor.
inline void parallel_for_largest_first(std::span<const std::size_t> size, unsigned threads,
                                       const std::function<void(std::size_t)>& body) {
  std::vector<std::size_t> order(size.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return size[a] > size[b]; });
  parallel_for(order.size(), threads, [&](std::size_t k) { body(order[k]); });
}

}  // namespace forcegate
