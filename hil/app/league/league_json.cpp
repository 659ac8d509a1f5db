#include <cmath>
#include <nlohmann/json.hpp>

#include "hil/app/league/league.h"
#include "hil/app/league/league_stage.h"
#include "hil/app/league/league_tally.h"
#include "hil/base/json_number.h"
#include "hil/gate/statistics.h"

namespace forcegate {
namespace {

using Json = nlohmann::ordered_json;

Json to_json(const Count& count) {
  const Interval i = wilson_95(count.k, count.n);
  return {{"k", count.k}, {"n", count.n}, {"low", i.low}, {"high", i.high}};
}

Json exact_json(const Count& count) {
  const Interval95 i = clopper_pearson_95(count.k, count.n);
  return {{"k", count.k}, {"n", count.n}, {"low", i.low}, {"high", i.high}};
}

Json to_json(const TierTally& tier) {
  return {{"top1", to_json(tier.named)},
          {"top2", to_json(tier.top2)},
          {"top3", to_json(tier.top3)},
          {"top1_excited", to_json(tier.named_excited)},
          {"top1_within_records", to_json(tier.within)},
          {"top1_between_records", to_json(tier.between)},
          {"top1_between_records_plain", to_json(tier.between_plain)},
          {"look_alike", to_json(tier.look_alike)},
          {"side_right", to_json(tier.side)},
          {"with_false_claim", to_json(tier.false_claims)},
          {"removed_median", json_number<Json>(score_quantile(tier.removed, 0.5))},
          {"removed_lower_quartile", json_number<Json>(score_quantile(tier.removed, 0.25))},
          {"removed_n", tier.removed.size()},
          {"removed_median_named", json_number<Json>(score_quantile(tier.removed_named, 0.5))},
          {"removed_n_named", tier.removed_named.size()}};
}

Json to_json(const LeagueMatch& m) {
  Json truth = Json::array(), findings = Json::array();
  for (const auto& e : m.truth.effects)
    truth.push_back({{"effect", e.name},
                     {"side", e.side},
                     {"rms_pct", e.rms_pct},
                     {"rms_voltage_pct", e.rms_voltage_pct},
                     {"excited", e.excited},
                     {"between_records", e.between_records},
                     {"detectability", e.detectability},
                     {"cause_recorded", e.cause_recorded},
                     {"form", e.form}});
  for (const auto& f : m.answer.findings)
    findings.push_back({{"effect", f.effect}, {"side", f.side}, {"probability", f.probability}});
  Json j = {{"id", m.id},
            {"seed", m.seed},
            {"minutes", m.minutes},
            {"tier", hidden::to_string(m.tier)},
            {"truth", truth},
            {"conditions", m.truth.conditions},
            {"repeatability_pct", m.truth.repeatability_pct},
            {"verdict", m.answer.verdict},
            {"findings", findings},
            {"depends_on", m.answer.depends_on},
            {"rank", m.score.rank},
            {"miss", is_miss(m)},
            {"largest_correlation", m.naive},
            {"side_right", m.score.side_right},
            {"false_claims", m.score.false_claims},
            {"reason", m.answer.reason}};
  if (const auto& r = m.score.reduction) {
    j["held_out_error"] = {{"before", r->before}, {"after", r->after}, {"twin", r->twin}, {"unit", r->unit}};
    j["reducible_error_removed"] = r->share();
  }
  if (!m.error.empty()) j["error"] = m.error;
  if (const Miss miss = miss_of(m); miss.stage != MissStage::none)
    j["lost"] = {{"stage", to_string(miss.stage)},
                 {"effect", miss.effect},
                 {"other", miss.other},
                 {"detail", miss.detail}};
  return j;
}

}  // namespace

std::string league_json(const LeagueResult& result) {
  const LeagueTally t = tally(result);
  Json calibration = Json::array(), matches = Json::array();
  for (const CalibrationBin& bin : t.calibration)
    if (bin.truth.n > 0)
      calibration.push_back({{"low", bin.low},
                             {"high", bin.high},
                             {"stated", bin.stated / static_cast<double>(bin.truth.n)},
                             {"true", to_json(bin.truth)}});
  for (const LeagueMatch& m : result.matches) matches.push_back(to_json(m));
  const Json j = {{"format", 1},
                  {"seed", result.request.seed},
                  {"size", result.request.full ? "full" : "small"},
                  {"engine", result.engine},
                  {"weak", to_json(t.tiers[0])},
                  {"medium", to_json(t.tiers[1])},
                  {"strong", to_json(t.tiers[2])},
                  {"false_discovery_on_controls", exact_json(t.control_false)},
                  {"false_claims_on_controls", exact_json(t.control_claims)},
                  {"largest_correlation",
                   {{"weak", to_json(t.naive_named[0])},
                    {"medium", to_json(t.naive_named[1])},
                    {"strong", to_json(t.naive_named[2])},
                    {"false_discovery_on_controls", exact_json(t.naive_control_false)}}},
                  {"foreign_called_unknown", to_json(t.foreign_honest)},
                  {"foreign_coordinate_named", to_json(t.foreign_coordinate)},
                  {"pairs_both_in_three", to_json(t.pairs)},
                  {"sensor_blamed_for_others", to_json(t.sensor_blamed)},
                  {"no_answer", to_json(t.no_answer)},
                  {"calibration_error", t.calibration_error},
                  {"calibration", calibration},
                  {"matches", matches},
                  {"seconds",
                   {{"engine_median", json_number<Json>(score_quantile(t.engine_s, 0.5))},
                    {"engine_95", json_number<Json>(score_quantile(t.engine_s, 0.95))},
                    {"engine_max", json_number<Json>(score_quantile(t.engine_s, 1.0))},
                    {"generation_median", json_number<Json>(score_quantile(t.generation_s, 0.5))},
                    {"whole", result.seconds}}}};
  return j.dump(1);
}

}  // namespace forcegate
