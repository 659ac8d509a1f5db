#include "hil/app/export/replayed_far_off.h"

#include <algorithm>
#include <cmath>

#include "hil/base/plain_number.h"
#include "hil/base/text.h"

namespace forcegate {

std::string replayed_far_off(const diagnose::OneLawFit& fit, const CompensatorCheck& check, double gain_N_per_V) {
  constexpr double kFar = 5.0, kNearTheWorst = 0.5;
  struct Far {
    std::string record;
    double replayed_N, fitted_N;
  };
  std::vector<Far> far;
  for (const ReplayedRecord& r : check.records)
    for (const auto& item : fit.records)
      if (item.record == r.record && r.compensated_rms_N > kFar * std::abs(gain_N_per_V) * item.model_V)
        far.push_back({r.record, r.compensated_rms_N, std::abs(gain_N_per_V) * item.model_V});
  if (far.empty()) return {};
  std::ranges::stable_sort(far, std::greater{}, &Far::replayed_N);
  const double least_N = kNearTheWorst * far.front().replayed_N;
  std::erase_if(far, [&](const Far& f) { return f.replayed_N < least_N; });
  std::vector<std::string> told;
  for (const Far& f : far) told.push_back(f.record + " " + plain_number(1e3 * f.replayed_N) + " mN, fitted " + plain_number(1e3 * f.fitted_N) + " mN");
  return "replayed far above what the fit leaves: " + join(told, "; ") +
         ". A firmware takes the lowest output since it was switched on for the foot of the cycles and the first of them for the undecayed one: where the force stood lower "
         "before the cycles, let the record begin at their foot, or switch the firmware on there";
}

}  // namespace forcegate
