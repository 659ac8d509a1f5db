#pragma once
// Runs of one code in an output whose noise goes over its codes: whatever the force does, no converter repeats itself that long.
//
//   N p^(m - 1) < 1e-6,   m >= 8 samples of one code among N,   p = (1 + equal) / (2 + all)
//   N p^(m - 1) < 1e-3,   m from 5 to 7, each at a code of its own: several of them are no chance either, and a code that is too wide is met again
//
// over the pairs of neighbours, outside the run, that lie within a hundredth of the output's swing (or four sigma of its noise) of it, within a tenth
// where these are fewer than a hundred. An output
// that has no noise at that level, at rest or at its floor, stands still there whenever it comes by, and p is near 1.

#include <cstddef>
#include <span>
#include <vector>

namespace forcegate::diagnose {

struct SilentRun {
  std::size_t begin = 0, end = 0;
};

/// U in V, `lsb_V` its step (0: none is visible), `noise_V` its white noise per sample. In the order of time; none where the noise is no larger
/// than a step, nor at the lowest and the highest codes of the record.
std::vector<SilentRun> find_silent_runs(std::span<const double> U, double lsb_V, double noise_V);

}  // namespace forcegate::diagnose
