#include "hil/diagnose/choose/objection.h"

#include <algorithm>
#include <cmath>

#include "hil/diagnose/choose/instrument_error.h"
#include "hil/diagnose/choose/reference_jitter.h"
#include "hil/diagnose/choose/reference_latency.h"
#include "hil/diagnose/workspace.h"

namespace forcegate::diagnose {

namespace {

// an effect must remove so much more than it would of the steps of the reference alone; what one or two records show may be one place of
// the steps
constexpr double kOfSteps = 3.0, kOfStepsInFew = 6.0;
// what smoothing leaves of a reference that is late and noisy is a shift of a shift: of the span, and of what the instruments may leave
constexpr double kLeastOfTime = 1e-3, kOfNoise = 0.4;
// a regressor with noise bends what is regressed on it wherever forces crowd, at a standstill or at no load: of that noise
constexpr double kOfSmoothed = 0.5;
// codes tell the levels of a staircase, whichever they are, without the noise of the reference
constexpr double kOfJitterOfCodes = 0.1;
// a law has one strength: scatter between records, relative to it. A loop or a growth has no form that is right everywhere; a push from
// the side, a displacement current, a threshold, a shift in time are known courses, and so is a temperature within a record
constexpr double kSameStrength = 1.0, kSameOfKnownForm = 0.35;
// the same where it takes nearly all that is left: a course that bends a little less or more is a matter of its form
constexpr double kSameOfNearlyAll = 0.7;

// RMS over the records of the noise that smoothing leaves in the reference, share of the channel's scale.
double smoothed_rms(const ResidualChannel& channel) {
  double sum = 0.0;
  for (const RecordGram& r : channel.problem.records) sum += r.smoothed_variance;
  return std::sqrt(sum / std::max<double>(1.0, static_cast<double>(channel.problem.records.size())));
}

double mean_adapted(const ResidualChannel& channel, const MixedFit& fit) {
  double sum = 0.0, n = 0.0;
  for (std::size_t i = 0; i < fit.adapted.size(); ++i)
    if (fit.counts(channel.problem.records[i])) {
      sum += fit.adapted[i];
      n += 1.0;
    }
  return sum / std::max(n, 1.0);
}

// What a wrong form of the first effect leaves, many families soak up. One that stands far above all others, runs across the first ones
// and has one strength in all records that show it is an effect of its own, however much else is left.
bool stands_out(const ResidualChannel& channel, const ScreenResult& result, const FamilyScore& family, const ChosenEffect& chosen,
                const std::vector<ChosenEffect>& earlier) {
  constexpr double kGain = 60.0, kAboveOthers = 4.0, kAcross = 0.35, kOneStrength = 0.25, kErrors = 2.5, kLeastFall = 0.2;
  if (earlier.empty() || chosen.between || chosen.left_out.blocks || family.gain < kGain || chosen.fall < kLeastFall ||
      chosen.strength_scatter > kOneStrength || chosen.left_out.log_ratio < kErrors * chosen.left_out.log_ratio_error)
    return false;
  for (const FamilyScore& other : result.families)
    if (other.kind != family.kind && !look_alike(*other.kind, *family.kind) && !other.kind->traits.between_records && !other.best.wrong_sign &&
        kAboveOthers * other.gain > family.gain)
      return false;
  return std::all_of(earlier.begin(), earlier.end(), [&](const ChosenEffect& e) {
    return std::abs(signature_cosine(channel, result.base, e.fit, e.columns, family.best.fit, chosen.columns)) <= kAcross;
  });
}

// No other family within the records has a tenth of its evidence.
bool is_alone(const ScreenResult& result, const FamilyScore& family) {
  constexpr double kTimes = 10.0;
  return std::ranges::none_of(result.families, [&](const FamilyScore& other) {
    return other.kind != family.kind && !other.kind->traits.between_records && kTimes * other.gain > family.gain;
  });
}

bool may_be_of_loop(const EffectKind& earlier, const EffectKind& later) { return earlier.name == "hysteresis" && is_curve(later.name); }

// It takes nearly all that is left, in every record by what the others say of it.
bool takes_nearly_all(const ChosenEffect& chosen) {
  constexpr double kFall = 0.85, kLogRatio = 0.7, kErrors = 2.5;
  const CrossFit& others = chosen.left_out;
  return !chosen.between && !others.blocks && chosen.fall > kFall && others.improved == others.excited && others.log_ratio > kLogRatio &&
         others.log_ratio > kErrors * others.log_ratio_error;
}

// A second effect that takes nearly all that the first one left, with one strength; the remains of a wrong form do not.
bool takes_the_rest(const FamilyScore& family, const ChosenEffect& chosen, const std::vector<ChosenEffect>& earlier) {
  constexpr double kOneStrength = 0.15;
  return takes_nearly_all(chosen) && chosen.strength_scatter < kOneStrength &&
         std::none_of(earlier.begin(), earlier.end(),
                      [&](const ChosenEffect& e) { return look_alike(*e.kind, *family.kind) || may_be_of_loop(*e.kind, *family.kind); });
}

// |cos| with the signatures of the earlier effects, summed: the errors of their forms add up, and none is wholly across.
double resemblance(const ResidualChannel& channel, const MixedFit& base, const FamilyScore& family, const std::vector<int>& columns,
                   const std::vector<ChosenEffect>& earlier) {
  constexpr double kLeast = 0.3, kLeastOfLookAlike = 0.7;
  double out = 0.0;
  for (const ChosenEffect& e : earlier)
    if (may_be_of_loop(*e.kind, *family.kind)) out += 1.0;
    else if (!e.between)
      out += std::max(look_alike(*e.kind, *family.kind) ? kLeastOfLookAlike : kLeast,
                      std::abs(signature_cosine(channel, base, e.fit, e.columns, family.best.fit, columns)));
  return std::min(1.0, out);
}

}  // namespace

bool is_curve(const std::string& effect) { return effect == "static_nonlinearity" || effect == "dead_zone" || effect == "clipping"; }

Refusal objection(const ResidualChannel& channel, const ScreenResult& result, const FamilyScore& family, ChosenEffect& chosen,
                      const std::vector<ChosenEffect>& earlier, double removed_before, const SelectionRules& rules) {
  const bool first = removed_before == 0.0;
  const double excess = excess_mean_square(channel, result.base);
  const double total_rms = std::sqrt(std::max(0.0, family.best.total_fall * mean_adapted(channel, result.base)));
  const double removed_rms = std::sqrt(std::max(0.0, chosen.fall * excess));
  const std::string& name = family.kind->name;
  if (family.best.wrong_sign) return Refusal::unphysical;
  const bool another_between = std::any_of(earlier.begin(), earlier.end(), [](const ChosenEffect& e) { return e.between; });
  if (chosen.by_records() && another_between) return Refusal::second_between;
  if (chosen.by_records() && chosen.effect_rms < rules.smallest_rms) return Refusal::too_small;
  if (chosen.between && (chosen.by_records() || family.best.total_fall < rules.first_total_fall)) return chosen.not_by_records;
  const auto of_form = rules.form_gain.find(candidate_of(channel, family.best.variant).form->name);
  const double least = of_form == rules.form_gain.end() ? 0.0 : of_form->second;
  if (family.gain < std::max(least, first ? rules.first_gain : rules.later_gain)) return Refusal::too_little_evidence;
  // one record with another fault of its drive must not hide what the others show
  constexpr double kOfTypical = 0.7;  // ln of the mean squares: half of it
  const CrossFit& left = chosen.left_out;
  const bool of_typical = rules.typical_record && left.helps() && !left.blocks && left.log_ratio > std::max(kOfTypical, 2.0 * left.log_ratio_error);
  const bool explains_its_own = of_typical || (rules.where_it_acts && left.share > (first ? rules.first_fall : rules.later_fall));
  // and what the levels of the records tell too is in them, not in what these leave
  const bool told_twice = chosen.records.same_strength;
  const bool leaves_most = !explains_its_own && !told_twice && chosen.fall < (first ? rules.first_fall : rules.later_fall) &&
      family.best.total_fall < (first ? rules.first_total_fall : rules.later_total_fall) &&
      !(first && family.gain > rules.sure_gain && family.best.total_fall > rules.sure_total_fall);
  chosen.stands_out = leaves_most && stands_out(channel, result, family, chosen, earlier);
  if (leaves_most && !chosen.stands_out && !chosen.seen_in_place) return Refusal::leaves_most;
  // the bits of an output that hardly follows the force tell the output itself
  constexpr double kMostOfCodes = 0.1;  // of the span
  if (name == "adc_codes" && removed_rms > kMostOfCodes) return Refusal::unphysical;
  // bits soak up a little of many things, but then others soak it up as well
  const double least_of_codes = first && is_alone(result, family) ? 0.3 : 0.5;
  if (name == "adc_codes" && !chosen.seen_in_place && std::max(chosen.fall, family.best.total_fall) < least_of_codes) return Refusal::few_jumps;
  const double steps_rms = removed_from_steps(channel, result.base, *family.kind);
  // seen where it acts
  const double where = rules.where_it_acts && chosen.left_out.excited > 0 && !chosen.left_out.blocks
                           ? std::sqrt(static_cast<double>(chosen.left_out.parts) / chosen.left_out.excited)
                           : 1.0;
  const double seen_rms = std::max(where * std::max(removed_rms, total_rms), told_twice ? chosen.effect_rms : 0.0);
  if (seen_rms < rules.smallest_rms || seen_rms < (chosen.left_out.blocks ? kOfStepsInFew : kOfSteps) * steps_rms) return Refusal::too_small;
  if (seen_rms < kOfSmoothed * smoothed_rms(channel)) return Refusal::too_small;
  if (family.kind->traits.timing && seen_rms < std::max(kLeastOfTime, kOfNoise * allowed_rms(channel))) return Refusal::too_small;
  // a form that is not quite right has another strength in every manner of moving; yet every record then gains by that of the others
  // (a play has one width)
  const bool helps_all = !chosen.left_out.blocks && chosen.left_out.improved == chosen.left_out.excited && name != "backlash";
  const bool known_form = family.kind->traits.known_form || (chosen.between && !chosen.by_records());
  const double same = takes_nearly_all(chosen) ? kSameOfNearlyAll : kSameOfKnownForm;
  if (!told_twice && (known_form ? chosen.strength_scatter > same : chosen.strength_scatter > kSameStrength && !helps_all))
    return Refusal::differs;
  // the form of an effect is known to a share of its size only: what it leaves along what resembles it is no second effect
  if (removed_rms < rules.form_error * removed_before *
                        resemblance(channel, result.base, family, columns_of(channel, family.best.variant), earlier) &&
      !takes_the_rest(family, chosen, earlier) && !chosen.seen_in_place)
    return Refusal::within_form;
  if (chosen.left_out.blocks && family.gain < 2.0 * rules.later_gain) return Refusal::in_few_records;
  if (!chosen.describes_whole && !told_twice && (!chosen.left_out.helps() || chosen.left_out.share < 0.02))
    return chosen.left_out.blocks ? Refusal::helps_no_parts : Refusal::helps_no_records;
  const bool is_shift = family.kind->traits.shift == TimeShift::first_shape && family.kind->traits.known_form && rules.row_step_s > 0.0 &&
                        std::abs(shift_s(channel, family)) >= rules.row_step_s;
  if (!chosen.between && share_of_jitter(channel, result.base, family.best.fit, is_shift) > (name == "adc_codes" ? kOfJitterOfCodes : kOfJitter)) return Refusal::jitter;
  return Refusal::none;
}

}  // namespace forcegate::diagnose
