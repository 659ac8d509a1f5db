#include "hil/app/league/league_stage.h"

#include <fmt/format.h>

#include <algorithm>

#include "hil/app/league/league_tally.h"
#include "hil/model/effect.h"

namespace forcegate {
namespace {

bool has_detector(const std::string& name) {
  const EffectKind* kind = EffectRegistry::instance().find(name);
  return kind != nullptr && is_detected(*kind);
}

const AnswerFinding* first_claim(const Answer& answer) {
  for (const AnswerFinding& f : answer.findings)
    if (f.probability >= kClaim) return &f;
  return nullptr;
}

Miss lost(const LeagueMatch& m, const hidden::TruthEffect& effect) {
  Miss miss;
  miss.effect = effect.name;
  const auto at = [&](MissStage stage, std::string other, std::string detail) {
    miss.stage = stage;
    miss.other = std::move(other);
    miss.detail = std::move(detail);
    return miss;
  };
  if (!effect.excited)
    return at(MissStage::not_excited, "",
              effect.between_records ? fmt::format("d' {:.1f}: hidden by the scatter of gain and zero", effect.detectability)
                                     : fmt::format("RMS {:.2f} % of the span is hidden by the noise", effect.rms_pct));
  const Answer& answer = m.answer;
  const AnswerFinding* claim = first_claim(answer);
  const auto& ranking = answer.ranking;
  const auto own =
      std::find_if(ranking.begin(), ranking.end(), [&](const auto& r) { return r.effect == effect.name; });
  if (const auto why = answer.refused.find(effect.name); why != answer.refused.end())
    return at(MissStage::refused, claim ? claim->effect : "", why->second);
  for (std::size_t i = 0; i < answer.findings.size(); ++i)
    if (answer.findings[i].effect == effect.name)
      return at(claim != nullptr ? MissStage::outclaimed : MissStage::not_claimed, claim ? claim->effect : "",
                fmt::format("place {} with probability {}", i + 1, probability_text(answer.findings[i].probability)));
  if (own == ranking.end())
    return has_detector(effect.name) ? at(MissStage::raw_health, claim ? claim->effect : "",
                                    "the detector of the raw samples was silent")
                               : at(MissStage::not_a_candidate, claim ? claim->effect : "",
                                    "not among the families that were screened");
  if (own == ranking.begin())
    return at(MissStage::evidence, claim ? claim->effect : "",
              fmt::format("first with evidence {:.0f}", own->score));
  return at(MissStage::outranked, ranking.front().effect,
            fmt::format("evidence {:.0f} at place {} against {:.0f}", own->score, own - ranking.begin() + 1,
                        ranking.front().score));
}

}  // namespace

std::string_view to_string(MissStage stage) {
  switch (stage) {
    case MissStage::none: return "hit";
    case MissStage::no_answer: return "no answer";
    case MissStage::not_excited: return "not excited";
    case MissStage::not_a_candidate: return "not a candidate";
    case MissStage::raw_health: return "raw detector silent";
    case MissStage::evidence: return "too little evidence";
    case MissStage::outranked: return "outranked in the screening";
    case MissStage::refused: return "refused by the choice";
    case MissStage::not_claimed: return "listed, not claimed";
    case MissStage::outclaimed: return "another claimed before it";
    case MissStage::false_claim: return "false claim";
    case MissStage::called_unknown: return "noise called unknown";
    case MissStage::called_none: return "not noticed";
  }
  return "?";
}

Miss miss_of(const LeagueMatch& m) {
  if (!is_miss(m)) return {};
  Miss miss;
  if (!m.truth.effects.empty()) miss.effect = m.truth.effects.front().name;
  if (!m.error.empty()) {
    miss.stage = MissStage::no_answer;
    miss.detail = m.error.substr(0, m.error.find('\n'));
    return miss;
  }
  if (m.kind == LeagueClass::single) return lost(m, m.truth.effects.front());
  if (m.kind == LeagueClass::pair) {
    for (const hidden::TruthEffect& effect : m.truth.effects) {
      const auto end = m.answer.findings.begin() +
                       static_cast<std::ptrdiff_t>(std::min<std::size_t>(3, m.answer.findings.size()));
      if (std::none_of(m.answer.findings.begin(), end,
                       [&](const auto& f) { return f.effect == effect.name; }))
        return lost(m, effect);
    }
    return miss;
  }
  if (const AnswerFinding* claim = first_claim(m.answer)) {
    miss.stage = MissStage::false_claim;
    miss.other = claim->effect;
    miss.detail = "probability " + probability_text(claim->probability);
  } else {
    miss.stage = m.kind == LeagueClass::control ? MissStage::called_unknown : MissStage::called_none;
  }
  return miss;
}

}  // namespace forcegate
