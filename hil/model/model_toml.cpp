#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <toml++/toml.h>

#include "hil/base/text.h"
#include "hil/model/model_toml.h"
#include "hil/model/decay_check.h"
#include "hil/model/equation_unit.h"
#include "hil/model/output_unit.h"
#include "hil/model/user_equation.h"

namespace forcegate {

namespace {

std::string place(const std::string& where, const toml::node& node) {
  return fmt::format("{}:{}:{}", where, node.source().begin.line, node.source().begin.column);
}

// A key that is not read would be a wish that nobody hears.
Result<void> known_keys(const toml::table& table, const std::vector<std::string>& known, const std::string& where,
                        const std::string& nothing_known = "take it out") {
  for (const auto& [key, node] : table)
    if (std::find(known.begin(), known.end(), key.str()) == known.end()) {
      const std::string near = nearest_name(std::string(key.str()), known);
      return fail(ErrorCode::config, fmt::format("\"{}\" means nothing here", std::string(key.str())), place(where, node),
                  known.empty() ? nothing_known : near.empty() ? "known are " + join(known, ", ") : "did you mean \"" + near + "\"?");
    }
  return {};
}

// A value of another type would be the default in silence.
template <class T>
Result<T> value_of(const toml::table& table, const char* name, T otherwise, const std::string& where) {
  const toml::node* node = table[name].node();
  if (node == nullptr) return otherwise;
  if constexpr (std::is_same_v<T, double>) {
    if (const auto value = node->is_number() ? node->value<double>() : std::nullopt) return *value;
    return fail(ErrorCode::config, fmt::format("{} is no number", name), place(where, *node), "write it without quotes: 0.1");
  } else if constexpr (std::is_same_v<T, bool>) {
    if (const auto value = node->value_exact<bool>()) return *value;
    return fail(ErrorCode::config, fmt::format("{} is neither true nor false", name), place(where, *node), "write true or false, without quotes");
  } else {
    if (const auto value = node->value_exact<std::string>()) return *value;
    return fail(ErrorCode::config, fmt::format("{} is no text", name), place(where, *node), "write it in quotes");
  }
}

// A table below `table`, nullptr where there is none.
Result<const toml::table*> section_of(const toml::table& table, const char* name, const std::string& where) {
  const toml::node* node = table[name].node();
  if (node == nullptr) return nullptr;
  if (const toml::table* section = node->as_table()) return section;
  return fail(ErrorCode::config, fmt::format("{} is no table", name), place(where, *node), fmt::format("write {}.NAME = ...", name));
}

// The tables under [[name]].
Result<std::vector<const toml::table*>> tables_of(const toml::table& root, const char* name, const std::string& where) {
  std::vector<const toml::table*> out;
  const toml::node* node = root[name].node();
  if (node == nullptr) return out;
  const toml::array* tables = node->as_array();
  if (tables != nullptr)
    for (const toml::node& one : *tables)
      if (one.is_table()) out.push_back(one.as_table());
  if (tables == nullptr || out.size() != tables->size())
    return fail(ErrorCode::config, fmt::format("{} is no list of tables", name), place(where, *node), fmt::format("write [[{}]]", name));
  return out;
}

std::vector<std::string> names_of(const std::vector<ParameterSpec>& specs) {
  std::vector<std::string> out;
  for (const ParameterSpec& s : specs) out.push_back(s.name);
  return out;
}

Result<ModelParameter> read_parameter(const toml::node& node, const std::string& name, const std::string& where) {
  ModelParameter p{.name = name, .unit = {}, .minimum = -1e300, .maximum = 1e300};
  const auto finite = [&]() -> Result<void> {
    if (std::isfinite(p.value)) return {};
    return fail(ErrorCode::config, fmt::format("{} = {} is no number", name, p.value), place(where, node), "write a finite value");
  };
  if (const auto plain = node.value<double>()) {
    p.value = *plain;
    FORCEGATE_CHECK_OK(finite());
    return p;
  }
  const toml::table* table = node.as_table();
  if (const toml::node* value = table != nullptr ? (*table)["value"].node() : &node; value != nullptr && value->is_string())
    return fail(ErrorCode::config, fmt::format("the value of {} is a text, \"{}\"", name, printable_utf8(value->value_or(std::string()))), place(where, *value), "write the number without quotes");
  if (table == nullptr || !(*table)["value"].value<double>())
    return fail(ErrorCode::config, "parameter " + name + " has no value", place(where, node),
                "write name = { value = 0.1, unit = \"N\" }");
  FORCEGATE_CHECK_OK(known_keys(*table, {"value", "se", "unit", "min", "max", "neutral"}, where));
  p.value = *(*table)["value"].value<double>();
  FORCEGATE_CHECK_OK(finite());
  FORCEGATE_TRY(p.se, value_of(*table, "se", 0.0, where));
  if (!(p.se >= 0.0) || !std::isfinite(p.se))
    return fail(ErrorCode::config, fmt::format("the standard error of {} is {}", name, p.se), place(where, *(*table)["se"].node()),
                "write a number of 0 (not estimated) or more");
  FORCEGATE_TRY(p.unit, value_of(*table, "unit", std::string(), where));
  FORCEGATE_TRY(p.minimum, value_of(*table, "min", -1e300, where));
  FORCEGATE_TRY(p.maximum, value_of(*table, "max", 1e300, where));
  FORCEGATE_TRY(p.neutral, value_of(*table, "neutral", 0.0, where));
  if (p.minimum > p.maximum)
    return fail(ErrorCode::config, fmt::format("the bounds of {} are reversed: min = {} is above max = {}", name, p.minimum, p.maximum), place(where, *(*table)["min"].node()), "exchange the two");
  if (!(p.value >= p.minimum && p.value <= p.maximum))  // a bound may be nan
    return fail(ErrorCode::config, fmt::format("{} = {} lies outside [{}, {}]", name, p.value, p.minimum, p.maximum),
                place(where, node), "change the value or its bounds");
  return p;
}

Result<std::string> read_equation(const toml::node& node, const std::string& of, const std::string& where) {
  if (const auto text = node.value_exact<std::string>(); text && !text->empty()) return *text;
  return fail(ErrorCode::config, of + " is no equation", place(where, node), "write it in quotes: \"F * F\"");
}

// Every symbol of the equations means one thing, and every parameter is in one of them.
Result<void> check_symbols(const UserEffect& effect, const toml::table& table, const std::string& where) {
  std::vector<std::string> taken = user_inputs();
  const auto at = [&](const char* section, const std::string& symbol) { return place(where, *table[section][symbol].node()); };
  const auto take = [&](const char* section, const std::string& symbol) -> Result<void> {
    if (std::ranges::find(taken, symbol) != taken.end())
      return fail(ErrorCode::config,
                  fmt::format("a {} of \"{}\" is called {}, which means something else in the equations", section, effect.name, symbol),
                  at(section, symbol), "give it another name: F, dF, t, T and th are what the record holds");
    taken.push_back(symbol);
    return {};
  };
  for (const auto& [state, derivative] : effect.states) FORCEGATE_CHECK_OK(take("state", state));
  for (const ModelParameter& p : effect.parameters) FORCEGATE_CHECK_OK(take("parameter", p.name));
  FORCEGATE_TRY(const std::unique_ptr<UserEquation> made, UserEquation::make(effect));
  for (const ModelParameter& p : effect.parameters)
    if (!made->uses(p.name))
      return fail(ErrorCode::config, "no equation of \"" + effect.name + "\" has the parameter " + p.name + ": nothing could tell its value",
                  at("parameter", p.name), "write it into an equation, or leave it out");
  return {};
}

Result<UserEffect> read_user_effect(const toml::table& table, const std::string& name, const std::string& where) {
  FORCEGATE_CHECK_OK(known_keys(table, {"name", "output", "state", "parameter"}, where));
  const auto bad = [&](const std::string& what, const std::string& help) {
    return fail(ErrorCode::config, what, place(where, table), help);
  };
  if (EffectRegistry::instance().find(name) != nullptr)
    return bad("the library has an effect \"" + name + "\" of its own", "give yours another name");
  const bool is_name = !name.empty() && std::isalpha(static_cast<unsigned char>(name.front())) != 0 &&
                       std::all_of(name.begin(), name.end(), [](unsigned char c) { return std::isalnum(c) != 0 || c == '_'; });
  if (!is_name) return bad("\"" + name + "\" is no name for an effect", "a letter, then letters, digits and _");
  UserEffect out;
  out.name = name;
  FORCEGATE_TRY(out.output, read_equation(*table["output"].node(), "output", where));
  out.places.push_back(place(where, *table["output"].node()));
  FORCEGATE_TRY(const toml::table* const states, section_of(table, "state", where));
  FORCEGATE_TRY(const toml::table* const parameters, section_of(table, "parameter", where));
  if (states != nullptr)
    for (const auto& [key, node] : *states) {
      FORCEGATE_TRY(std::string derivative, read_equation(node, fmt::format("state.{}", std::string(key.str())), where));
      out.states.emplace_back(std::string(key.str()), std::move(derivative));
      out.places.push_back(place(where, node));
    }
  if (parameters != nullptr)
    for (const auto& [key, node] : *parameters) {
      FORCEGATE_TRY(ModelParameter p, read_parameter(node, std::string(key.str()), where));
      FORCEGATE_CHECK_OK(check_unit_of_equations(p, place(where, node)));
      out.parameters.push_back(std::move(p));
    }
  FORCEGATE_CHECK_OK(check_symbols(out, table, where));
  return out;
}

// A value is taken as it stands: in another unit it would be another value.
Result<void> is_in(const ModelParameter& given, const std::string& unit, const std::string& where) {
  const std::string own = unit.empty() ? "1" : unit;
  if (given.unit.empty() || given.unit == own) return {};
  return fail(ErrorCode::config,
              own == "1" ? fmt::format("{} has no unit, and here it is in \"{}\"", given.name, given.unit)
                         : fmt::format("{} is in {}, not in \"{}\"", given.name, own, given.unit),
              where, "convert the value");
}

Result<ModelEffect> read_effect(const toml::table& table, const EffectKind& kind, const std::string& where) {
  ModelEffect out;
  out.effect = kind.name;
  FORCEGATE_TRY(out.form, value_of(table, "form", kind.forms.empty() ? std::string() : kind.forms.front().name, where));
  const EffectForm* form = find_form(kind, out.form);
  if (form == nullptr) {
    std::vector<std::string> names;
    for (const EffectForm& f : kind.forms) names.push_back(f.name);
    return fail(ErrorCode::config, kind.name + " has no form \"" + out.form + "\"", place(where, table),
                "its forms are " + join(names, ", "));
  }
  FORCEGATE_CHECK_OK(known_keys(table, {"name", "form", "shape", "strength"}, where));
  for (const auto& [section, specs] : {std::pair{"shape", &form->shape}, std::pair{"strength", &form->strength}}) {
    FORCEGATE_TRY(const toml::table* const given, section_of(table, section, where));
    if (given != nullptr)
      FORCEGATE_CHECK_OK(known_keys(*given, names_of(*specs), where,
                                    fmt::format("the form {} of {} has no {}; forcegate explain {} lists the forms with theirs",
                                                out.form, kind.name, section, kind.name)));
  }
  const auto fill = [&](const char* section, const std::vector<ParameterSpec>& specs,
                        std::vector<ModelParameter>& parameters) -> Result<bool> {
    for (const ParameterSpec& spec : specs) {
      ModelParameter p{spec.name, spec.unit, spec.neutral, 0.0, spec.minimum, spec.maximum, spec.neutral};
      if (const toml::node* node = table[section][spec.name].node()) {
        FORCEGATE_TRY(ModelParameter given, read_parameter(*node, spec.name, where));
        FORCEGATE_CHECK_OK(is_in(given, spec.unit, place(where, *node)));
        p.value = given.value;
        p.se = given.se;
        p.minimum = std::min(spec.minimum, given.minimum > -1e299 ? given.minimum : spec.minimum);
        p.maximum = std::max(spec.maximum, given.maximum < 1e299 ? given.maximum : spec.maximum);
        if (p.value < p.minimum || p.value > p.maximum)
          return fail(ErrorCode::config, fmt::format("{} = {} lies outside [{}, {}]", spec.name, p.value, p.minimum, p.maximum),
                      place(where, *node), spec.doc + "; min and max of the file may widen the bounds");
      }
      parameters.push_back(p);
    }
    return true;
  };
  FORCEGATE_CHECK_OK(fill("shape", form->shape, out.shape));
  FORCEGATE_CHECK_OK(fill("strength", form->strength, out.strength));
  return out;
}

Result<ModelFrame> read_frame(const toml::table& law, const std::string& where) {
  ModelFrame out;
  for (const model_toml::FrameKey& key : model_toml::kFrame)
    if (const toml::node* node = law[key.name].node()) {
      const auto value = node->value<double>();
      if (!value || !std::isfinite(*value) || (key.above_0 && !(*value > 0.0)))
        return fail(ErrorCode::config, fmt::format("{} is no number{}", key.name, key.above_0 ? " above 0" : ""), place(where, *node),
                    "it is what the effects were fitted with; forcegate fit writes it");
      out.*key.value = *value;
    }
  return out;
}

Result<HistoryStep> read_step(const toml::table& t, const std::string& where) {
  FORCEGATE_CHECK_OK(known_keys(t, {"effect", "campaign", "error_before", "error_after", "plain_before", "plain_after", "floor", "unit", "accepted", "one_law"}, where));
  HistoryStep step;
  FORCEGATE_TRY(step.effect, value_of(t, "effect", std::string(), where));
  FORCEGATE_TRY(step.campaign, value_of(t, "campaign", std::string(), where));
  const std::pair<const char*, double&> errors[] = {{"error_before", step.error_before}, {"error_after", step.error_after}, {"plain_before", step.plain_before},
                                                    {"plain_after", step.plain_after},   {"floor", step.floor}};
  for (const auto& [name, value] : errors) {
    FORCEGATE_TRY(value, value_of(t, name, 0.0, where));
    if (!(value >= 0.0) || !std::isfinite(value))
      return fail(ErrorCode::config, fmt::format("{} = {} is no error: it is a number of 0 or more", name, value), place(where, *t[name].node()), "forcegate fit and add write it");
  }
  FORCEGATE_TRY(step.unit, value_of(t, "unit", std::string("V"), where));
  FORCEGATE_TRY(step.accepted, value_of(t, "accepted", true, where));
  FORCEGATE_TRY(step.one_law, value_of(t, "one_law", false, where));
  return step;
}

Result<toml::table> parse_toml(std::string_view text, const std::string& where) {
  try {
    return toml::parse(text);
  } catch (const toml::parse_error& error) {
    return fail(ErrorCode::config, "not valid TOML, as a model file is: " + printable_utf8(error.description()),
                fmt::format("{}:{}:{}", where, error.source().begin.line, error.source().begin.column),
                "a model file is what forcegate add -o and forcegate fit -o write (docs/model.md); for the syntax see https://toml.io");
  }
}

Result<void> read_head(const toml::table& root, Model& out, const std::string& where) {
  FORCEGATE_TRY(const double format, value_of(root, "format", 1.0, where));
  if (format != 1.0)
    return fail(ErrorCode::config, fmt::format("format {} of the model file is not known", format), place(where, *root["format"].node()),
                "this program reads format 1");
  FORCEGATE_TRY(out.name, value_of(root, "name", std::string("model"), where));
  FORCEGATE_TRY(out.sensor, value_of(root, "sensor", std::string(), where));
  FORCEGATE_TRY(out.source, value_of(root, "source", std::string(), where));
  FORCEGATE_TRY(out.output_unit, value_of(root, "output_unit", std::string("V"), where));
  return root.contains("output_unit") ? check_output_unit(out.output_unit, place(where, *root["output_unit"].node())) : Result<void>{};
}

// A coefficient of the law in the unit and the range that it must have.
Result<void> check_coefficient(const ModelParameter& p, std::string_view name, const std::string& output_unit, const std::string& where) {
  constexpr double kBeyondAny = 1e12;  // a slip of the exponent, in whatever unit the output comes
  const bool is_gain = name == "gain_N_per_V", is_scale = name == "b_scale" || name == "q_scale", is_share = name == "loading_share";
  const std::string wanted = is_gain ? "N/" + output_unit : name == "offset_N" ? "N" : is_scale || is_share ? "1" : p.unit;
  FORCEGATE_CHECK_OK(is_in(p, wanted, where));
  const double size = std::abs(p.value);
  if (is_gain && p.value == 0.0) return fail(ErrorCode::config, "gain_N_per_V must not be 0", where, "write the newtons that one volt means");
  if (size > kBeyondAny || (is_gain && size < 1.0 / kBeyondAny))
    return fail(ErrorCode::config, fmt::format("{} = {} is beyond any sensor", name, p.value), where, "check its exponent");
  if (is_share && !(p.value >= 0.0 && p.value <= 1.0))
    return fail(ErrorCode::config, fmt::format("loading_share = {} is no share", p.value), where, "0: the decay goes with the time; 1: with the loading done");
  if (is_scale && !(p.value > 0.0))
    return fail(ErrorCode::config, fmt::format("{} = {} is not above 0", name, p.value), where, "1 is the paper's");
  return {};
}

Result<void> read_coefficients(const toml::table& law, Model& out, const std::string& where) {
  const auto take = [&](const char* name, double& value, double* se) -> Result<void> {
    const toml::node* node = law[name].node();
    if (node == nullptr) return {};
    FORCEGATE_TRY(const ModelParameter p, read_parameter(*node, name, where));
    FORCEGATE_CHECK_OK(check_coefficient(p, name, out.output_unit, place(where, *node)));
    value = p.value;
    if (se != nullptr) *se = p.se;
    return {};
  };
  FORCEGATE_CHECK_OK(take("gain_N_per_V", out.law.gain_N_per_V, &out.se_gain));
  FORCEGATE_CHECK_OK(take("offset_N", out.law.offset_N, &out.se_offset));
  FORCEGATE_CHECK_OK(take("b_scale", out.law.b_scale, &out.se_b_scale));
  FORCEGATE_CHECK_OK(take("q_scale", out.law.q_scale, &out.se_q_scale));
  FORCEGATE_CHECK_OK(take("b_slope_s_per_s", out.law.b_slope, nullptr));
  FORCEGATE_CHECK_OK(take("b_intercept_per_s", out.law.b_intercept_per_s, nullptr));
  FORCEGATE_CHECK_OK(take("q_curvature_per_N2", out.law.q_curvature, nullptr));
  FORCEGATE_CHECK_OK(take("loading_share", out.law.loading_share, nullptr));
  return {};
}

Result<void> read_law(const toml::table& root, Model& out, const std::string& where) {
  FORCEGATE_TRY(const toml::table* const law, section_of(root, "law", where));
  if (law == nullptr) return fail(ErrorCode::config, "the model has no [law]", where, "forcegate fit writes one");
  FORCEGATE_CHECK_OK(known_keys(*law, {"kind", "span_N", "gain_N_per_V", "offset_N", "b_scale", "q_scale", "b_slope_s_per_s",
                                       "b_intercept_per_s", "q_curvature_per_N2", "loading_share", "lowest_N", "temperature_C", "humidity_pct", "drive_V",
                                       "travel_N"}, where));
  FORCEGATE_TRY(const std::string kind, value_of(*law, "kind", std::string("decaying"), where));
  if (kind != "static" && kind != "decaying")
    return fail(ErrorCode::config, "there is no law of kind \"" + kind + "\"", place(where, *(*law)["kind"].node()),
                "write \"decaying\" or \"static\"");
  out.law.decays = kind == "decaying";
  FORCEGATE_TRY(out.frame, read_frame(*law, where));
  FORCEGATE_CHECK_OK(read_coefficients(*law, out, where));
  const std::optional<NoDecay> wrong = no_decay(out.law, out.frame.span_N);
  if (!wrong) return {};
  const auto given = std::ranges::find_if(wrong->keys, [&](const char* key) { return law->contains(key); });
  return fail(ErrorCode::config, wrong->text, place(where, given == wrong->keys.end() ? *law : *(*law)[*given].node()), wrong->hint);
}

Result<const EffectKind*> known_effect(const std::string& name, const std::string& where) {
  const EffectKind* kind = EffectRegistry::instance().find(name);
  if (kind == nullptr) {
    const std::string near = nearest_name(name, EffectRegistry::instance().names());
    return fail(ErrorCode::config, "no effect \"" + name + "\"", where,
                near.empty() ? "give equations (output = ...) for an effect of your own" : "did you mean \"" + near + "\"?");
  }
  if (kind->forms.empty())
    return fail(ErrorCode::config, name + " is found in the samples and is no part of a model: nothing of it can be computed from the force",
                where, "take it out");
  return kind;
}

Result<void> read_effects(const toml::table& root, Model& out, const std::string& where) {
  FORCEGATE_TRY(const std::vector<const toml::table*> effects, tables_of(root, "effect", where));
  for (const toml::table* table : effects) {
    FORCEGATE_TRY(const std::string name, value_of(*table, "name", std::string(), where));
    const bool twice = std::any_of(out.user_effects.begin(), out.user_effects.end(), [&](const UserEffect& e) { return e.name == name; });
    if (twice) return fail(ErrorCode::config, "two effects are called \"" + name + "\"", place(where, *table), "rename one of them");
    if (table->contains("output")) {
      FORCEGATE_TRY(UserEffect user, read_user_effect(*table, name, where));
      out.user_effects.push_back(std::move(user));
      continue;
    }
    FORCEGATE_CHECK_OK(known_keys(*table, {"name", "output", "state", "parameter", "form", "shape", "strength"}, where));  // a slip in "output" too
    FORCEGATE_TRY(const EffectKind* const kind, known_effect(name, place(where, *table)));
    FORCEGATE_TRY(ModelEffect effect, read_effect(*table, *kind, where));
    out.effects.push_back(std::move(effect));
  }
  return {};
}

Result<void> read_history(const toml::table& root, Model& out, const std::string& where) {
  FORCEGATE_TRY(const std::vector<const toml::table*> history, tables_of(root, "history", where));
  for (const toml::table* table : history) {
    FORCEGATE_TRY(HistoryStep step, read_step(*table, where));
    out.history.push_back(std::move(step));
  }
  return {};
}

}  // namespace

Result<Model> parse_model(std::string_view text, const std::string& where) {
  FORCEGATE_TRY(const toml::table root, parse_toml(text, where));
  FORCEGATE_CHECK_OK(known_keys(root, {"format", "name", "sensor", "source", "output_unit", "law", "effect", "history"}, where));
  Model out;
  FORCEGATE_CHECK_OK(read_head(root, out, where));
  FORCEGATE_CHECK_OK(read_law(root, out, where));
  FORCEGATE_CHECK_OK(read_effects(root, out, where));
  FORCEGATE_CHECK_OK(read_history(root, out, where));
  return out;
}

}  // namespace forcegate
