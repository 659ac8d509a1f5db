#include "hil/model/compensator/c_term.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "hil/model/compensator/c_expression.h"
#include "hil/model/compensator/c_term_parts.h"
#include "hil/model/compensator/user_slope.h"

namespace forcegate {

namespace c_terms {

std::string array(const std::string& name, const std::vector<double>& values) {
  std::string out = fmt::format("static const float {}[{}] = {{", name, values.size());
  for (std::size_t k = 0; k < values.size(); ++k) out += (k == 0 ? "" : ", ") + c_float(values[k]);
  return out + "};\n";
}

std::string constant(const std::string& name, double value) {
  return fmt::format("static const float {} = {};\n", name, c_float(value));
}

tl::unexpected<Error> refuse(const std::string& effect, const std::string& why, const std::string& hint) {
  return fail(ErrorCode::config, effect + " cannot be compensated on a microcontroller: " + why, effect,
              hint);
}

}  // namespace c_terms

namespace {

constexpr double kSlopeMargin = 1.1;  // the least slope was looked for at some places only

const std::map<std::string, std::pair<const char*, const char*>>& refusals() {
  static const std::map<std::string, std::pair<const char*, const char*>> kReasons = {
      {"delay",
       {"what a delay took away has not arrived yet: its inverse needs the future",
        "align the channels when recording"}},
      {"clock_skew", {"it is in the recorder's clock, not in the sensor", "mend the recorder"}},
      {"wear",
       {"it needs the loading done over the sensor's life, which a reset forgets", "calibrate each session"}},
      {"slow_recovery",
       {"it needs the hours of rest before a reset, which the firmware does not see",
        "calibrate after the rest that you will use"}},
      {"mounting", {"it changes with every mounting", "calibrate after mounting"}},
      {"bias",
       {"the firmware does not measure the drive voltage",
        "regulate the drive, or calibrate at the drive that you will use"}},
      {"humidity", {"the firmware has no hygrometer", "add one and give the effect your own equation"}},
      {"frequency_bump",
       {"its strength depends on jumps that are known only afterwards", "wait until the bump has faded"}},
      {"rc",
       {"undoing a pole that moves with the load amplifies noise without a bound at low load",
        "raise the bandwidth of the circuit"}},
      {"piezocapacitance",
       {"it is a lead: undoing it needs the derivative of the force to come", "filter both channels alike"}},
      {"self_heating",
       {"its power follows the drive voltage, which the firmware does not measure", "regulate the drive"}},
      {"clipping", {"a value at the rail says nothing about the force beyond it", "use a smaller gain"}},
      {"hum",
       {"the phase of the mains is not known to the firmware",
        "shield the cable, or sample over whole periods of the mains"}},
      {"outliers", {"they are chance", "reject them before the conversion"}},
      {"dropouts", {"they are chance", "mend the link"}},
      {"adc_codes", {"a missing code is missing information", "change the converter"}},
  };
  return kReasons;
}

// What the symbols of an equation are in C: where the output is asked for, and in the two steps of the midpoint rule.
struct Symbols {
  std::map<std::string, std::string> at_output, first, second;
};

Symbols symbols_of(const UserEffect& e, const std::string& id) {
  Symbols out;
  out.at_output = {{"F", "F"}, {"t", "c->t_s"}, {"T", "c->temperature_C"}};
  // of second order, as the model's central difference; one of first order would be late by half a sample
  out.at_output["dF"] = fmt::format("{}_rate(c, F)", id);
  for (const ModelParameter& p : e.parameters) out.at_output[p.name] = "k_" + id + "_" + p.name;
  out.first = out.second = out.at_output;
  for (const auto& [name, derivative] : e.states) {
    out.at_output[name] = out.first[name] = fmt::format("c->{}_s_{}", id, name);
    out.second[name] = "h_" + name;
  }
  // half a step further the force has gone on as it did over the last one
  out.second["F"] = fmt::format("(F + 0.5f * (c->running ? F - c->{}_x : 0.0f))", id);
  return out;
}

// States by the midpoint rule, as sums of two floats. `used`: functions that the equations call.
Result<void> add_states(CTerm& t, const UserEffect& e, const CTermContext& x, const Symbols& symbols, const std::string& where,
                        std::set<std::string>& used) {
  std::string half, full, members;
  for (const auto& [name, derivative] : e.states) {
    FORCEGATE_TRY(const CExpression k1, c_expression(derivative, where, symbols.first));
    FORCEGATE_TRY(const CExpression k2, c_expression(derivative, where, symbols.second));
    members += fmt::format(", {0}_s_{1}, {0}_l_{1}", x.id, name);
    half += fmt::format("    const float h_{1} = c->{0}_s_{1} + {2} * ({3});\n", x.id, name,
                        c_float(0.5 / x.rate_Hz), k1.text);
    full += fmt::format(
        "    const float d_{1} = {2} * ({3}) + c->{0}_l_{1};\n"
        "    const float n_{1} = c->{0}_s_{1} + d_{1};\n"
        "    c->{0}_l_{1} = d_{1} - (n_{1} - c->{0}_s_{1});\n"
        "    c->{0}_s_{1} = n_{1};\n",
        x.id, name, c_float(1.0 / x.rate_Hz), k2.text);
    t.once += k1.operations + k2.operations + 8;
    t.bytes += 8;
    used.insert(k1.functions.begin(), k1.functions.end());
    used.insert(k2.functions.begin(), k2.functions.end());
  }
  t.state = fmt::format("  float {0}_x, {0}_xx{1};\n", x.id, members);
  t.bytes += 8;
  if (!e.states.empty()) t.commit = "  {\n" + half + full + "  }\n";
  t.commit += fmt::format("  c->{0}_xx = c->{0}_x;\n  c->{0}_x = F;\n", x.id);
  return {};
}

bool mentions(const CTerm& t, const std::string& word) {
  return t.value.find(word) != std::string::npos || t.commit.find(word) != std::string::npos;
}

void note_needs(CTerm& t, const std::set<std::string>& used) {
  t.needs_exp = used.count("fg_exp") > 0;
  t.needs_ln = used.count("fg_ln") > 0;
  t.needs_sqrt = used.count("fg_sqrt") > 0;
  t.needs_tanh = used.count("fg_tanh") > 0;
  t.needs_pow = used.count("fg_pow") > 0;
  t.needs_power = used.count("fg_power") > 0;
  t.needs_temperature = mentions(t, "temperature_C");
}

void add_rate(CTerm& t, const CTermContext& x) {
  if (!mentions(t, x.id + "_rate")) return;
  t.constants += fmt::format(
      "static inline float {0}_rate(const FgComp* c, float F) {{\n"
      "  if (c->samples < 2) return c->running ? {1} * (F - c->{0}_x) : 0.0f;\n"
      "  return {1} * ((1.5f * F - 2.0f * c->{0}_x) + 0.5f * c->{0}_xx);\n"
      "}}\n",
      x.id, c_float(x.rate_Hz));
  // beside the force of a steady rate there may be another one that gives the same output
  t.start = fmt::format("(c->samples < 2 ? c->force_N : 2.0f * c->{0}_x - c->{0}_xx)", x.id);
  t.each += 6;
  t.once += 14;
}

}  // namespace

Result<CTerm> c_term(const ModelEffect& e, const CTermContext& x) {
  using namespace c_terms;
  if (e.effect == "creep") return creep(e, x);
  if (e.effect == "hysteresis") return hysteresis(e, x);
  if (e.effect == "lag") return lag(e, x);
  if (e.effect == "thermal") return thermal(e, x);
  if (e.effect == "static_nonlinearity") return curve(e, x);
  if (e.effect == "dead_zone") return dead_zone(e, x);
  const EffectKind* kind = EffectRegistry::instance().find(e.effect);
  if (kind != nullptr && (kind->side == "rig" || kind->side == "reference"))
    return refuse(e.effect, "it is a fault of the " + kind->side + ", and a firmware must not copy it",
                  "mend the " + kind->side);
  const auto known = refusals().find(e.effect);
  if (known != refusals().end()) return refuse(e.effect, known->second.first, known->second.second);
  return refuse(e.effect, "no inverse of it is written",
                "give it as an equation of your own in the model file");
}

Result<CTerm> c_term(const UserEffect& e, const CTermContext& x) {
  const Symbols symbols = symbols_of(e, x.id);
  const std::string where = "effect \"" + e.name + "\"";
  CTerm t;
  for (const ModelParameter& p : e.parameters) t.constants += c_terms::constant("k_" + x.id + "_" + p.name, p.value);
  FORCEGATE_TRY(const CExpression output, c_expression(e.output, where, symbols.at_output));
  t.title = e.name + " (equation of the model file): " + e.output;
  t.value = output.text;
  t.each = output.operations;
  std::set<std::string> used = output.functions;
  FORCEGATE_CHECK_OK(add_states(t, e, x, symbols, where, used));
  note_needs(t, used);
  add_rate(t, x);
  FORCEGATE_TRY(const LeastSlope least, least_slope(e, x));
  t.slope_min = std::min(0.0, kSlopeMargin * least.slope);
  t.margin = std::min(0.0, least.slope) - t.slope_min;
  if (least.slope <= -1.0)
    t.falls = fmt::format("where the force {} from {:.2g} N its output goes the other way by {:.2g} N a newton, so that two forces give one voltage",
                          least.falling ? "falls" : "rises", least.force_N, -least.slope);
  return t;
}

}  // namespace forcegate
