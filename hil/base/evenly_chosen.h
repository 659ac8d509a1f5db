#pragma once
// Some of many samples, spread over all of them. Every n-th sample of a cycled record whose period divides n meets one phase alone.

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "hil/base/mixed_bits.h"

namespace forcegate {

/// Of `size` samples, asked in turn, one of every size / most that follow each other (all of them where there are no more than `most`), so `most` to
/// 2 * most of them: the first sample, then one anywhere in each block, at a place that the number of the block alone decides. No period can stay in
/// step with places that have none, and the same samples are chosen every time.
class EvenlyChosen {
 public:
  EvenlyChosen(std::size_t size, std::size_t most) : block_(std::max<std::size_t>(1, size / std::max<std::size_t>(1, most))) {}

  /// Is the next sample one of them?
  bool next() {
    const bool is = at_ == chosen_;
    if (++at_ == block_) {
      at_ = 0;
      chosen_ = static_cast<std::size_t>(mixed_bits(++number_ * kMixStep) % block_);
    }
    return is;
  }

 private:
  std::size_t block_, at_ = 0, chosen_ = 0;
  std::uint64_t number_ = 0;
};

}  // namespace forcegate
