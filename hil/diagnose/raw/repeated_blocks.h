#pragma once
// Blocks of the output that were sent before: a buffer that was not filled anew in time is read once more, and its noise with it.
//
//   n L p^m < 1e-6,   m samples in a row that equal those L before them, n samples in all,   p = (1 + equal) / (2 + all)
//
// (5 % beside three that are as plain as that), over the pairs of samples L apart, outside the block and at its levels, that lie within four sigma
// of the noise of each other, and never below that of two samples at one level, step / (2 sqrt(pi) sigma): an output that comes by without noise, cycle
// for cycle, or at rest, has p near 1.

#include <cstddef>
#include <span>
#include <vector>

namespace forcegate::diagnose {

struct RepeatedBlock {
  std::size_t begin = 0, end = 0;
  std::size_t before = 0;  ///< L
};

/// U in V, `lsb_V` its step (0: none is visible), `noise_V` its white noise per sample. In the order of time, the second of two equal blocks each;
/// none where the noise is no larger than a step. A held value is none, nor is one that `beside` (samples of another channel, as many) repeats as
/// well: then a logger wrote its rows twice.
std::vector<RepeatedBlock> find_repeated_blocks(std::span<const double> U, std::span<const double> beside, double lsb_V, double noise_V);

}  // namespace forcegate::diagnose
