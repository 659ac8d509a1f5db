#include "rigs/emulated/hidden/truth.h"

#include <nlohmann/json.hpp>

namespace forcegate::hidden {
namespace {

using Json = nlohmann::ordered_json;

Json to_object(const TruthEffect& e) {
  return Json{{"name", e.name},
              {"side", e.side},
              {"also_side", e.also_side},
              {"form", e.form},
              {"measure", e.measure},
              {"foreign", e.foreign},
              {"reducible", e.reducible},
              {"strength", e.strength},
              {"rms_pct", e.rms_pct},
              {"rms_voltage_pct", e.rms_voltage_pct},
              {"rms_force_pct", e.rms_force_pct},
              {"heldout_rms", e.heldout_rms},
              {"excited", e.excited},
              {"between_records", e.between_records},
              {"detectability", e.detectability},
              {"cause_recorded", e.cause_recorded},
              {"record_rms_pct", e.record_rms_pct},
              {"depends_on", e.depends_on}};
}

TruthEffect effect_of(const Json& j) {
  TruthEffect e;
  j.at("name").get_to(e.name);
  j.at("side").get_to(e.side);
  j.at("also_side").get_to(e.also_side);
  j.at("form").get_to(e.form);
  j.at("measure").get_to(e.measure);
  j.at("foreign").get_to(e.foreign);
  j.at("reducible").get_to(e.reducible);
  j.at("strength").get_to(e.strength);
  j.at("rms_pct").get_to(e.rms_pct);
  j.at("rms_voltage_pct").get_to(e.rms_voltage_pct);
  j.at("rms_force_pct").get_to(e.rms_force_pct);
  j.at("heldout_rms").get_to(e.heldout_rms);
  j.at("excited").get_to(e.excited);
  e.between_records = j.value("between_records", false);
  e.detectability = j.value("detectability", 0.0);
  e.cause_recorded = j.value("cause_recorded", true);
  j.at("record_rms_pct").get_to(e.record_rms_pct);
  j.at("depends_on").get_to(e.depends_on);
  return e;
}

}  // namespace

std::string_view to_string(Tier tier) {
  switch (tier) {
    case Tier::none: return "none";
    case Tier::weak: return "weak";
    case Tier::medium: return "medium";
    case Tier::strong: return "strong";
  }
  return "?";
}

Result<Tier> tier_of(std::string_view name) {
  for (const Tier tier : {Tier::none, Tier::weak, Tier::medium, Tier::strong})
    if (name == to_string(tier)) return tier;
  return fail(ErrorCode::usage, "unknown strength \"" + std::string(name) + "\"", "",
              "choose weak, medium or strong");
}

std::string to_json(const Truth& t) {
  Json effects = Json::array();
  for (const TruthEffect& e : t.effects) effects.push_back(to_object(e));
  const Json j = {{"format", 1},
                  {"campaign", t.campaign},
                  {"seed", t.seed},
                  {"tier", to_string(t.tier)},
                  {"effects", std::move(effects)},
                  {"voltage_span_V", t.voltage_span_V},
                  {"force_span_N", t.force_span_N},
                  {"voltage_noise_pct", t.voltage_noise_pct},
                  {"force_noise_pct", t.force_noise_pct},
                  {"repeatability_pct", t.repeatability_pct},
                  {"minutes", t.minutes},
                  {"conditions", t.conditions}};
  return j.dump(1);
}

Result<Truth> truth_from_json(const std::string& text) {
  try {
    const Json j = Json::parse(text);
    if (j.at("format") != 1)
      return fail(ErrorCode::parse, "the sheet has a format that this version cannot read");
    Truth t;
    j.at("campaign").get_to(t.campaign);
    j.at("seed").get_to(t.seed);
    FORCEGATE_TRY(t.tier, tier_of(j.at("tier").get<std::string>()));
    for (const Json& e : j.at("effects")) t.effects.push_back(effect_of(e));
    j.at("voltage_span_V").get_to(t.voltage_span_V);
    j.at("force_span_N").get_to(t.force_span_N);
    j.at("voltage_noise_pct").get_to(t.voltage_noise_pct);
    j.at("force_noise_pct").get_to(t.force_noise_pct);
    j.at("repeatability_pct").get_to(t.repeatability_pct);
    t.minutes = j.value("minutes", t.minutes);  // sheets of older campaigns do not say it
    j.at("conditions").get_to(t.conditions);
    return t;
  } catch (const Json::exception& e) {
    return fail(ErrorCode::parse, std::string("the truth sheet is damaged: ") + e.what());
  }
}

}  // namespace forcegate::hidden
