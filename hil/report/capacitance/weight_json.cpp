#include "hil/report/capacitance/weight_json.h"

#include <nlohmann/json.hpp>

#include "hil/base/json_number.h"

namespace forcegate {
namespace {

using Json = nlohmann::ordered_json;
using namespace characterize;

template <class Values>
Json numbers(const Values& values) {
  Json out = Json::array();
  for (const double v : values) out.push_back(json_number<Json>(v));
  return out;
}

Json of(const ShareOf& s) { return {{"share", json_number<Json>(s.share())}, {"k", s.k}, {"n", s.n}}; }

Json of(const SensorResult& s) {
  Json out{{"mse_N2", numbers(s.mse_N2)},    {"per_pct", json_number<Json>(s.per_pct)},
           {"covered", s.covered},           {"tested", s.tested},
           {"u_mean_N", json_number<Json>(s.u_mean_N)}, {"unloading_mse_N2", numbers(s.unloading_mse_N2)},
           {"sweeps", Json::array()}};
  for (const SweepResult& w : s.sweeps)
    out["sweeps"].push_back({{"force_N", w.force_N},
                             {"fitted", w.fitted},
                             {"conductance_S", {json_number<Json>(w.fit.conductance_S), json_number<Json>(w.fit.u_conductance_S)}},
                             {"capacitance_F", {json_number<Json>(w.fit.capacitance_F), json_number<Json>(w.fit.u_capacitance_F)}},
                             {"divergence_Hz", {json_number<Json>(w.fit.divergence_Hz), json_number<Json>(w.fit.u_divergence_Hz)}},
                             {"chi2_per_dof", json_number<Json>(w.fit.chi2_per_dof)}});
  return out;
}

}  // namespace

std::string weight_json(const WeightStudy& study, const WeightSummary& s, bool sensors, const std::vector<std::filesystem::path>& files) {
  Json root{{"format", 1},
            {"kind", "capacitance"},
            {"plan", study.plan.name},
            {"seed", study.plan.seed},
            {"bench", study.bench.name},
            {"bench_version", study.bench.version},
            {"sets", study.sets.size()},
            {"bench_time_s", study.bench_time_s},
            {"samples", study.samples}};
  Json models = Json::array();
  for (const auto name : kForceModelNames) models.push_back(std::string(name));
  root["models"] = models;
  root["per_pct"] = {{"mean", json_number<Json>(s.per_mean_pct)},
                     {"sd_sets", json_number<Json>(s.per_sd_sets_pct)},
                     {"standard_error", json_number<Json>(s.per_se_pct)},
                     {"lowest_set", json_number<Json>(s.per_low_pct)},
                     {"highest_set", json_number<Json>(s.per_high_pct)}};
  root["mse_N2"] = {{"mean", numbers(s.mse_mean)},
                    {"q05", numbers(s.mse_q05)},
                    {"median", numbers(s.mse_median)},
                    {"q95", numbers(s.mse_q95)},
                    {"unloading_mean", numbers(s.unloading_mean)}};
  root["per_by_training_loadings_pct"] = {{"network", numbers(s.per_network_pct)},
                                          {"two_variables", numbers(s.per_ours_pct)}};
  root["coverage_95"] = {{"force", of(s.covered)},
                         {"resistance", of(s.resistance_covered)},
                         {"capacitance", of(s.capacitance_covered)},
                         {"divergence", of(s.divergence_covered)}};
  root["claims"] = Json::array();
  for (const WeightClaim& c : claims_of(study, s)) {
    Json claim{{"place", c.place}, {"subject", c.subject}, {"paper", c.paper}, {"ours", c.ours}};
    if (c.has_window) claim["window"] = c.window, claim["inside"] = c.inside;
    root["claims"].push_back(std::move(claim));
  }
  if (sensors)
    for (const SetResult& set : study.sets) {
      Json one{{"set", set.set},
               {"per_mean_pct", json_number<Json>(set.per_mean_pct())},
               {"operating_Hz", json_number<Json>(set.operating_Hz)},
               {"sensors", Json::array()}};
      for (const SensorResult& sensor : set.sensors) one["sensors"].push_back(of(sensor));
      root["packs"].push_back(std::move(one));
    }
  for (const std::filesystem::path& file : files) root["files"].push_back(file.string());
  return root.dump(1) + "\n";
}

}  // namespace forcegate
