#include "hil/diagnose/next/next_experiment.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "hil/base/plain_number.h"
#include "hil/base/text.h"
#include "hil/diagnose/next/expected_odds.h"
#include "hil/diagnose/next/rival_odds.h"
#include "hil/diagnose/next/segments.h"

namespace forcegate::diagnose {

namespace {

constexpr std::size_t kMostRivals = 4;
const double kSettled = std::log(1000.0), kOpen = std::log(50.0), kNearly = std::log(2.0);
const double kWorthPlaying = std::log(1.2);
constexpr double kMostOdds = 20.0;  // natural logarithm

// Findings that the diagnosis could not part, each group in the order of the findings.
std::vector<std::string> sharing_a_place(const Workspace& w, const Diagnosis& d) {
  std::vector<std::string> out;
  for (const Finding& f : d.findings) {
    const EffectKind* kind = kind_of(w, f.effect);
    if (kind == nullptr || kind->channel != EffectChannel::output || out.size() == kMostRivals) continue;
    if (std::any_of(d.findings.begin(), d.findings.end(), [&](const Finding& o) { return compete_for_one_place(d, f.effect, o.effect); }))
      out.push_back(f.effect);
  }
  return out;
}

bool is_named(const Diagnosis& d, const std::string& effect) {
  return std::any_of(d.findings.begin(), d.findings.end(), [&](const Finding& f) { return f.effect == effect; });
}

// Two effects that the answer names neither of are no question of it. What stands among the findings for other reasons is a rival only where
// the evidence leaves the two open as well.
std::optional<RivalOdds> odds_now(const Diagnosis& d, const std::string& first, const std::string& second) {
  if (!is_named(d, first) && !is_named(d, second)) return std::nullopt;
  const std::optional<RivalOdds> now = rival_odds(d, first, second);
  if (!now || !now->stated || compete_for_one_place(d, first, second)) return now;
  return std::abs(evidence_between(d, first, second)) <= kSettled ? now : std::nullopt;
}

bool is_any_open(const Diagnosis& d, const std::vector<std::string>& effects) {
  for (std::size_t a = 0; a < effects.size(); ++a)
    for (std::size_t b = a + 1; b < effects.size(); ++b)
      if (const std::optional<RivalOdds> now = odds_now(d, effects[a], effects[b]); now && std::abs(now->log_odds) <= kOpen) return true;
  return false;
}

// Names of the rivals: those that share a place among the findings, and the best of the ranking that these data leave open, at least two.
std::vector<std::string> open_effects(const Workspace& w, const Diagnosis& d) {
  std::vector<std::string> out = sharing_a_place(w, d);
  const double top = d.ranking.empty() ? 0.0 : d.ranking.front().score;
  for (const RankedEffect& r : d.ranking) {
    const EffectKind* kind = kind_of(w, r.effect);
    if (kind == nullptr || kind->channel != EffectChannel::output || !r.note.empty()) continue;
    if (std::ranges::find(out, r.effect) != out.end()) continue;
    if (out.size() < 2 || (out.size() < kMostRivals && r.score > 0.6 * top && r.score > 3.0)) out.push_back(r.effect);
  }
  return out;
}

// The better one of two rivals and what was planned for them.
struct Pair {
  const Rival *leader, *other;
  RivalOdds now;
  Imitation played;
  std::vector<Imitation> of_segment;
};

Expected expected(const Workspace& w, const Diagnosis& d, const Pair& p, const Imitation* further = nullptr) {
  Imitation played = p.played;
  if (further != nullptr) played.add(*further);
  return expected_odds(w, d, p.now, *p.leader, *p.other, played);
}

std::vector<Pair> open_pairs(const Diagnosis& d, const std::vector<Rival>& rivals) {
  std::vector<Pair> out;
  for (std::size_t a = 0; a < rivals.size(); ++a)
    for (std::size_t b = a + 1; b < rivals.size(); ++b) {
      const std::optional<RivalOdds> now = odds_now(d, rivals[a].kind->name, rivals[b].kind->name);
      if (!now) continue;
      const bool first = now->log_odds >= 0.0;
      out.push_back({&rivals[first ? a : b], &rivals[first ? b : a], {std::abs(now->log_odds), now->stated}, {}, {}});
    }
  return out;
}

// RMS of what the instruments and the model of the claims leave.
double noise_of(const Workspace& w, const Diagnosis& d, const Rival& leader) {
  double noise = 0.0;
  for (const double v : w.noise_V) noise += v * v;
  const double gain = std::max(1e-9, std::abs(w.gain_V_per_N));
  return std::max({1e-12, std::sqrt(noise / static_cast<double>(w.noise_V.size())) / gain, std::min(leader.left_N, d.error_after / gain)});
}

ExperimentSegment as_planned(const Workspace& w, const Segment& s) {
  ExperimentSegment out;
  out.name = s.name;
  out.kind = s.kind;
  out.minutes = s.minutes;
  StimulusSpec stimulus = stimulus_of(w, s);
  out.stimulus = std::move(stimulus.name);
  out.numbers = std::move(stimulus.numbers);
  out.lists = std::move(stimulus.lists);
  const RecordInput played = simulate(w, s);
  out.t_s = played.fast_t_s;
  out.force_N = played.fast_F_N;
  out.f_min_Hz = s.f_min_Hz;
  out.heats = s.temperature_C != 0.0;
  out.rise_degC = s.temperature_C;
  return out;
}

// What to play for one pair, best per minute; its index, or that behind the last where nothing is worth it.
std::size_t best_for(const Workspace& w, const Diagnosis& d, const Pair& pair, const std::vector<char>& used) {
  const double before = expected(w, d, pair).log_odds;
  std::size_t best = used.size();
  double rate = 0.0;
  for (std::size_t s = 0; s < used.size(); ++s) {
    if (used[s] != 0) continue;
    // beyond odds of a thousand more evidence is worth nothing
    const double gain = std::min(expected(w, d, pair, &pair.of_segment[s]).log_odds, kSettled) - before;
    if (gain < kWorthPlaying) continue;
    if (const double per_minute = gain / (segments()[s].minutes + 0.5); per_minute > rate) rate = per_minute, best = s;
  }
  return best;
}

struct Plan {
  NextExperiment experiment;
  std::vector<std::string> open;  ///< the two that no segment parts, where nothing is planned
};

Plan plan(const Workspace& w, const Diagnosis& d) {
  Plan out;
  const std::vector<std::string> names = open_effects(w, d);
  if (w.output.problem.records.empty() || !is_any_open(d, names)) return out;
  const std::vector<Rival> rivals = rivals_of(w, names);
  std::vector<Pair> pairs = open_pairs(d, rivals);
  for (const Segment& s : segments()) {
    const RecordInput r = simulate(w, s);
    for (Pair& p : pairs) p.of_segment.push_back(imitate(w, r, *p.leader, *p.other, noise_of(w, d, *p.leader)));
  }
  // what was played and left them open would promise the same once more
  std::vector<char> used;
  for (const Segment& s : segments()) used.push_back(std::ranges::any_of(w.input.records, [&](const RecordInput& r) { return is_record_of(r.name, s); }) ? 1 : 0);
  std::vector<ExperimentSegment>& planned = out.experiment.segments;
  constexpr std::size_t kMostSegments = 4;
  while (planned.size() < kMostSegments) {
    // the pair that is least separated by what is known and planned; of those nearly so, the one that the findings name first
    Pair* worst = nullptr;
    double least = 1e300;
    for (Pair& p : pairs)
      if (const double known = expected(w, d, p).log_odds; known < least - kNearly) least = known, worst = &p;
    if (worst == nullptr || least > kOpen) break;
    const std::size_t best = best_for(w, d, *worst, used);
    if (best == used.size()) {
      if (planned.empty() && worst->now.stated) out.open = {worst->leader->kind->name, worst->other->kind->name};
      break;
    }
    used[best] = 1;
    const Expected before = expected(w, d, *worst);
    for (Pair& p : pairs) p.played.add(p.of_segment[best]);
    const Expected after = expected(w, d, *worst);
    ExperimentSegment chosen = as_planned(w, segments()[best]);
    chosen.separates = worst->leader->kind->name + " / " + worst->other->kind->name;
    chosen.odds_stated = worst->now.stated;
    chosen.odds_before = std::exp(std::min(kMostOdds, before.log_odds));
    chosen.odds_after = std::exp(std::min(kMostOdds, after.log_odds));
    chosen.cosine_before = before.likeness;
    chosen.cosine_after = after.likeness;
    out.experiment.minutes += chosen.minutes;
    planned.push_back(std::move(chosen));
  }
  if (!planned.empty()) {
    const ExperimentSegment& s = planned.front();
    out.experiment.sentence = fmt::format("{} ({:.2g} min) separates {}: odds {} to 1 now{}, {} to 1 expected", s.name, s.minutes, s.separates,
                                          odds_text(s.odds_before), s.odds_stated ? "" : " by the evidence", odds_text(s.odds_after));
  }
  return out;
}

// An equation of the user's own cannot say what shows it, and of what parts it from an effect of the library nobody knows.
std::string what_would(const std::vector<std::string>& rivals) {
  const auto is_known = [](const std::string& name) { return EffectRegistry::instance().find(name) != nullptr; };
  const auto known = std::ranges::find_if(rivals, is_known);
  if (known == rivals.end()) return {};
  const std::string told = std::ranges::all_of(rivals, is_known) ? "; what would: " : "; what shows " + *known + " as a rule: ";
  return told + EffectRegistry::instance().find(*known)->separates;
}

}  // namespace

NextExperiment propose_experiment(const Workspace& w, const Diagnosis& d) {
  Plan planned = plan(w, d);
  NextExperiment& out = planned.experiment;
  const std::vector<std::string>& rivals = d.not_separable.empty() ? planned.open : d.not_separable.front();
  if (!out.segments.empty() || rivals.empty()) return std::move(out);
  out.sentence = "none of the short segments that a rig can play parts " + join(rivals, " or ") + what_would(rivals);
  return std::move(out);
}

}  // namespace forcegate::diagnose
