#pragma once
// Work on independent items with a fixed number of threads. The order of execution is free, so a
// body may only write to its own item; then the result does not depend on the thread count.

#include <atomic>
#include <cstddef>
#include <functional>
#include <thread>
#include <vector>

namespace forcegate {

/// Calls body(i) once for each i in [0, n). threads = 0: one per processor.
inline void parallel_for(std::size_t n, unsigned threads, const std::function<void(std::size_t)>& body) {
  if (threads == 0) threads = std::thread::hardware_concurrency();
  if (threads <= 1 || n <= 1) {
    for (std::size_t i = 0; i < n; ++i) body(i);
    return;
  }
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    for (std::size_t i = next++; i < n; i = next++) body(i);
  };
  std::vector<std::jthread> pool;
  for (unsigned t = 1; t < threads && t < n; ++t) pool.emplace_back(work);
  work();
}

}  // namespace forcegate
