#include "hil/diagnose/next/rival_odds.h"

#include <algorithm>
#include <cmath>

namespace forcegate::diagnose {

namespace {

constexpr double kMost = 20.0;

const Finding* finding_of(const Diagnosis& d, const std::string& effect) {
  const auto at = std::find_if(d.findings.begin(), d.findings.end(), [&](const Finding& f) { return f.effect == effect; });
  return at == d.findings.end() ? nullptr : &*at;
}

double evidence_of(const Diagnosis& d, const std::string& effect) {
  const auto at = std::find_if(d.ranking.begin(), d.ranking.end(), [&](const RankedEffect& r) { return r.effect == effect; });
  return at == d.ranking.end() ? 0.0 : at->score;
}

}  // namespace

double evidence_between(const Diagnosis& d, const std::string& first, const std::string& second) {
  return evidence_of(d, first) - evidence_of(d, second);
}

std::optional<RivalOdds> rival_odds(const Diagnosis& d, const std::string& first, const std::string& second) {
  const Finding *a = finding_of(d, first), *b = finding_of(d, second);
  if (a == nullptr || b == nullptr)
    return RivalOdds{std::clamp(evidence_between(d, first, second), -kMost, kMost), false};
  if (a->claimed() && b->claimed()) return std::nullopt;
  constexpr double kLeast = 1e-9;
  return RivalOdds{std::clamp(std::log(std::max(kLeast, a->probability) / std::max(kLeast, b->probability)), -kMost, kMost), true};
}

std::optional<RivalOdds> rival_odds_as(bool stated, const Diagnosis& d, const std::string& first, const std::string& second) {
  std::optional<RivalOdds> out = rival_odds(d, first, second);
  if (!out || out->stated == stated) return out;
  const double evidence = evidence_between(d, first, second);
  out->log_odds = std::clamp(stated ? evidence / nats_of_a_factor(std::max(evidence_of(d, first), evidence_of(d, second))) : evidence, -kMost, kMost);
  return out;
}

bool compete_for_one_place(const Diagnosis& d, const std::string& first, const std::string& second) {
  const Finding *a = finding_of(d, first), *b = finding_of(d, second);
  if (a == nullptr || b == nullptr) return false;
  return a->rival_of == second || b->rival_of == first || (!a->rival_of.empty() && a->rival_of == b->rival_of);
}

}  // namespace forcegate::diagnose
