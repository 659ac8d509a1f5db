#include <cmath>
#include <nlohmann/json.hpp>

#include "hil/app/power/power.h"
#include "hil/base/json_number.h"
#include "hil/gate/statistics.h"

namespace forcegate {
namespace {

using Json = nlohmann::ordered_json;

Json count(std::size_t k, std::size_t n) {
  const Interval95 i = clopper_pearson_95(k, n);
  return {{"k", k}, {"n", n}, {"low", i.low}, {"high", i.high}};
}

Json to_json(const MutantOutcome& o) {
  Json checks = Json::object();
  for (const auto& [id, n] : o.checks) checks[id] = n;
  return {{"name", o.mutant.name},
          {"family", o.mutant.family},
          {"level", o.mutant.level ? json_number<Json>(*o.mutant.level) : Json(nullptr)},
          {"unit", o.mutant.unit},
          {"kind", o.mutant.good() ? "good" : "bad"},
          {"breaks", o.mutant.breaks},
          {"promise", o.mutant.promise},
          {"expected", o.mutant.seen_by},
          {"as_expected", o.as_expected},
          {"runs", o.runs},
          {"rejected", o.rejected},
          {"accepted", o.accepted},
          {"undecided", o.runs - o.rejected - o.accepted},
          {"rejected_by", checks},
          {"rejected_without_conformance",
           o.blind_runs > 0 ? count(o.blind_rejected, o.blind_runs) : Json(nullptr)},
          {"reason", o.reason},
          {"note", o.mutant.note}};
}

Json to_json(const ReferenceRuns& r) {
  return {{"plan", r.plan_name},    {"first_seed", r.first_seed},         {"runs", r.n},
          {"accepted", r.accepted}, {"rejected", count(r.rejected, r.n)}, {"not_accepted", r.reasons}};
}

Json to_json(const FamilyOutcome& f) {
  Json levels = Json::array();
  for (const MutantOutcome* o : f.levels)
    levels.push_back({{"level", *o->mutant.level},
                      {"rejected", count(o->rejected, o->runs)},
                      {"slipped", count(o->accepted, o->runs)}});
  return {{"family", f.family},
          {"unit", f.unit},
          {"smallest", json_number<Json>(f.smallest)},
          {"smallest_without_conformance", f.blind_runs > 0 ? json_number<Json>(f.smallest_blind) : Json(nullptr)},
          {"runs", f.runs},
          {"levels", levels}};
}

}  // namespace

std::string power_json(const PowerResult& r) {
  Json mutants = Json::array(), families = Json::array(), survivors = Json::array(), refused = Json::array();
  for (const MutantOutcome& o : r.outcomes) mutants.push_back(to_json(o));
  for (const FamilyOutcome& f : r.families()) families.push_back(to_json(f));
  for (const MutantOutcome* o : r.survivors()) survivors.push_back(o->mutant.name);
  for (const MutantOutcome* o : r.refused()) refused.push_back(o->mutant.name);
  const PowerCount slipped = r.slipped();
  const Json document = {{"format", 1},
                         {"plan", r.plan_name},
                         {"plan_sha256", r.plan_sha256},
                         {"first_seed", r.first_seed},
                         {"quick", r.request.quick},
                         {"good", r.good()},
                         {"slipped", count(slipped.k, slipped.n)},
                         {"reference", to_json(r.reference)},
                         {"panel", r.panel.n > 0 ? to_json(r.panel) : Json(nullptr)},
                         {"families", families},
                         {"survivors", survivors},
                         {"good_builds_not_accepted", refused},
                         {"not_built", r.not_built},
                         {"mutants", mutants}};
  return document.dump(2);
}

}  // namespace forcegate
