#include <cmath>
#include <nlohmann/json.hpp>

#include "hil/diagnose/diagnosis.h"

namespace forcegate {

using Json = nlohmann::ordered_json;

namespace {

Json number(double v) { return std::isfinite(v) ? Json(v) : Json(nullptr); }

// A claim about raw samples takes them out of the fit, with all others of its kind in one step; what the effects do after
// it is not its own.
double error_after(const Finding& f, const Diagnosis& d) {
  return f.of_samples() && !d.steps.empty() && d.steps.front().effect.empty() ? d.steps.front().error : f.error_after;
}

Json finding_json(const Finding& f, const Diagnosis& d) {
  Json out;
  out["effect"] = f.effect;
  out["side"] = f.side;
  out["probability"] = number(f.probability);
  out["form"] = f.form;
  Json parameters = Json::array();
  for (const FoundParameter& p : f.parameters)
    parameters.push_back(
        {{"name", p.name}, {"value", number(p.value)}, {"u", number(p.u)}, {"unit", p.unit}});
  out["parameters"] = parameters;
  out["error_before"] = number(f.error_before);
  out["error_after"] = number(error_after(f, d));
  out["unit"] = f.unit;
  out["effect_rms"] = number(f.effect_rms);
  Json others = Json::array();
  for (const LookAlike& a : f.confounded_with)
    others.push_back({{"effect", a.effect}, {"cos", number(a.cosine)}, {"separates", a.separates}});
  out["confounded_with"] = others;
  out["in_model"] = f.in_model;
  out["rival_of"] = f.rival_of;
  out["evidence"] = f.evidence;
  out["reservations"] = Json::array();
  for (const Reservation& r : f.reservations) out["reservations"].push_back({{"most", r.most}, {"why", r.why}});
  out["records_improved"] = f.records_improved;
  out["records_excited"] = f.records_excited;
  out["of_every_record"] = f.of_every_record;
  out["counts_parts"] = f.counts_parts;
  out["side_witnessed"] = f.side_witnessed;
  return out;
}

Json adapted_json(bool levels) { return levels ? Json{"decay", "wander"} : Json{"gain", "zero", "decay", "wander"}; }

Json map_json(const ResidualMap& m) {
  Json cells = Json::array();
  for (const MapCell& c : m.cells)
    cells.push_back(
        {{"x", number(c.x)}, {"mean", number(c.mean)}, {"u", number(c.standard_error)}, {"n", c.n}});
  return {{"coordinate", m.coordinate}, {"group", m.group},       {"unit", m.unit},
          {"share", number(m.share)},   {"sentence", m.sentence}, {"cells", cells}};
}

Json errors_json(const Diagnosis& d) {
  Json errors = Json::object();
  for (const auto& [name, pair] : d.errors) {
    errors[name] = {{"before", number(pair.before)}, {"after", number(pair.after)}, {"unit", pair.unit}};
    if (name != "U_plain") errors[name]["adapted"] = adapted_json(pair.levels);
  }
  return errors;
}

Json record_json(const RecordError& r) {
  return {{"record", r.record},
          {"kind", r.kind},
          {"heldout", r.heldout},
          {"before", number(r.before)},
          {"after", number(r.after)},
          {"plain_before", number(r.plain_before)},
          {"plain_after", number(r.plain_after)},
          {"floor", number(r.floor)},
          {"explainable", number(r.explainable)}};
}

Json far_above_json(const RecordFarAbove& r) { return {{"record", r.record}, {"times", number(r.times)}}; }

Json ranked_json(const RankedEffect& r) {
  return {{"effect", r.effect},
          {"side", r.side},
          {"form", r.form},
          {"score", number(r.score)},
          {"alone", number(r.alone)},
          {"unique", number(r.unique)},
          {"probability", number(r.probability)},
          {"null_score", number(r.null_score)},
          {"visible_from", number(r.visible_from)},
          {"note", r.note}};
}

Json repeatability_json(const Repeatability& r) {
  return {{"gain", number(r.gain)},
          {"offset_V", number(r.offset_V)},
          {"log_b", number(r.log_b)},
          {"log_q", number(r.log_q)},
          {"wander_V", number(r.wander_V)}};
}

Json segment_json(const ExperimentSegment& s, std::size_t at) {
  Json numbers = Json::object();
  for (const auto& [name, value] : s.numbers) numbers[name] = number(value);
  for (const auto& [name, values] : s.lists) {
    numbers[name] = Json::array();
    for (const double value : values) numbers[name].push_back(number(value));
  }
  return {{"name", s.name},
          {"stimulus", s.stimulus},
          {"numbers", numbers},
          {"profile", profile_name(s, at)},
          {"low_N", number(s.low_N())},
          {"high_N", number(s.high_N())},
          {"rise_degC", number(s.rise_degC)},
          {"minutes", number(s.minutes)},
          {"separates", s.separates},
          {"cos_before", number(s.cosine_before)},
          {"cos_after", number(s.cosine_after)},
          {"odds_before", number(s.odds_before)},
          {"odds_after", number(s.odds_after)},
          {"odds_from", s.odds_stated ? "probability" : "evidence"}};
}

Json refused_json(const RefusedEffect& r) {
  const diagnose::RefusalTraits& why = diagnose::traits_of(r.reason);
  return {{"effect", r.effect}, {"code", why.code}, {"reason", why.sentence}, {"score", number(r.score)}, {"suspicion", why.suspicion}};
}

template <class T, class ToJson>
Json list_json(const std::vector<T>& items, ToJson one) {
  Json out = Json::array();
  for (const T& item : items) out.push_back(one(item));
  return out;
}

}  // namespace

std::string to_json(const Diagnosis& d) {
  Json out;
  out["format"] = 1;
  out["schema"] = 1;  // what `format` was called first
  out["campaign"] = d.campaign;
  out["model"] = d.model;
  out["verdict"] = to_string(d.verdict);
  out["residual_unknown"] = d.residual_unknown;
  out["findings"] = list_json(d.findings, [&](const Finding& f) { return finding_json(f, d); });
  out["depends_on"] = d.depends_on;
  out["follows"] = d.follows;
  out["error_before"] = number(d.error_before);
  out["error_after"] = number(d.error_after);
  out["unit"] = d.unit;
  out["errors"] = errors_json(d);
  out["floor"] = number(d.floor);
  out["adapted"] = d.no_input ? Json::array() : adapted_json(d.levels);
  out["judged_by"] = to_string(d.judged_by);
  out["plain"] = {{"before", number(d.plain_before)}, {"after", number(d.plain_after)}};
  out["records"] = list_json(d.records, record_json);
  out["far_above"] = list_json(d.far_above, far_above_json);
  out["ranking"] = list_json(d.ranking, ranked_json);
  out["maps"] = list_json(d.maps, map_json);
  out["rig_maps"] = list_json(d.rig_maps, map_json);
  out["repeatability"] = repeatability_json(d.repeatability);
  out["not_separable"] = d.not_separable;
  out["expected_false"] = number(d.expected_false);
  Json segments = Json::array();
  for (const ExperimentSegment& s : d.next_experiment.segments) segments.push_back(segment_json(s, segments.size() + 1));
  out["next_experiment"] = {{"segments", segments},
                            {"minutes", number(d.next_experiment.minutes)},
                            {"sentence", d.next_experiment.sentence}};
  out["refused"] = list_json(d.refused, refused_json);
  out["notes"] = d.notes;
  return out.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace forcegate
