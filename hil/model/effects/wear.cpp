// Wear: loss of gain with the loading done, untouched by rest.
//   dU = -g c W N^p,  N = sum |dF| over the campaign, 1 at its end; p = 1 or 1/2; or 1 - exp(-N/N0). Forms "after_": N at the start of the
//   record, where the decay of the maxima has taken up what the gain loses while it is cycled.
// 10 million taps shift the resistance by about 10 % (Interlink); sensitivity degrades under cycling (Proc. 1, 2017, 813).

#include <cmath>

#include "hil/model/effect.h"

namespace forcegate {
namespace {

EffectForm form(const char* name, std::function<double(double)> law, bool within_records) {
  return {.name = name,
          .shape = {},
          .strength = {{"loss", "1", -1.0, 1.0, 0.0, "relative loss of gain at the end of the campaign"}},
          .sign = StrengthSign::positive,
          .grid = [](const CampaignInput&) { return std::vector<std::vector<double>>{{}}; },
          .columns =
              [law, within_records](const CampaignInput& c, const RecordInput& r, std::span<const double>, ColumnsRef out) {
                r.for_each_wanted([&](std::size_t i) {
                  out(static_cast<Eigen::Index>(i), 0) =
                      -r.base_force_N(i) * law((r.travel_before_N + (within_records ? r.travel_N[i] : 0.0)) / c.travel_total_N);
                });
              }};
}

double linear(double N) { return N; }
double root(double N) { return std::sqrt(N); }
double saturating(double N) { return -std::expm1(-4.0 * N); }

const Registration<EffectKind> kRegistered{
    EffectKind{.name = "wear",
               .side = "sensor",
               .summary = "the gain falls with the loading done and does not come back with rest",
               .equation = "dU = -g c W N, N = sum |dF|",
               .source = "Interlink FSR 400 data sheet; Proceedings 1 (2017) 813",
               .look_alikes = {"slow_recovery", "thermal", "bias", "mounting"},
               .separates = "the same ramp before and after cycling and again after 2 h of rest",
               .needs = {},
               .traits = {.between_records = true, .needs_records = true},
               .forms = {form("linear", linear, true), form("square_root", root, true), form("saturating", saturating, true),
                         form("after_linear", linear, false), form("after_square_root", root, false),
                         form("after_saturating", saturating, false)}}};

}  // namespace
}  // namespace forcegate
