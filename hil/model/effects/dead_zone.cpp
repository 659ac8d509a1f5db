// Turn-on threshold: a spacer gap, contacts that close at distributed forces.
//   share of closed contacts 1 - exp(-F/F0):  dU = -g c F0 (1 - exp(-F/F0));  hard gap: dU = -g c min(F, F0);
//   share F^2/(F^2 + F0^2) of contacts closed by the force itself:  dU = -g c F F0^2/(F^2 + F0^2);
//   thresholds gamma distributed, mean F0, shape 3:  dU = -g c F0 (1 - e^-x (1 + 2 x/3 + x^2/6)), x = 3 F/F0;
//   thresholds spread about F0 (logistic, w = F0/4):  dU = -g c (F - softplus(F - F0) + softplus(-F0)), softplus(x) = w ln(1 + e^(x/w));
//   share F/sqrt(F^2 + F0^2) of contacts closed, a few of them late:  dU = -g c (F + F0 - sqrt(F^2 + F0^2)).
// On the film's force, on the decayed one, or beside the load's own lowest force (D h(F)).
// Break force 0.2 to 1 N (Interlink integration guide), about 0.2 N (400 series data sheet).

#include <cmath>

#include "hil/model/effect.h"
#include "hil/model/states.h"

namespace forcegate {
namespace {

enum class Gap { distributed, hard, closing, skewed, spread, long_tailed };

// What contacts lack above the force F whose thresholds are gamma distributed, mean F0, shape 3: int_F^inf share still open.
double closed_late(double F, double F0) {
  const double x = 3.0 * F / F0;
  return F0 * std::exp(-x) * (1.0 + x * (2.0 / 3.0 + x / 6.0));
}

EffectForm form(const char* name, Gap gap, CurveAt at, std::vector<double> shares) {
  return {.name = name,
          .shape = {{"F0_N", "N", 1e-4, 100.0, 0.2, "turn-on force"}},
          .strength = {{"c", "1", -2.0, 2.0, 0.0, "share of the contacts that take part"}},
          .sign = StrengthSign::positive,
          .grid =
              [shares](const CampaignInput& c) {
                std::vector<std::vector<double>> out;
                for (double share : shares) out.push_back({share * c.range_N});
                return out;
              },
          .columns =
              [gap, at](const CampaignInput&, const RecordInput& r, std::span<const double> shape,
                           ColumnsRef out) {
                const double F0 = shape[0];
                const auto h = [gap, F0](double F) {
                  if (F <= 0.0) return 0.0;
                  if (gap == Gap::closing) return -F * F0 * F0 / (F * F + F0 * F0);
                  if (gap == Gap::long_tailed) return std::hypot(F, F0) - F - F0;
                  if (gap == Gap::skewed) return -F0 + closed_late(F, F0);
                  if (gap == Gap::spread) return -F + soft_hinge(F - F0, kThresholdSpread * F0) - soft_hinge(-F0, kThresholdSpread * F0);
                  return gap == Gap::hard ? -std::min(F, F0) : F0 * std::expm1(-F / F0);
                };
                add_curve(r, at, h, out.col(0));
              },
          // more than all contacts cannot wait: what needs more is a bent curve
          .least = 0.0,
          .most = 2.0};
}

const Registration<EffectKind> kRegistered{
    EffectKind{.name = "dead_zone",
               .side = "sensor",
               .summary = "the output starts only above a small force; straight above it",
               .equation = "dU = -g c F0 (1 - exp(-F/F0))",
               .source = "Interlink FSR integration guide; FSR 400 series data sheet",
               .look_alikes = {"static_nonlinearity", "contact_loss"},
               .separates = "a slow ramp from true zero; small sines around the turn-on force",
               .needs = {},
               .traits = {.known_form = true},
               .forms = {form("distributed", Gap::distributed, CurveAt::force, {0.01, 0.02, 0.04, 0.08}),
                         form("distributed_after_decay", Gap::distributed, CurveAt::decayed, {0.02, 0.05}),
                         form("distributed_of_swing", Gap::distributed, CurveAt::swing, {0.02, 0.06}),
                         form("hard", Gap::hard, CurveAt::force, {0.01, 0.02, 0.04, 0.08, 0.15, 0.21, 0.3}),
                         form("closing", Gap::closing, CurveAt::force, {0.005, 0.015, 0.04, 0.1}),
                         form("skewed", Gap::skewed, CurveAt::force, {0.02, 0.04, 0.08, 0.15}),
                         form("spread", Gap::spread, CurveAt::force, {0.04, 0.1, 0.2, 0.3}),
                         form("long_tailed", Gap::long_tailed, CurveAt::force, {0.02, 0.06, 0.2}),
                         form("spread_of_swing", Gap::spread, CurveAt::swing, {0.04, 0.1, 0.2, 0.3})}}};

}  // namespace
}  // namespace forcegate
