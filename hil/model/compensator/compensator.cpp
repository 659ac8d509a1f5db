#include "hil/model/compensator/compensator.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "hil/base/text.h"
#include "hil/model/compensator/c_expression.h"
#include "hil/model/compensator/c_term_parts.h"
#include "hil/model/compensator/c_text.h"

namespace forcegate {
namespace {

constexpr int kEvaluations = 12;
constexpr double kLeastSlope = 0.1;

std::string comment(const std::string& text) {
  std::string safe = text;
  for (const auto& [mark, apart] : {std::pair{"*/", "* /"}, std::pair{"/*", "/ *"}})
    for (std::size_t at = 0; (at = safe.find(mark, at)) != std::string::npos;) safe.replace(at, 2, apart);
  return safe;
}

// Within quotes of C.
std::string plain_word(std::string text) {
  std::erase_if(text, [](unsigned char c) { return c < 0x20 || c == '"' || c == '\\'; });
  return text;
}

std::string define(const char* name, double value) {
  return fmt::format("#define {} {}\n", name, c_float(value));
}

// Whole, as the preprocessor compares it; else as it is.
std::string rate_text(double rate_Hz) { return rate_Hz == std::round(rate_Hz) ? fmt::format("{:.0f}", rate_Hz) : c_float(rate_Hz); }

// "static_nonlinearity" in 17: "static_nonlinear"; a word of one or two letters at the end says nothing.
std::string abbreviated(const std::string& name, std::size_t most) {
  if (name.size() <= most) return name;
  std::string out = name.substr(0, most);
  const std::size_t word = out.rfind('_');
  if (word != std::string::npos && out.size() - word <= 3) out.resize(word);
  while (out.size() > 3 && std::string_view("aeiou").find(out.back()) != std::string_view::npos) out.pop_back();
  return out;
}

// The field of the protocol has room for 17 characters beside the firmware's own name. Whole where they fit; else each effect is cut
// alike ("hysteresis+static_nonlinearity" -> "hysteres+static"), never so that only the last ones vanish.
std::string shortened_id(const std::string& id) {
  constexpr std::size_t kMost = 17, kFewest = 3;
  if (id.size() <= kMost) return id;
  const std::vector<std::string> names = split(id, '+');
  if (names.size() * (kFewest + 1) > kMost + 1) return std::to_string(names.size()) + "_effects";
  const auto joined = [&](std::size_t most) {
    std::string out;
    for (const std::string& name : names) out += (out.empty() ? "" : "+") + abbreviated(name, most);
    return out;
  };
  std::size_t most = kMost;
  while (most > kFewest && joined(most).size() > kMost) --most;
  return joined(most);
}

std::string short_id(const Model& model) {
  std::string id;
  std::set<std::string> named;  // an effect may stand in the model with several forms
  for (const std::string& name : model.effect_names())
    if (named.insert(name).second) id += (id.empty() ? "" : "+") + name;
  for (const UserEffect& e : model.user_effects) id += (id.empty() ? "" : "+") + e.name;
  if (id.empty()) id = "law";
  std::erase_if(
      id, [](char c) { return !(std::isalnum(static_cast<unsigned char>(c)) || c == '+' || c == '_'); });
  return shortened_id(id);
}

// A firmware begins where it is switched on: banks of plays that differ in what they kept from the record before are one bank.
std::vector<ModelEffect> merged(const std::vector<ModelEffect>& effects) {
  std::vector<ModelEffect> out;
  for (const ModelEffect& e : effects) {
    const auto same = std::find_if(out.begin(), out.end(), [&](const ModelEffect& o) { return o.effect == e.effect && o.form == e.form; });
    if (same == out.end() || !e.form.starts_with("play_bank")) {
      out.push_back(e);
      continue;
    }
    for (std::size_t k = 0; k < e.strength.size(); ++k) same->strength[k].value += e.strength[k].value;
  }
  return out;
}

std::string calibration_text(const CalibrationMap& m) {
  std::string out =
      "/* From calibration values that a protocol without these effects measured to those of the model's law";
  out += m.known
             ? ":\n   " + comment(m.protocol) +
                   fmt::format(".\n   Affine in b and c/a, within {:.2g} % of the simulated protocol. */\n",
                               m.residual_pct)
             : ": not made, they are\n   taken as they come. */\n";
  out +=
      "static inline void fg_comp_calibrate(float* gain_N_per_V, float* offset_N, float* b_scale, float* q_scale) {\n";
  if (m.known) {
    out += fmt::format("  *gain_N_per_V = *gain_N_per_V / {0};\n  *offset_N = (*offset_N - {1}) / {0};\n",
                       c_float(m.alpha), c_float(m.beta_N));
    out += fmt::format("  const float b = *b_scale, q = *q_scale;\n");
    out += fmt::format("  *b_scale = {} + ({} * b + {} * q);\n", c_float(m.b[0]), c_float(m.b[1]),
                       c_float(m.b[2]));
    out += fmt::format("  *q_scale = {} + ({} * b + {} * q);\n", c_float(m.q[0]), c_float(m.q[1]),
                       c_float(m.q[2]));
    out += "  if (!(*b_scale > 0.05f)) *b_scale = 0.05f;\n  if (!(*q_scale > 0.05f)) *q_scale = 0.05f;\n";
  } else {
    out += "  (void)gain_N_per_V, (void)offset_N, (void)b_scale, (void)q_scale;\n";
  }
  return out + "}\n\n";
}

Result<std::vector<CTerm>> terms_of(const Model& model, const CompensatorOptions& options) {
  CTermContext context;
  context.rate_Hz = options.rate_Hz;
  context.span_N = model.frame.span_N;
  context.knows_lowest = std::isfinite(model.frame.lowest_N);
  if (context.knows_lowest) context.lowest_N = model.frame.lowest_N;
  context.reference_temperature_C = std::isfinite(model.frame.temperature_C) ? model.frame.temperature_C : options.reference_temperature_C;
  std::vector<CTerm> out;
  for (const ModelEffect& e : merged(model.effects)) {
    context.id = fmt::format("e{}", out.size());
    FORCEGATE_TRY(CTerm term, c_term(e, context));
    if (!term.value.empty()) out.push_back(std::move(term));
  }
  for (const UserEffect& e : model.user_effects) {
    context.id = fmt::format("e{}", out.size());
    FORCEGATE_TRY(CTerm term, c_term(e, context));
    out.push_back(std::move(term));
  }
  return out;
}

// What the terms come to together.
struct Together {
  double slope = 1.0;        // dE/dF at least, of a sudden change of force
  double margin = 0.0;       // what was found lies higher by so much
  int once = 40, each = 6;   // floating-point operations, of a sample and of an evaluation
  std::size_t state_bytes = 48;
  bool exp = false, ln = false, sqrt = false, tanh = false, pow = false, power = false, temperature = false;  // functions and inputs

  explicit Together(const std::vector<CTerm>& terms) {
    for (const CTerm& t : terms) {
      slope += t.slope_min;
      margin += t.margin;
      once += t.once;
      each += t.each + 1;
      state_bytes += t.bytes;
      exp |= t.needs_exp || t.needs_tanh;
      ln |= t.needs_ln;
      sqrt |= t.needs_sqrt;
      tanh |= t.needs_tanh;
      pow |= t.needs_pow;
      power |= t.needs_power;
      temperature |= t.needs_temperature;
    }
  }
};

std::string what_else(const std::string& effect) {
  if (effect == "hysteresis") return "accept the loop: where its play swallows a reversal, the output stands still and nothing tells the force";
  if (effect == "lag") return "filter the reference alike, or accept the lag";
  return "accept it, or filter the reference alike";
}

Result<void> check_can_be_inverted(const std::vector<CTerm>& terms, double slope, double margin, double rate_Hz) {
  if (slope >= kLeastSlope) return {};
  std::string steepest = "the model", falls;
  double least = 0.0;
  for (const CTerm& t : terms)
    if (t.slope_min < least) least = t.slope_min, steepest = t.title.substr(0, t.title.find(':')), falls = t.falls;
  if (!falls.empty())
    return c_terms::refuse(steepest, falls, "export a model file without this effect, or give it an equation that grows with the force");
  return fail(ErrorCode::config,
              fmt::format("{} cannot be compensated on a microcontroller: it leaves {:.2g} of a sudden change of force in the output{}, and its "
                          "inverse at {:g} Hz would amplify noise by more than {:.0f}",
                          steepest, std::max(0.0, slope + margin),
                          slope + margin < kLeastSlope ? "" : " where that was tried, less than a tenth for certain", rate_Hz, 1.0 / kLeastSlope),
              steepest, what_else(steepest));
}

std::string opening_comment(const Model& model, const CompensatorOptions& options, const std::vector<CTerm>& terms, const Compensator& made) {
  std::string out = "/* Compensator of the model \"" + comment(model.name) + "\"";
  if (!model.sensor.empty()) out += ", " + comment(model.sensor);
  out += ".\n   Made by forcegate export; do not edit, export again.\n";
  for (const std::string& line : options.provenance) out += "   " + comment(line) + "\n";
  out += "\n   u = G U + F0 is solved for F:  u = F_low + D (F - F_low)";
  for (std::size_t k = 0; k < terms.size(); ++k) out += fmt::format(" + e{}(F)", k);
  out += "\n";
  if (const std::string input = input_in_words(model); !input.empty())
    out += "   U is " + comment(input) + ": no voltage. G is in N/" + comment(model.output_unit) + ".\n";
  for (std::size_t k = 0; k < terms.size(); ++k) out += fmt::format("   e{}  {}\n", k, comment(terms[k].title));
  return out + fmt::format(
      "\n   Cost of a sample at {:g} Hz: at most {} floating-point operations (at most {} evaluations of the right side), {} bytes of\n"
      "   state. No heap, no libm, no double. Noise of one sample is amplified by at most {:.2f} at rest.\n"
      "   The bits are the same on every processor with IEEE 754 single precision, without contraction into fused operations\n"
      "   (-ffp-contract=off) and without -ffast-math. */\n",
      options.rate_Hz, made.operations, kEvaluations, made.state_bytes, made.noise_gain);
}

// Of a decay that goes with the time, which is what an implementation takes t for, nothing.
std::string clock_of_decay(const BaseLaw& law) {
  if (!law.decays || law.loading_share == 0.0) return "";
  return "/* t is (1 - p) of the time since the cycling began and p of X/(4 A f), X the loading done since then: sum |dF|, N. */\n" + define("FG_COMP_LOADING_SHARE", law.loading_share);
}

std::string definitions(const Model& model, double rate_Hz, const Compensator& made) {
  const std::string guard =
      "#ifndef FORCEGATE_COMPENSATION_H\n#define FORCEGATE_COMPENSATION_H\n\n#include <stdint.h>\n#include <string.h>\n\n"
      "#ifdef __FAST_MATH__\n#error \"the compensator needs IEEE 754 arithmetic: build without -ffast-math\"\n#endif\n\n";
  const std::string facts = fmt::format("#define FG_COMP_ID \"{}\"\n#define FG_COMP_RATE_HZ {}\n#define FG_COMP_NEEDS_TEMPERATURE {}\n\n", made.id,
                                        rate_text(rate_Hz), made.needs_temperature ? 1 : 0) +
                            "#define FG_COMP_INPUT_UNIT \"" + plain_word(model.output_unit) + "\"\n";
  return guard + facts +
         "/* The fitted law, for those who calibrate by the model itself: F = G U + F0; b = b_scale (slope f + constant), f in Hz;\n"
         "   q = q_scale / (1 + curvature A^2), A in N; D = (exp(-b t) + q)/(1 + q). */\n" +
         define("FG_COMP_GAIN_N_PER_V", model.law.gain_N_per_V) + define("FG_COMP_OFFSET_N", model.law.offset_N) +
         define("FG_COMP_B_SLOPE", model.law.b_slope) + define("FG_COMP_B_CONSTANT_PER_S", model.law.b_intercept_per_s) +
         define("FG_COMP_Q_CURVATURE_PER_N2", model.law.q_curvature) + define("FG_COMP_B_SCALE", model.law.b_scale) +
         define("FG_COMP_Q_SCALE", model.law.q_scale) + clock_of_decay(model.law) + "\n";
}

std::string state_and_constants(const std::vector<CTerm>& terms) {
  std::string out =
      "typedef struct {\n"
      "  float u_N, shrink, low_N, temperature_C, t_s; /* of this sample */\n"
      "  float force_N;                                /* found */\n"
      "  float turn_u_N, turn_e_N, at_floor_N;         /* what the effects added at the last trough */\n"
      "  int running, falling;\n"
      "  uint32_t samples;\n";
  for (const CTerm& t : terms) out += t.state;
  out += "} FgComp;\n\n";
  for (std::size_t k = 0; k < terms.size(); ++k)
    if (!terms[k].constants.empty()) out += fmt::format("/* e{} {} */\n", k, comment(terms[k].title)) + terms[k].constants + "\n";
  return out + "static inline void fg_comp_reset(FgComp* c) { memset(c, 0, sizeof *c); }\n\n";
}

std::string added_by_effects(const std::vector<CTerm>& terms) {
  std::string out =
      "static inline float fg_comp_added(const FgComp* c, float F) {\n"
      "  const float W = c->low_N + c->shrink * (F - c->low_N);\n"
      "  float e = 0.0f;\n";
  for (const CTerm& t : terms) out += "  e += " + t.value + ";\n";
  return out + "  (void)W, (void)c, (void)F;\n  return e;\n}\n\n";
}

std::string step_of_sample(const std::vector<CTerm>& terms, double rate_Hz, double noise_gain) {
  constexpr double kRoom = 1.05;
  std::string prepare, commit, start = "c->force_N";
  for (const CTerm& t : terms) {
    if (!t.start.empty()) start = t.start;
    prepare += t.prepare;
    commit += t.commit;
  }
  return c_text::step(prepare, commit, start, noise_gain * kRoom, 1.0 / rate_Hz, kEvaluations - 2);
}

}  // namespace

std::string input_in_words(const Model& model) {
  const std::string& unit = model.output_unit;
  if (unit == "V") return {};
  if (unit == "S") return "the conductance in S, 1/R with R in ohm";
  if (unit == "1") return "a ratio";
  if (unit == "counts") return "counts of the converter as they were recorded";
  return "the output in " + unit;
}

Result<Compensator> make_compensator(const Model& model, const CompensatorOptions& options) {
  constexpr int kBesideEvaluation = 7;  // operations
  FORCEGATE_TRY(const std::vector<CTerm> terms, terms_of(model, options));
  const Together all(terms);
  FORCEGATE_CHECK_OK(check_can_be_inverted(terms, all.slope, all.margin, options.rate_Hz));
  Compensator out;
  out.id = short_id(model);
  for (const CTerm& t : terms) out.effects.push_back(t.title);
  out.needs_temperature = all.temperature;
  out.state_bytes = all.state_bytes;
  out.noise_gain = 1.0 / all.slope;
  out.operations = all.once + kEvaluations * (all.each + kBesideEvaluation);
  out.header = opening_comment(model, options, terms, out) + definitions(model, options.rate_Hz, out) +
               c_text::elementary(all.exp, all.ln, all.sqrt, all.tanh) + c_text::powers(all.pow, all.power) + state_and_constants(terms) +
               calibration_text(options.calibration) + added_by_effects(terms) + c_text::residual() +
               step_of_sample(terms, options.rate_Hz, out.noise_gain) + "#endif\n";
  return out;
}

}  // namespace forcegate
