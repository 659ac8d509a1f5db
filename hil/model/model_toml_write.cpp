#include <fmt/format.h>

#include <cmath>

#include "hil/base/text.h"
#include "hil/model/model.h"
#include "hil/model/model_toml.h"

namespace forcegate {

namespace {

// A basic string of TOML.
std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\')
      out += std::string("\\") + c;
    else if (static_cast<unsigned char>(c) < 0x20)
      out += fmt::format("\\u{:04X}", static_cast<unsigned>(c));
    else
      out += c;
  }
  return out + "\"";
}

std::string number(double v) {
  const std::string text = shortest(v);
  return text.find_first_of(".en") == std::string::npos ? text + ".0" : text;
}

std::string parameter_text(const ModelParameter& p) {
  std::string out =
      fmt::format("{{ value = {}, se = {}, unit = \"{}\"", number(p.value), number(p.se), p.unit);
  if (p.minimum > -1e299) out += fmt::format(", min = {}", number(p.minimum));
  if (p.maximum < 1e299) out += fmt::format(", max = {}", number(p.maximum));
  return out + fmt::format(", neutral = {} }}", number(p.neutral));
}

}  // namespace

std::string write_model(const Model& m) {
  std::string out = "format = 1\n";
  out += fmt::format("name = {}\nsensor = {}\nsource = {}\n", quoted(m.name), quoted(m.sensor), quoted(m.source));
  if (m.output_unit != "V") out += fmt::format("output_unit = {}\n", quoted(m.output_unit));
  out += "\n[law]\n";
  out += fmt::format("kind = \"{}\"\n", m.law.decays ? "decaying" : "static");
  for (const model_toml::FrameKey& key : model_toml::kFrame)
    if (std::isfinite(m.frame.*key.value)) out += fmt::format("{} = {}\n", key.name, number(m.frame.*key.value));
  const auto line = [&](const char* name, double value, double se, const std::string& unit) {
    out +=
        fmt::format("{} = {{ value = {}, se = {}, unit = \"{}\" }}\n", name, number(value), number(se), unit);
  };
  line("gain_N_per_V", m.law.gain_N_per_V, m.se_gain, "N/" + m.output_unit);
  line("offset_N", m.law.offset_N, m.se_offset, "N");
  if (m.law.decays) {
    line("b_scale", m.law.b_scale, m.se_b_scale, "1");
    line("q_scale", m.law.q_scale, m.se_q_scale, "1");
    out += fmt::format("b_slope_s_per_s = {}\nb_intercept_per_s = {}\nq_curvature_per_N2 = {}\n",
                       number(m.law.b_slope), number(m.law.b_intercept_per_s), number(m.law.q_curvature));
    if (m.law.loading_share > 0.0) out += fmt::format("loading_share = {}\n", number(m.law.loading_share));
  }
  for (const ModelEffect& e : m.effects) {
    out += fmt::format("\n[[effect]]\nname = \"{}\"\nform = \"{}\"\n", e.effect, e.form);
    for (const ModelParameter& p : e.shape) out += fmt::format("shape.{} = {}\n", p.name, parameter_text(p));
    for (const ModelParameter& p : e.strength)
      out += fmt::format("strength.{} = {}\n", p.name, parameter_text(p));
  }
  for (const UserEffect& e : m.user_effects) {
    out += fmt::format("\n[[effect]]\nname = {}\noutput = {}\n", quoted(e.name), quoted(e.output));
    for (const auto& [name, derivative] : e.states)
      out += fmt::format("state.{} = {}\n", name, quoted(derivative));
    for (const ModelParameter& p : e.parameters)
      out += fmt::format("parameter.{} = {}\n", p.name, parameter_text(p));
  }
  for (const HistoryStep& s : m.history)
    out += fmt::format(
        "\n[[history]]\neffect = {}\ncampaign = {}\nerror_before = {}\nerror_after = {}\nplain_before = {}\n"
        "plain_after = {}\n{}unit = \"{}\"\naccepted = {}\n",
        quoted(s.effect), quoted(s.campaign), number(s.error_before), number(s.error_after), number(s.plain_before),
        number(s.plain_after), s.one_law ? std::string("one_law = true\n") : "floor = " + number(s.floor) + "\n", s.unit, s.accepted);
  return out;
}

}  // namespace forcegate
