// Static nonlinearity: conductance power law, saturation of the contact area.
//   dU = g [h(Fmin) + D (h(F) - h(Fmin))], h = c2 F^2/R + c3 F^3/R^2 (polynomial), c F ln(F/R) (tangent of F^n),
//   or -c softplus(F - F1) (saturation); R the force span. The same curves on the decayed force W, and beside the load's own lowest
//   force (D h(F)), are further forms.
// FlexiForce within +-3 % (Tekscan manual, rev. G); amplitude nonlinearity: Sensors 11 (2011) 8836.

#include <cmath>

#include "hil/model/effect.h"
#include "hil/model/states.h"

namespace forcegate {
namespace {

const auto kNoShape = [](const CampaignInput&) { return std::vector<std::vector<double>>{{}}; };

EffectForm polynomial(const char* name, CurveAt at) {
  return {.name = name,
          .shape = {},
          .strength = {{"c2", "1", -2.0, 2.0, 0.0, "quadratic part, F^2/R"},
                       {"c3", "1", -2.0, 2.0, 0.0, "cubic part, F^3/R^2"}},
          .sign = StrengthSign::either,
          .grid = kNoShape,
          .columns =
              [at](const CampaignInput& c, const RecordInput& r, std::span<const double>, ColumnsRef out) {
                const double R = c.range_N;
                add_curve(r, at, [R](double F) { return F * F / R; }, out.col(0));
                add_curve(r, at, [R](double F) { return F * F * F / (R * R); }, out.col(1));
              },
          .singles = true};
}

EffectForm power(const char* name, CurveAt at) {
  return {.name = name,
          .shape = {},
          .strength = {{"n_minus_1", "1", -0.9, 2.0, 0.0, "exponent of the power law minus one"}},
          .sign = StrengthSign::either,
          .grid = kNoShape,
          .columns =
              [at](const CampaignInput& c, const RecordInput& r, std::span<const double>, ColumnsRef out) {
                const double R = c.range_N;
                add_curve(r, at, [R](double F) { return F > 1e-3 * R ? F * std::log(F / R) : F * std::log(1e-3); }, out.col(0));
              }};
}

EffectForm saturation(const char* name, CurveAt at) {
  return {
      .name = name,
      .shape = {{"F1_N", "N", 0.0, 1000.0, 3.0, "force at which the bend sits"},
                {"width_N", "N", 1e-3, 100.0, 0.5, "width of the bend"}},
      .strength = {{"c", "1", -2.0, 2.0, 0.0, "relative loss of slope above the bend"}},
      .sign = StrengthSign::either,
      .grid =
          [](const CampaignInput& c) {
            std::vector<std::vector<double>> out;
            for (double share : {0.3, 0.5, 0.7, 0.85})
              out.push_back({c.lowest_N + share * c.range_N, 0.12 * c.range_N});
            return out;
          },
      .columns =
          [at](const CampaignInput&, const RecordInput& r, std::span<const double> shape, ColumnsRef out) {
            const double F1 = shape[0], width = shape[1];
            add_curve(r, at, [F1, width](double F) { return -soft_hinge(F - F1, width); }, out.col(0));
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
                const auto square = [R](double F) { return F * F / R; };
                const auto cube = [R](double F) { return F * F * F / (R * R); };
                add_curve(r, CurveAt::force, square, out.col(0));
                add_curve(r, CurveAt::force, cube, out.col(1));
                add_curve(r, CurveAt::force, [R](double F) { return F * F * F * F / (R * R * R); }, out.col(2));
                add_curve(r, CurveAt::force, [R](double F) { return std::sqrt(std::max(F, 0.0) * R); }, out.col(3));
                add_curve(r, CurveAt::decayed, square, out.col(4));
                add_curve(r, CurveAt::decayed, cube, out.col(5));
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
    .traits = {.any_course = true},
    .forms = {polynomial("polynomial", CurveAt::force), polynomial("polynomial_after_decay", CurveAt::decayed),
              polynomial("polynomial_of_swing", CurveAt::swing), power("power_law", CurveAt::force),
              power("power_law_after_decay", CurveAt::decayed), saturation("saturation", CurveAt::force),
              saturation("saturation_after_decay", CurveAt::decayed), bank()}}};

}  // namespace
}  // namespace forcegate
