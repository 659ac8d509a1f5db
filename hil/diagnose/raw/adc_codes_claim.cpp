#include "hil/diagnose/raw/adc_codes_claim.h"

#include <string>

#include "hil/base/quantile.h"

namespace forcegate::diagnose {

std::optional<HealthClaim> claim_of_held_codes(const HeldCodes& codes, const HealthTotals& totals, const HealthScales& scales) {
  constexpr double kLeastHeld = 1e-3;
  if (!codes.found || !(totals.share(codes.samples) > kLeastHeld)) return std::nullopt;
  const std::string values = codes.value_V.size() == 1 ? "one value" : std::to_string(codes.value_V.size()) + " values";
  const std::string where = totals.records > 1 ? ", the same in several records," : ", the same again and again,";
  return HealthClaim{"adc_codes", 0.95,
                     totals.percent(codes.samples) + " of the samples stand at " + values + where +
                         " while the force moves on: codes beside them never come",
                     "code_V", scales.unit, codes.value_V.front(), scales.U_range_V * 1e-4};
}

std::optional<HealthClaim> claim_of_bit_errors(const HealthTotals& totals, const HealthScales& scales) {
  if (!(totals.share(totals.bit_errors) > kLeastShare) || totals.bit_V.size() < totals.several()) return std::nullopt;
  const double bit_V = quantile(totals.bit_V, 0.5);
  return HealthClaim{"adc_codes", 0.95, totals.percent(totals.bit_errors) + " of the samples are off by the weight of one bit of the converter",
                     "bit_V", scales.unit, bit_V, 0.05 * bit_V};
}

}  // namespace forcegate::diagnose
