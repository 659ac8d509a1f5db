#include "hil/diagnose/base/record_spread.h"

#include <algorithm>
#include <cmath>

namespace forcegate::diagnose {

std::size_t records_of_column(const Workspace& w, const MixedFit& fit, int z) {
  constexpr double kExcited = 1e-14;
  if (w.input.single) return 0;
  return static_cast<std::size_t>(
      std::ranges::count_if(w.output.problem.records, [&](const RecordGram& r) { return fit.counts(r) && r.gram(z, z) > kExcited; }));
}

double of_few_records(std::size_t n) { return n > 1 ? std::sqrt(static_cast<double>(n) / static_cast<double>(n - 1)) : 1.0; }

}  // namespace forcegate::diagnose
