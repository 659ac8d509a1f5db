#include "hil/diagnose/choose/refine.h"

#include <algorithm>
#include <cmath>

#include "hil/diagnose/between/between_records.h"
#include "hil/diagnose/candidates/cause_course.h"
#include "hil/diagnose/candidates/signatures.h"
#include "hil/diagnose/candidates/spare_room.h"
#include "hil/diagnose/choose/select.h"

namespace forcegate::diagnose {

namespace {

constexpr int kMostRounds = 8, kMostTurns = 4, kMostFamilies = 4;
constexpr std::size_t kMostForms = 2;  // beside the best one
constexpr double kOfNoise = 0.1;       // of what the instruments may leave (mean square): another form has nothing to mend
constexpr double kWorthRefining = 6.0, kWorthMoving = 0.5, kStill = 0.05, kFlat = 2.0;  // nats

// Vertex of the parabola through three equally spaced values, in steps from the middle; within one step and a half.
double vertex(double low, double middle, double high) {
  const double bend = low - 2.0 * middle + high;
  if (!(bend < -1e-9)) return high > low ? 1.0 : -1.0;
  return std::clamp(0.5 * (low - high) / bend, -1.5, 1.5);
}

// The variant again, at another shape, in spare columns that are not filled yet; its index.
int place_copy(ResidualChannel& channel, const Variant& old, const std::vector<double>& shape) {
  Candidate c = channel.candidates[static_cast<std::size_t>(old.candidate)];
  c.shape = shape;
  const int old_first = c.first, copy = place_candidate(channel, std::move(c));
  Variant variant{copy, {}};
  for (const int j : old.columns) variant.columns.push_back(j - old_first + channel.candidates.back().first);
  channel.variants.push_back(std::move(variant));
  return static_cast<int>(channel.variants.size()) - 1;
}

}  // namespace

void climb(const EffectForm& form, std::vector<double> start, const std::function<double(const std::vector<double>&)>& gain_at) {
  std::vector<double> best_shape = std::move(start);
  double best = gain_at(best_shape);
  const auto score_at = [&](const std::vector<double>& shape) {
    const double gain = gain_at(shape);
    if (gain > best) best = gain, best_shape = shape;
    return gain;
  };
  const auto along = [&](std::size_t k, double step) {
    const ParameterSpec& spec = form.shape[k];
    for (int round = 0; round < kMostRounds; ++round, step *= 0.4) {
      const std::vector<double> centre = best_shape;
      if (centre[k] == 0.0) break;
      const auto moved = [&](double steps) {
        std::vector<double> shape = centre;
        shape[k] = std::clamp(centre[k] * std::exp(steps * step), spec.minimum, spec.maximum);
        return shape;
      };
      const double middle = best, low = score_at(moved(-1.0)), high = score_at(moved(1.0));
      const double at = vertex(low, middle, high);
      if (std::abs(at) != 1.0) score_at(moved(at));
      // a peak that is narrower than the step was stepped over
      if (round > 0 && best - middle < kStill && middle - std::max(low, high) < kFlat) break;
    }
  };
  const auto continuous = std::ranges::count_if(form.shape, [](const ParameterSpec& p) { return !p.choice; });
  double step = 0.35;  // of ln(shape): half the way to the next point of the grid
  for (int turn = 0; turn < kMostTurns; ++turn, step *= 0.4) {
    const double before = best;
    for (std::size_t k = 0; k < best_shape.size(); ++k)
      if (!form.shape[k].choice) along(k, step);
    // shapes of which one makes up for the other lie on a ridge
    if (continuous < 2 || best - before < kWorthMoving) break;
  }
}

namespace {

struct Refined {
  VariantScore score;
  std::vector<double> shape;
};

// In spare columns that are free again in the end; no fit where the form has no continuous shape.
Refined refine_variant(const CampaignInput& input, ResidualChannel& channel, const std::vector<int>& present, const MixedFit& base, int variant,
                       const MixedFit& warm, unsigned threads) {
  Refined out;
  out.score.gain = -1e300;
  const SpareRoom room(channel);
  const Variant old = channel.variants[static_cast<std::size_t>(variant)];
  const Candidate from = channel.candidates[static_cast<std::size_t>(old.candidate)];
  if (from.shape.empty() || !from.form->refine) return out;
  const int tried = place_copy(channel, old, from.shape);
  climb(*from.form, from.shape, [&](const std::vector<double>& shape) {
    Candidate& c = channel.candidates.back();
    c.shape = shape;
    fill_candidate(input, channel, c, threads, &present);
    VariantScore score = score_variant(channel, present, base, tried, &warm);
    const double gain = score.gain;
    if (gain > out.score.gain) out = {std::move(score), shape};
    return gain;
  });
  return out;
}

}  // namespace

bool refine_family(const CampaignInput& input, ResidualChannel& channel, const std::vector<int>& present,
                   const MixedFit& base, FamilyScore& family, unsigned threads) {
  int from = family.best.variant;
  Refined best = refine_variant(input, channel, present, base, from, family.best.fit, threads);
  const auto is_down_to_noise = [&] {
    return best.score.fit.valid && excess_mean_square(channel, best.score.fit) < kOfNoise * allowed_rms(channel) * allowed_rms(channel);
  };
  for (std::size_t k = 0; k < std::min(kMostForms, family.of_other_forms.size()) && !is_down_to_noise(); ++k) {
    Refined other = refine_variant(input, channel, present, base, family.of_other_forms[k], family.best.fit, threads);
    if (other.score.gain > std::max(best.score.gain, family.best.gain)) best = std::move(other), from = family.of_other_forms[k];
  }
  if (!best.score.fit.valid) return false;
  const int copy = place_copy(channel, Variant(channel.variants[static_cast<std::size_t>(from)]), best.shape);
  fill_candidate(input, channel, channel.candidates.back(), threads);
  best.score.variant = copy;
  family.gain += best.score.gain - family.best.gain;
  family.best = std::move(best.score);
  return true;
}

namespace {

// Whether it was worth it; all as it was, where it was not.
bool refine_in_place(const CampaignInput& input, ResidualChannel& channel, const std::vector<int>& present, const MixedFit& base, FamilyScore& family,
                     unsigned threads) {
  SpareRoom room(channel);
  const FamilyScore coarse = family;
  if (refine_family(input, channel, present, base, family, threads) && family.gain - coarse.gain > kWorthMoving) {
    room.keep();
    return true;
  }
  family = coarse;
  return false;
}

}  // namespace

void refine_films(const CampaignInput& input, ResidualChannel& channel, const std::vector<int>& present, ScreenResult& result, unsigned threads) {
  for (FamilyScore& family : result.families)
    if (family.kind->traits.between_records && family.gain >= kWorthRefining && runs_within_records(input, candidate_of(channel, family.best.variant)))
      refine_in_place(input, channel, present, result.base, family, threads);
}

void refine_leaders(const CampaignInput& input, ResidualChannel& channel, const std::vector<int>& present,
                    ScreenResult& result, unsigned threads) {
  if (result.families.empty()) return;
  const double reach = std::max(kWorthRefining, 0.4 * result.families.front().gain);
  int refined = 0;
  for (FamilyScore& family : result.families) {
    // the user's own equation starts where the user guessed: it is always given its chance
    const bool own = EffectRegistry::instance().find(family.kind->name) != family.kind;
    // a handful of records does not settle a shape: its evidence stays the mean over the grid
    if (family.kind->traits.between_records) continue;
    if (!own && (family.gain < reach || refined == kMostFamilies)) continue;
    if (refine_in_place(input, channel, present, result.base, family, threads)) ++refined;
  }
  std::stable_sort(result.families.begin(), result.families.end(), [](const FamilyScore& a, const FamilyScore& b) { return standing(a) > standing(b); });
}

}  // namespace forcegate::diagnose
