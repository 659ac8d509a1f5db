#include "hil/model/compensator/c_term_parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "hil/model/lagged_channel.h"
#include "hil/model/states.h"

namespace forcegate::c_terms {

Result<CTerm> thermal(const ModelEffect& e, const CTermContext& x) {
  constexpr double kWarmer_C = 20.0;  // than the reference, and colder
  const bool is_bent = e.form == "activated";
  if (e.form != "lagged" && !is_bent)
    return refuse("thermal of form " + e.form, "it is a course over the hours of one campaign and follows no thermometer",
                  "record temp_C, and forcegate add thermal --fit CAMPAIGN takes the form that a firmware can follow");
  if (std::isnan(x.reference_temperature_C))
    return refuse("thermal", "the model file does not say at which temperature the effect is zero",
                  "temperature_C under [law] says it, which forcegate fit writes; or give the campaign with --fit, or --reference-temperature");
  CTerm t;
  const std::string& id = x.id;
  const double tau = shape_of(e, 0), gain = strength_of(e, 0), offset = strength_of(e, 1) * x.span_N;
  const LowPassWeights w = tau > 0.0 ? low_pass_weights(tau, x.rate_Hz) : LowPassWeights{0.0, 1.0};
  const double bend = is_bent ? shape_of(e, 1) : 0.0;
  const bool from_reference = !is_bent && shape_of(e, 1) != 0.0;
  t.title = fmt::format("thermal: gain {:g} 1/degC, offset {:g} N/degC from {:g} degC behind {:g} s", gain,
                        offset, x.reference_temperature_C, tau);
  if (is_bent) t.title += fmt::format(", bent by {:g} 1/degC", bend);
  t.constants = constant("k_" + id + "_gain", gain) + constant("k_" + id + "_offset", offset) +
                constant("k_" + id + "_T0", x.reference_temperature_C) +
                constant("k_" + id + "_old", w.to_old) + constant("k_" + id + "_new", w.to_new);
  t.state = fmt::format("  float {0}_hi, {0}_lo, {0}_x;\n", id);
  t.prepare = fmt::format(
      "  if (c->running) {{\n"
      "    const float y = c->{0}_hi;\n"
      "{2}"
      "  }} else {{\n"
      "    c->{0}_hi = {1};\n"
      "  }}\n"
      "  c->{0}_x = c->temperature_C;\n",
      id, from_reference ? "k_" + id + "_T0" : "c->temperature_C",
      add_to_pair(id, "", fmt::format("(k_{0}_old * (c->{0}_x - y) + k_{0}_new * (c->temperature_C - y))", id), "    "));
  std::string warmer = fmt::format("(c->{0}_hi - k_{0}_T0)", id);
  if (std::abs(bend) > 1e-9) {
    t.constants += constant("k_" + id + "_bend", bend) + constant("k_" + id + "_per_bend", 1.0 / bend) +
                   fmt::format("static inline float {0}_bent(float d) {{\n  return (fg_exp(fg_min(fg_max(k_{0}_bend * d, -20.0f), 20.0f)) - 1.0f) * k_{0}_per_bend;\n}}\n", id);
    warmer = fmt::format("{0}_bent{1}", id, warmer);
    t.needs_exp = true;
  }
  t.value = fmt::format("{1} * (k_{0}_gain * W + k_{0}_offset)", id, warmer);
  t.slope_min = -std::fabs(gain) * bent(std::abs(bend), kWarmer_C);
  t.once = 10;
  t.each = t.needs_exp ? 64 : 4;
  t.bytes = 12;
  t.needs_temperature = true;
  return t;
}

// A bent curve behind a lag, h(y), or before one, L[h(F)] (LagAndCurve of hil/model/states.h): one pole on F or on h(F).
void put_behind_pole(const ModelEffect& e, const CTermContext& x, CTerm& t) {
  const std::string& id = x.id;
  const bool bends_first = e.form.ends_with("_before_lag");
  const LowPassWeights w = low_pass_weights(shape_of(e, 0), x.rate_Hz);
  const std::string drive = bends_first ? id + "_h(F)" : "F";
  t.constants += constant("k_" + id + "_old", w.to_old) + constant("k_" + id + "_new", w.to_new);
  t.state = fmt::format("  float {0}_y, {0}_x, {0}_a, {0}_b;\n", id);
  t.prepare = prepare_pole(id, "k_" + id + "_old", "k_" + id + "_new");
  const std::string now = fmt::format("c->{0}_a + c->{0}_b * {1}", id, drive);
  t.value = fmt::format("{0}_h(c->low_N) + c->shrink * ({1} - {0}_h(c->low_N))", id, bends_first ? "(" + now + ")" : fmt::format("{}_h({})", id, now));
  t.commit = fmt::format("  c->{0}_x = {1};\n  c->{0}_y = c->{0}_a + c->{0}_b * c->{0}_x;\n", id, drive);
  t.once += 10;
  t.bytes += 16;
}

// A curve h of the force: on the film's force, on the decayed one, or of the swing (CurveAt of hil/model/states.h).
std::string curve_value(const std::string& form, const std::string& id) {
  if (form.ends_with("_after_decay")) return id + "_h(W)";
  if (form.ends_with("_of_swing")) return fmt::format("c->shrink * {}_h(F)", id);
  return fmt::format("{0}_h(c->low_N) + c->shrink * ({0}_h(F) - {0}_h(c->low_N))", id);
}

Result<CTerm> curve(const ModelEffect& e, const CTermContext& x) {
  CTerm t;
  const std::string& id = x.id;
  const double R = x.span_N;
  const bool after = e.form.ends_with("_after_decay");
  std::string body;
  std::function<double(double)> h;
  if (e.form.starts_with("polynomial")) {
    const double c2 = strength_of(e, 0) / R, c3 = strength_of(e, 1) / (R * R);
    t.constants = constant("k_" + id + "_c2", c2) + constant("k_" + id + "_c3", c3);
    body = fmt::format("return F * F * (k_{0}_c2 + k_{0}_c3 * F);", id);
    h = [=](double F) { return F * F * (c2 + c3 * F); };
    t.each = 4;
  } else if (e.form.starts_with("power_law")) {
    const double c = strength_of(e, 0);
    t.constants = constant("k_" + id + "_c", c) + constant("k_" + id + "_low", 1e-3 * R) +
                  constant("k_" + id + "_R", R);
    body = fmt::format("return k_{0}_c * F * (F > k_{0}_low ? fg_ln(F / k_{0}_R) : -6.9077554f);", id);
    h = [=](double F) { return c * F * (F > 1e-3 * R ? std::log(F / R) : std::log(1e-3)); };
    t.each = 28;
    t.needs_ln = true;
  } else if (e.form.starts_with("power")) {
    const double c = strength_of(e, 0), n = shape_of(e, 1);
    t.constants = constant("k_" + id + "_c", c) + constant("k_" + id + "_n", n) + constant("k_" + id + "_R", R);
    body = fmt::format("return k_{0}_c * ((F > 0.0f ? k_{0}_R * fg_pow(F / k_{0}_R, k_{0}_n) : 0.0f) - F);", id);
    h = [=](double F) { return c * ((F > 0.0 ? R * std::pow(F / R, n) : 0.0) - F); };
    t.each = 64;
    t.needs_pow = t.needs_exp = t.needs_ln = true;
  } else if (e.form.starts_with("touch")) {
    const double c = strength_of(e, 0), half_N = shape_of(e, 1) * R;
    t.constants = constant("k_" + id + "_c", c) + constant("k_" + id + "_half", half_N) + constant("k_" + id + "_all", R + half_N);
    body = fmt::format("return k_{0}_c * ((F > 0.0f ? k_{0}_all * F / (F + k_{0}_half) : 0.0f) - F);", id);
    h = [=](double F) { return c * ((F > 0.0 ? (R + half_N) * F / (F + half_N) : 0.0) - F); };
    t.each = 20;
  } else if (e.form.starts_with("saturation")) {
    const double c = strength_of(e, 0), F1 = shape_of(e, 0), width = shape_of(e, 1);
    t.constants = constant("k_" + id + "_c", c) + constant("k_" + id + "_F1", F1) +
                  constant("k_" + id + "_width", width);
    body = fmt::format(
        "const float z = (F - k_{0}_F1) / k_{0}_width;\n"
        "  if (z > 16.0f) return -(k_{0}_c * (F - k_{0}_F1));\n"
        "  if (z < -16.0f) return 0.0f;\n"
        "  return -(k_{0}_c * k_{0}_width * fg_ln(1.0f + fg_exp(z)));",
        id);
    h = [=](double F) {
      const double z = (F - F1) / width;
      return -c * (z > 30.0 ? F - F1 : width * std::log1p(std::exp(z)));
    };
    t.each = 60;
    t.needs_ln = t.needs_exp = true;
  } else {
    return refuse(e.effect, "the form " + e.form + " is a bank for the diagnosis, not a law",
                  "forcegate export --fit with a campaign of three records or more chooses among the forms that can be undone");
  }
  t.title = fmt::format("{}: {}", e.effect, e.form);
  t.constants += fmt::format("static inline float {}_h(float F) {{\n  {}\n}}\n", id, body);
  if (e.form.ends_with("_lag"))
    put_behind_pole(e, x, t);
  else
    t.value = curve_value(e.form, id);
  t.each = after ? t.each : 2 * t.each + 3;
  // of a curve that lags a sample shows its first part only
  const double direct = e.form.ends_with("_lag") ? low_pass_weights(shape_of(e, 0), x.rate_Hz).to_new : 1.0;
  for (int k = 0; k < 200; ++k) {
    const double F = x.lowest_N + 1.2 * R * (k + 0.5) / 200.0, step = 1e-4 * R;
    const double slope = direct * (h(F + step) - h(F - step)) / (2.0 * step);
    if (slope >= t.slope_min) continue;
    t.slope_min = slope;
    t.falls = fmt::format("at about {:.2g} N the output hardly changes with the force, or falls", F);
  }
  return t;
}

Result<CTerm> dead_zone(const ModelEffect& e, const CTermContext& x) {
  if (e.form == "hard" && strength_of(e, 0) > 0.9)
    return refuse("dead_zone",
                  "below the turn-on force the output does not change, so nothing can be inverted there",
                  "keep the force above the turn-on, and export a model without this effect that was fitted there");
  CTerm t;
  const std::string& id = x.id;
  const double F0 = shape_of(e, 0), c = strength_of(e, 0);
  const bool hard = e.form == "hard";
  t.title = fmt::format("dead_zone: {}, F0 {:g} N", e.form, F0);
  t.constants = constant("k_" + id + "_c", c) + constant("k_" + id + "_F0", F0);
  std::string body = fmt::format("k_{0}_c * k_{0}_F0 * (fg_exp(-(F / k_{0}_F0)) - 1.0f)", id);
  t.each = 64;
  t.needs_exp = true;
  if (hard || e.form == "closing") {
    body = hard ? fmt::format("-(k_{0}_c * (F < k_{0}_F0 ? F : k_{0}_F0))", id)
                : fmt::format("-(k_{0}_c * F * k_{0}_F0 * k_{0}_F0 / (F * F + k_{0}_F0 * k_{0}_F0))", id);
    t.each = 8;
    t.needs_exp = false;
  } else if (e.form == "long_tailed") {
    body = fmt::format("k_{0}_c * (fg_sqrt(F * F + k_{0}_F0 * k_{0}_F0) - F - k_{0}_F0)", id);
    t.each = 16;
    t.needs_exp = false;
    t.needs_sqrt = true;
  } else if (e.form == "skewed") {
    t.constants += fmt::format(
        "static inline float {0}_open(float x) {{\n"
        "  return fg_exp(-x) * (1.0f + x * (0.66666667f + 0.16666667f * x));\n"
        "}}\n",
        id);
    body = fmt::format("k_{0}_c * k_{0}_F0 * ({0}_open(3.0f * F / k_{0}_F0) - 1.0f)", id);
    t.each = 70;
  } else if (e.form.starts_with("spread")) {
    // ln((1 + e^((F - F0)/w)) / (1 + e^(-F0/w))) without an overflow above F0
    const double w = kThresholdSpread * F0;
    t.constants += constant("k_" + id + "_w", w) + constant("k_" + id + "_0", std::log1p(std::exp(-F0 / w)));
    t.constants += fmt::format(
        "static inline float {0}_closed(float F) {{\n"
        "  const float z = (F - k_{0}_F0) / k_{0}_w;\n"
        "  const float up = z > 0.0f ? z + fg_ln(1.0f + fg_exp(-z)) : fg_ln(1.0f + fg_exp(z));\n"
        "  return k_{0}_w * (up - k_{0}_0);\n"
        "}}\n",
        id);
    body = fmt::format("k_{0}_c * ({0}_closed(F) - F)", id);
    t.each = 100;
    t.needs_ln = true;
  }
  t.constants += fmt::format("static inline float {0}_h(float F) {{\n  if (F <= 0.0f) return 0.0f;\n  return {1};\n}}\n", id, body);
  t.value = curve_value(e.form, id);
  // no form falls faster than -c where it closes; of one that opens (c < 0) only `closing` has a slope that turns round: c/8 at sqrt(3) F0
  constexpr double kBehindTheOpening = 0.125;
  if (c > 0.0) t.falls = fmt::format("below about {:.2g} N the output hardly changes with the force", F0);
  t.slope_min = c > 0.0 ? -c : e.form == "closing" ? kBehindTheOpening * c : 0.0;
  return t;
}

}  // namespace forcegate::c_terms
