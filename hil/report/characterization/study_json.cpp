#include "hil/report/characterization/study_json.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "hil/base/json_number.h"
#include "hil/report/characterization/paper_claims.h"

namespace forcegate {
namespace {

using Json = nlohmann::ordered_json;
using namespace characterize;

Json of(const Spread& s) {
  return {{"key", s.key},
          {"title", s.title},
          {"unit", s.unit},
          {"mean", json_number<Json>(s.mean)},
          {"sd_specimens", json_number<Json>(s.sd_specimens)},
          {"sd_sessions", json_number<Json>(s.sd_sessions)},
          {"lowest", json_number<Json>(s.lowest)},
          {"q05", json_number<Json>(s.q05)},
          {"median", json_number<Json>(s.median)},
          {"q95", json_number<Json>(s.q95)},
          {"largest", json_number<Json>(s.largest)},
          {"specimens", s.specimens},
          {"n", s.n}};
}

Json of(const LawErrors& e) {
  return {{"a_pct", json_number<Json>(e.a_pct)},
          {"b_pct", json_number<Json>(e.b_pct)},
          {"c_pct", json_number<Json>(e.c_pct)},
          {"mre_pct", json_number<Json>(e.mre_pct)}};
}

// [value, standard error]; null where too few specimens tell none.
Json with_se(double value, double se) { return {json_number<Json>(value), json_number<Json>(se)}; }

Json of(const LawStudy& study) {
  if (!study.available) return {{"available", false}, {"why_not", study.why_not}};
  const Laws& l = study.fitted;
  Json out{{"available", true},
           {"a2_V_per_N2", with_se(l.a2_V_per_N2, l.se_a2)},
           {"a1_V_per_N", with_se(l.a1_V_per_N, l.se_a1)},
           {"b1", with_se(l.b1_s_per_s, l.se_b1)},
           {"b0_per_s", with_se(l.b0_per_s, l.se_b0)},
           {"k_per_N2", with_se(l.k_per_N2, l.se_k)},
           {"records", l.records},
           {"specimens", l.specimens},
           {"scores", Json::array()}};
  for (const LawScore& s : study.scores)
    out["scores"].push_back({{"set", s.set},
                             {"specimens", s.group},
                             {"mean", of(s.mean)},
                             {"sd", of(s.sd)},
                             {"n_specimens", s.specimens},
                             {"n", s.records},
                             {"left_out", s.left_out}});
  return out;
}

Json of(const SessionSheet& s) {
  Json out{{"specimen", s.specimen}, {"session", s.session}, {"samples", s.samples}};
  if (s.failure) out["failure"] = s.failure->text;
  if (!s.notes.empty()) out["notes"] = s.notes;
  for (const Measurement& m : s.values) out["values"][m.key] = json_number<Json>(m.value);
  for (const DecayRecord& d : s.decays) {
    Json r{{"set", d.set}, {"f_Hz", d.f_Hz},         {"A_N", json_number<Json>(d.A_N)},
           {"m_N", d.m_N}, {"loss", json_number<Json>(d.loss)}, {"u_min_V", json_number<Json>(d.u_min_V)}};
    if (d.f2_Hz > 0.0) r["f2_Hz"] = d.f2_Hz;
    if (d.fitted)
      r.update({{"a_V", json_number<Json>(d.fit.a_V)},
                {"b_per_s", d.fit.b_per_s},
                {"c_V", json_number<Json>(d.fit.c_V)},
                {"rmse_V", d.fit.rmse_V},
                {"n", d.fit.n}});
    out["decays"].push_back(std::move(r));
  }
  return out;
}

}  // namespace

std::string study_json(const std::vector<SensorStudy>& studies, const StudyPlan& plan, bool sessions,
                       const std::vector<std::filesystem::path>& files) {
  Json root{{"format", 1},
            {"kind", "characterization"},
            {"plan", plan.name},
            {"seed", plan.seed},
            {"sensors", Json::array()}};
  for (const SensorStudy& s : studies) {
    Json sensor{{"sensor", s.sensor},
                {"rig_time_s", s.rig_time_s},
                {"samples", s.samples},
                {"spreads", Json::array()},
                {"laws", of(s.laws)}};
    for (const Spread& spread : s.spreads) sensor["spreads"].push_back(of(spread));
    for (const SessionSheet& sheet : s.sheets)
      for (const std::string& note : sheet.notes)
        sensor["notes"].push_back({{"specimen", sheet.specimen}, {"session", sheet.session}, {"text", note}});
    if (sessions)
      for (const SessionSheet& sheet : s.sheets) sensor["sessions"].push_back(of(sheet));
    root["sensors"].push_back(std::move(sensor));
  }
  for (const LimitResult& r : check_limits(studies, plan))
    root["limits"].push_back({{"key", r.limit.key},
                              {"sensor", r.sensor},
                              {"worst", json_number<Json>(r.worst)},
                              {"unit", r.unit},
                              {"specimen", r.specimen},
                              {"minimum", json_number<Json>(r.limit.minimum)},
                              {"maximum", json_number<Json>(r.limit.maximum)},
                              {"source", r.limit.source},
                              {"sessions", r.sessions},
                              {"outside", r.outside},
                              {"kept", r.kept}});
  for (const PaperClaim& c : compare_with_paper(studies))
    root["paper"].push_back({{"place", c.place},
                             {"sensor", c.sensor},
                             {"quantity", c.subject},
                             {"says", c.paper},
                             {"paper", json_number<Json>(c.paper_value)},
                             {"unit", c.unit},
                             {"ours", json_number<Json>(c.ours)},
                             {"sd", json_number<Json>(c.spread)},
                             {"specimens", c.specimens},
                             {"inside", c.inside()}});
  for (const std::filesystem::path& file : files) root["files"].push_back(file.string());
  return root.dump(1) + "\n";
}

}  // namespace forcegate
