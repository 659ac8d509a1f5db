// Wear: loss of gain with the loading done, untouched by rest.
//   dU = -g c W N^p,  N = sum |dF| over the campaign, 1 at its end; p = 1 or 1/2; or 1 - exp(-N/N0).
// 10 million taps shift the resistance by about 10 % (Interlink); sensitivity degrades under cycling (Proc. 1, 2017, 813).

#include <cmath>

#include "hil/model/effect.h"

namespace forcegate {
namespace {

EffectForm form(const char* name, std::function<double(double)> law) {
  return {.name = name,
          .shape = {},
          .strength = {{"loss", "1", -1.0, 1.0, 0.0, "relative loss of gain at the end of the campaign"}},
          .sign = StrengthSign::either,
          .grid = [](const CampaignInput&) { return std::vector<std::vector<double>>{{}}; },
          .columns =
              [law](const CampaignInput& c, const RecordInput& r, std::span<const double>, ColumnsRef out) {
                for (std::size_t i = 0; i < r.rows(); ++i)
                  out(static_cast<Eigen::Index>(i), 0) =
                      -r.base_force_N(i) * law((r.travel_before_N + r.travel_N[i]) / c.travel_total_N);
              }};
}

const Registration<EffectKind> kRegistered{
    EffectKind{.name = "wear",
               .side = "sensor",
               .summary = "the gain falls with the loading done and does not come back with rest",
               .equation = "dU = -g c W N, N = sum |dF|",
               .source = "Interlink FSR 400 data sheet; Proceedings 1 (2017) 813",
               .look_alikes = {"slow_recovery", "thermal", "bias", "mounting"},
               .separates = "the same ramp before and after cycling and again after 2 h of rest",
               .needs = {},
               .forms = {form("linear", [](double N) { return N; }),
                         form("square_root", [](double N) { return std::sqrt(N); }),
                         form("saturating", [](double N) { return -std::expm1(-4.0 * N); })}}};

}  // namespace
}  // namespace forcegate
