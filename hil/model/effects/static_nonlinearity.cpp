// Static nonlinearity: conductance power law, saturation of the contact area.
//   dU = g [h(Fmin) + D (h(F) - h(Fmin))], h = c2 F^2/R + c3 F^3/R^2 (polynomial), c F ln(F/R) (tangent of F^n),
//   or -c softplus(F - F1) (saturation); R the force span. The same curves on the decayed force W are second forms.
// FlexiForce within +-3 % (Tekscan manual, rev. G); amplitude nonlinearity: Sensors 11 (2011) 8836.

#include <cmath>

#include "hil/model/effect.h"
#include "hil/model/states.h"

namespace forcegate {
namespace {

template <class Curve>
void apply(const RecordInput& r, const Curve& h, Eigen::Ref<Eigen::VectorXd> out, bool after) {
  after ? after_decay(r, h, out) : through_decay(r, h, out);
}

const auto kNoShape = [](const CampaignInput&) { return std::vector<std::vector<double>>{{}}; };

EffectForm polynomial(const char* name, bool after, bool bank) {
  return {.name = name,
          .shape = {},
          .strength = {{"c2", "1", -2.0, 2.0, 0.0, "quadratic part, F^2/R"},
                       {"c3", "1", -2.0, 2.0, 0.0, "cubic part, F^3/R^2"}},
          .sign = StrengthSign::either,
          .grid = kNoShape,
          .columns =
              [after](const CampaignInput& c, const RecordInput& r, std::span<const double>, ColumnsRef out) {
                const double R = c.range_N;
                apply(
                    r, [R](double F) { return F * F / R; }, out.col(0), after);
                apply(
                    r, [R](double F) { return F * F * F / (R * R); }, out.col(1), after);
              },
          .singles = true,
          .bank = bank};
}

EffectForm power(const char* name, bool after) {
  return {.name = name,
          .shape = {},
          .strength = {{"n_minus_1", "1", -0.9, 2.0, 0.0, "exponent of the power law minus one"}},
          .sign = StrengthSign::either,
          .grid = kNoShape,
          .columns = [after](const CampaignInput& c, const RecordInput& r, std::span<const double>,
                             ColumnsRef out) {
            const double R = c.range_N;
            apply(
                r, [R](double F) { return F > 1e-3 * R ? F * std::log(F / R) : F * std::log(1e-3); },
                out.col(0), after);
          }};
}

EffectForm saturation(const char* name, bool after) {
  return {
      .name = name,
      .shape = {{"F1_N", "N", 0.0, 1000.0, 3.0, "force at which the bend sits"},
                {"width_N", "N", 1e-3, 100.0, 0.5, "width of the bend"}},
      .strength = {{"c", "1", -2.0, 2.0, 0.0, "relative loss of slope above the bend"}},
      .sign = StrengthSign::either,
      .grid =
          [](const CampaignInput& c) {
            std::vector<std::vector<double>> out;
            for (double at : {0.3, 0.5, 0.7, 0.85})
              out.push_back({c.lowest_N + at * c.range_N, 0.12 * c.range_N});
            return out;
          },
      .columns =
          [after](const CampaignInput&, const RecordInput& r, std::span<const double> shape, ColumnsRef out) {
            const double F1 = shape[0], width = shape[1];
            apply(
                r, [F1, width](double F) { return -soft_hinge(F - F1, width); }, out.col(0), after);
          }};
}

EffectForm bank() {
  return {.name = "quartic_both",
          .shape = {},
          .strength = {{"c2", "1", -4.0, 4.0, 0.0, "F^2/R"},
                       {"c3", "1", -4.0, 4.0, 0.0, "F^3/R^2"},
                       {"c4", "1", -4.0, 4.0, 0.0, "F^4/R^3"},
                       {"s", "1", -4.0, 4.0, 0.0, "sqrt(F R)"},
                       {"d2", "1", -4.0, 4.0, 0.0, "W^2/R"},
                       {"d3", "1", -4.0, 4.0, 0.0, "W^3/R^2"}},
          .sign = StrengthSign::either,
          .grid = kNoShape,
          .columns =
              [](const CampaignInput& c, const RecordInput& r, std::span<const double>, ColumnsRef out) {
                const double R = c.range_N;
                through_decay(
                    r, [R](double F) { return F * F / R; }, out.col(0));
                through_decay(
                    r, [R](double F) { return F * F * F / (R * R); }, out.col(1));
                through_decay(
                    r, [R](double F) { return F * F * F * F / (R * R * R); }, out.col(2));
                through_decay(
                    r, [R](double F) { return std::sqrt(std::max(F, 0.0) * R); }, out.col(3));
                after_decay(
                    r, [R](double F) { return F * F / R; }, out.col(4));
                after_decay(
                    r, [R](double F) { return F * F * F / (R * R); }, out.col(5));
              },
          .bank = true};
}

const Registration<EffectKind> kRegistered{EffectKind{
    .name = "static_nonlinearity",
    .side = "sensor",
    .summary = "output against force is one bent curve, the same up and down and at any speed",
    .equation = "U = g (F + h(F)) + o",
    .source = "Tekscan FlexiForce manual rev. G; Sensors 11 (2011) 8836",
    .look_alikes = {"clipping", "dead_zone", "spring_nonlinearity", "off_axis"},
    .separates = "slow ramps over the full range; sines of equal amplitude at two means",
    .needs = {},
    .forms = {polynomial("polynomial", false, false), polynomial("polynomial_after_decay", true, false),
              power("power_law", false), power("power_law_after_decay", true),
              saturation("saturation", false), saturation("saturation_after_decay", true), bank()}}};

}  // namespace
}  // namespace forcegate
