// Static nonlinearity: conductance power law, saturation of the contact area.
//   dU = g [h(Fmin) + D (h(F) - h(Fmin))], h = c2 F^2/R + c3 F^3/R^2 (polynomial), c F ln(F/R) (tangent of F^n),
//   or -c softplus(F - F1) (saturation); R the force span. The same curves on the decayed force W, and beside the load's own lowest
//   force (D h(F)), are further forms.
// Beside a lag of the model a bent curve lags too: h(y) of the lagged force (after_lag) or L[h(F)] (before_lag), tau y' + y = F. h(F) alone
// would leave the lag of what the curve adds, which looks like a second time constant. power: h = c (R (F/R)^n - F); touch: h = c ((R + F1) F/(F + F1) - F).
// FlexiForce within +-3 % (Tekscan manual, rev. G); amplitude nonlinearity: Sensors 11 (2011) 8836.

#include <cmath>
#include <functional>
#include <span>
#include <utility>
#include <vector>

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

using Curves = std::vector<std::function<double(double)>>;

void add_lagged(const RecordInput& r, double tau_s, LagAndCurve order, const Curves& h, ColumnsRef out) {
  for (std::size_t k = 0; k < h.size(); ++k) {
    const std::vector<double> y = lagged_curve_rows(r, tau_s, order, h[k]);
    const double low = r.dynamic ? h[k](r.F_min_N) : 0.0;
    for (std::size_t i = 0; i < y.size(); ++i)
      out(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) = low + (r.dynamic ? r.decay[i] : 1.0) * (y[i] - low);
  }
}

// Of the force span and the shape, tau_s first.
using CurvesOf = std::function<Curves(double R, std::span<const double> shape)>;

EffectForm lagged(const char* name, LagAndCurve order, std::vector<ParameterSpec> strength, const CurvesOf& curves) {
  return {.name = name,
          .shape = {{"tau_s", "s", 1e-4, 10.0, 0.05, "time constant of the lag"}},
          .strength = std::move(strength),
          .sign = StrengthSign::either,
          .grid = [](const CampaignInput&) { return std::vector<std::vector<double>>{{0.02}, {0.06}, {0.2}}; },
          .columns =
              [order, curves](const CampaignInput& c, const RecordInput& r, std::span<const double> shape, ColumnsRef out) {
                add_lagged(r, shape[0], order, curves(c.range_N, shape), out);
              },
          .beside = "lag"};
}

EffectForm lagged_polynomial(const char* name, LagAndCurve order) {
  return lagged(name, order, polynomial("", CurveAt::force).strength, [](double R, std::span<const double>) {
    return Curves{[R](double F) { return F * F / R; }, [R](double F) { return F * F * F / (R * R); }};
  });
}

// A share of the output that goes with a curve of one number.
using CurveOf = double (*)(double F, double R, double number);

EffectForm lagged_share(const char* name, LagAndCurve order, ParameterSpec share, ParameterSpec number, std::vector<double> tried, CurveOf curve) {
  EffectForm out = lagged(name, order, {std::move(share)}, [curve](double R, std::span<const double> shape) {
    return Curves{[curve, R, number = shape[1]](double F) { return curve(F, R, number) - F; }};
  });
  out.shape.push_back(std::move(number));
  out.sign = StrengthSign::positive;
  out.grid = [tried = std::move(tried)](const CampaignInput&) {
    std::vector<std::vector<double>> shapes;
    for (const double tau_s : {0.02, 0.06, 0.2})
      for (const double value : tried) shapes.push_back({tau_s, value});
    return shapes;
  };
  return out;
}

// Far from 1 the tangent at n = 1 is not the power any more.
EffectForm lagged_power(const char* name, LagAndCurve order) {
  return lagged_share(name, order, {"c", "1", -2.0, 2.0, 0.0, "share of the output that goes with the power"}, {"n", "1", 0.2, 3.0, 0.8, "exponent"}, {0.75, 1.3},
                      [](double F, double R, double n) { return F > 0.0 ? R * std::pow(F / R, n) : 0.0; });
}

// Contacts that close within a small force: a step of the output at the touch, which no power has.
EffectForm lagged_touch(const char* name, LagAndCurve order) {
  return lagged_share(name, order, {"c", "1", -0.5, 2.0, 0.0, "share of the output that comes with the touch"},
                      {"touch", "1", 0.002, 0.3, 0.02, "force by which half of it is there, share of the range"}, {0.01, 0.05},
                      [](double F, double R, double touch) { return F > 0.0 ? (1.0 + touch) * R * F / (F + touch * R) : 0.0; });
}

EffectForm lagged_bank(const char* name, LagAndCurve order) {
  std::vector<ParameterSpec> strength = bank().strength;
  strength.resize(4);
  strength.push_back({"p", "1", -4.0, 4.0, 0.0, "R (F/R)^0.75"});
  strength.push_back({"u1", "1", -4.0, 4.0, 0.0, "R F/(F + 0.01 R), the touch"});
  strength.push_back({"u4", "1", -4.0, 4.0, 0.0, "R F/(F + 0.04 R)"});
  EffectForm out = lagged(name, order, std::move(strength), [](double R, std::span<const double>) {
    const auto touch = [R](double share) { return [R, share](double F) { return F > 0.0 ? R * F / (F + share * R) : 0.0; }; };
    return Curves{[R](double F) { return F * F / R; }, [R](double F) { return F * F * F / (R * R); },
                  [R](double F) { return F * F * F * F / (R * R * R); }, [R](double F) { return std::sqrt(std::max(F, 0.0) * R); },
                  [R](double F) { return R * std::pow(std::max(F, 0.0) / R, 0.75); }, touch(0.01), touch(0.04)};
  });
  out.bank = true;
  return out;
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
              saturation("saturation_after_decay", CurveAt::decayed),
              lagged_polynomial("polynomial_after_lag", LagAndCurve::curve_of_lagged),
              lagged_polynomial("polynomial_before_lag", LagAndCurve::lag_of_curve),
              lagged_power("power_after_lag", LagAndCurve::curve_of_lagged), lagged_power("power_before_lag", LagAndCurve::lag_of_curve),
              lagged_touch("touch_after_lag", LagAndCurve::curve_of_lagged), lagged_touch("touch_before_lag", LagAndCurve::lag_of_curve),
              bank(), lagged_bank("quartic_after_lag", LagAndCurve::curve_of_lagged),
              lagged_bank("quartic_before_lag", LagAndCurve::lag_of_curve)}}};

}  // namespace
}  // namespace forcegate
