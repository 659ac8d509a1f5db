#include "hil/rig/witness/noise_watch.h"

#include <algorithm>
#include <cmath>

#include "hil/rig/witness/rows.h"

namespace forcegate::witness {

template <bool kSound>
void NoiseWatch::push(const RigBlock& block, std::size_t n) {
  const float* force_N = block.force_ref_N.data();
  const std::uint16_t* status = block.status.data();
  double low = low_N_, high = high_N_, sum = sum_N_, squares = sum_second_;
  double x1 = x1_, x2 = x2_;
  int run = run_;
  std::uint64_t good = 0, seconds = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const double x = force_N[i];
    if (!kSound && no_reference(force_N[i], status[i])) {
      // A lost row is the link's, one with an error or in overload is counted as that.
      not_finite_ += !std::isfinite(x) && !(status[i] & (kRigSampleLost | kRigReferenceFault | kRigReferenceSaturated));
      run = 0;
      continue;
    }
    low = std::min(low, x);
    high = std::max(high, x);
    sum += x;
    ++good;
    if (run >= 2) {
      const double second = x2 - 2.0 * x1 + x;
      squares += second * second;
      ++seconds;
    }
    x2 = x1;
    x1 = x;
    ++run;
  }
  low_N_ = low;
  high_N_ = high;
  sum_N_ = sum;
  sum_second_ = squares;
  n_ += good;
  second_n_ += seconds;
  x1_ = static_cast<float>(x1);
  x2_ = static_cast<float>(x2);
  run_ = std::min(run, 1000);
}
template void NoiseWatch::push<true>(const RigBlock&, std::size_t);
template void NoiseWatch::push<false>(const RigBlock&, std::size_t);

void NoiseWatch::finish(RigObservation& o) const {
  o.reference_not_finite = not_finite_;
  o.reference_min_N = low_N_;
  o.reference_max_N = high_N_;
  if (second_n_ > 0) o.reference_noise_N = std::sqrt(sum_second_ / (6.0 * static_cast<double>(second_n_)));
  if (n_ > 0) o.reference_mean_N = sum_N_ / static_cast<double>(n_);
}

}  // namespace forcegate::witness
