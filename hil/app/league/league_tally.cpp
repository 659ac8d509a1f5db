#include "hil/app/league/league_tally.h"

#include <algorithm>
#include <cmath>

#include "hil/app/league/league_stage.h"

namespace forcegate {
namespace {

std::vector<CalibrationBin> empty_bins() {
  const double edges[] = {0.0, 0.1, 0.3, 0.5, 0.7, 0.8, 0.9, 0.95, 1.0};
  std::vector<CalibrationBin> bins;
  for (std::size_t i = 0; i + 1 < std::size(edges); ++i) bins.push_back({edges[i], edges[i + 1], 0.0, {}});
  return bins;
}

std::string first_of(const LeagueMatch& m) {
  if (!m.error.empty()) return "(no answer)";
  return m.answer.verdict == "known" && !m.answer.findings.empty() ? m.answer.findings[0].effect
                                                                   : m.answer.verdict;
}

void count_size(const LeagueMatch& m, EffectTally& e) {
  if (m.truth.effects.empty()) return;
  e.rms_pct.push_back(m.truth.effects[0].rms_pct);
  e.rms_voltage_pct.push_back(m.truth.effects[0].rms_voltage_pct);
  e.excited.add(m.truth.effects[0].excited);
  if (is_miss(m)) ++e.stages[std::string(to_string(miss_of(m).stage))];
}

void count_single(const LeagueMatch& m, LeagueTally& t) {
  const auto index = static_cast<std::size_t>(m.tier) - static_cast<std::size_t>(hidden::Tier::weak);
  TierTally& tier = t.tiers[index];
  const Score& s = m.score;
  tier.named.add(s.named);
  tier.top2.add(s.top2);
  tier.top3.add(s.top3);
  tier.look_alike.add(s.look_alike);
  if (!m.truth.effects.empty()) {
    const hidden::TruthEffect& hidden = m.truth.effects[0];
    if (hidden.excited) tier.named_excited.add(s.named);
    (hidden.between_records ? tier.between : tier.within).add(s.named);
    if (hidden.between_records && hidden.cause_recorded && hidden.detectability >= kPlainDetectability) tier.between_plain.add(s.named);
  }
  if (s.rank > 0) tier.side.add(s.side_right);
  tier.false_claims.add(s.false_claims > 0);
  if (s.reduction) {
    tier.removed.push_back(s.reduction->share());
    if (s.named) tier.removed_named.push_back(s.reduction->share());
  }
  EffectTally& e = t.by_effect[m.effects[0]];
  e.named[index].add(s.named);
  if (!m.naive.empty()) {
    e.naive.add(m.naive == m.effects[0]);
    t.naive_named[index].add(m.naive == m.effects[0]);
  }
  count_size(m, e);
  if (!s.named) ++e.instead[first_of(m)];
}

void count_foreign(const LeagueMatch& m, LeagueTally& t) {
  t.foreign_honest.add(m.score.honest);
  t.foreign_claimed.add(m.score.false_claims > 0);
  const auto& right = m.truth.effects.empty() ? std::vector<std::string>{} : m.truth.effects[0].depends_on;
  t.foreign_coordinate.add(std::any_of(
      m.answer.depends_on.begin(), m.answer.depends_on.end(),
      [&](const std::string& name) { return std::find(right.begin(), right.end(), name) != right.end(); }));
  EffectTally& e = t.by_effect[m.effects[0]];
  e.named[static_cast<std::size_t>(m.tier) - static_cast<std::size_t>(hidden::Tier::weak)].add(
      m.score.honest);
  if (!m.naive.empty()) t.naive_foreign_honest.add(false);  // a correlation has no word for "unknown"
  count_size(m, e);
  if (!m.score.honest) ++e.instead[first_of(m)];
}

}  // namespace

bool is_miss(const LeagueMatch& m) {
  switch (m.kind) {
    case LeagueClass::control: return !m.score.clean;
    case LeagueClass::single: return !m.score.named;
    case LeagueClass::pair: return !m.score.pair_in_three;
    case LeagueClass::foreign: return !m.score.honest;
  }
  return true;
}

LeagueTally tally(const LeagueResult& result) {
  LeagueTally t;
  t.calibration = empty_bins();
  for (const LeagueMatch& m : result.matches) {
    t.engine_s.push_back(m.engine_s);
    t.generation_s.push_back(m.generation_s);
    t.no_answer.add(!m.error.empty());
    switch (m.kind) {
      case LeagueClass::control:
        t.control_false.add(m.error.empty() && !m.score.clean);
        t.control_claims.add(m.score.false_claims > 0);
        if (!m.naive.empty()) t.naive_control_false.add(m.naive != "none");
        if (!m.score.clean) ++t.control_answers[first_of(m)];
        break;
      case LeagueClass::single: count_single(m, t); break;
      case LeagueClass::foreign: count_foreign(m, t); break;
      case LeagueClass::pair:
        t.pairs.add(m.score.pair_in_three);
        t.pairs_one.add(m.score.top3);
        if (is_miss(m)) ++t.pair_stages[std::string(to_string(miss_of(m).stage))];
        break;
    }
    const bool others =
        !m.truth.effects.empty() && std::none_of(m.truth.effects.begin(), m.truth.effects.end(),
                                                 [](const auto& e) { return e.side == "sensor"; });
    if (others) t.sensor_blamed.add(m.score.sensor_blamed);
    for (const AnswerFinding& finding : m.answer.findings)
      for (CalibrationBin& bin : t.calibration)
        if (finding.probability >= bin.low && (finding.probability < bin.high || bin.high == 1.0)) {
          bin.stated += finding.probability;
          bin.truth.add(std::any_of(m.truth.effects.begin(), m.truth.effects.end(),
                                    [&](const auto& e) { return !e.foreign && e.name == finding.effect; }));
          break;
        }
  }
  for (const CalibrationBin& bin : t.calibration) {
    const auto n = static_cast<double>(bin.truth.n);
    if (bin.truth.n >= 20)
      t.calibration_error =
          std::max(t.calibration_error, std::abs(bin.stated - static_cast<double>(bin.truth.k)) / n);
  }
  return t;
}

}  // namespace forcegate
