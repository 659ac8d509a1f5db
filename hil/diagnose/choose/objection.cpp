#include "hil/diagnose/choose/objection.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

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
constexpr double kSameStrength = 0.5, kSameOfKnownForm = 0.35;
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

// An effect that the screen puts first, and what it stands in front of.
struct Applicant {
  const ResidualChannel& channel;
  const ScreenResult& result;
  const FamilyScore& family;
  const ChosenEffect& chosen;
  const std::vector<ChosenEffect>& earlier;
  double removed_before;
  const SelectionRules& rules;

  bool is(const char* effect) const { return family.kind->name == effect; }
  bool first() const { return removed_before == 0.0; }
  const CrossFit& left_out() const { return chosen.left_out; }
  double total_fall() const { return family.best.total_fall; }
  double removed_rms() const { return std::sqrt(std::max(0.0, chosen.fall * excess_mean_square(channel, result.base))); }
  // and what the levels of the records tell too is in them, not in what these leave
  bool told_twice() const { return chosen.records.same_strength; }
  // RMS where it acts
  double seen_rms() const {
    const double total_rms = std::sqrt(std::max(0.0, total_fall() * mean_adapted(channel, result.base)));
    const bool somewhere = rules.where_it_acts && left_out().excited > 0 && !left_out().blocks;
    const double where = somewhere ? std::sqrt(static_cast<double>(left_out().parts) / left_out().excited) : 1.0;
    return std::max(where * std::max(removed_rms(), total_rms), told_twice() ? chosen.effect_rms : 0.0);
  }
};

bool has_too_little_evidence(const Applicant& a) {
  const auto of_form = a.rules.form_gain.find(candidate_of(a.channel, a.family.best.variant).form->name);
  const double least = of_form == a.rules.form_gain.end() ? 0.0 : of_form->second;
  return a.family.gain < std::max(least, a.first() ? a.rules.first_gain : a.rules.later_gain);
}

bool leaves_most(const Applicant& a) {
  // one record with another fault of its drive must not hide what the others show
  constexpr double kOfTypical = 0.7;  // ln of the mean squares: half of it
  const CrossFit& left = a.left_out();
  const bool of_typical = a.rules.typical_record && left.helps() && !left.blocks && left.log_ratio > std::max(kOfTypical, 2.0 * left.log_ratio_error);
  const bool explains_its_own = of_typical || (a.rules.where_it_acts && left.share > (a.first() ? a.rules.first_fall : a.rules.later_fall));
  return !explains_its_own && !a.told_twice() && a.chosen.fall < (a.first() ? a.rules.first_fall : a.rules.later_fall) &&
         a.total_fall() < (a.first() ? a.rules.first_total_fall : a.rules.later_total_fall) &&
         !(a.first() && a.family.gain > a.rules.sure_gain && a.total_fall() > a.rules.sure_total_fall);
}

// What a wrong form of the first effect leaves, many families soak up. One that stands far above all others, runs across the first ones
// and has one strength in all records that show it is an effect of its own, however much else is left.
bool stands_out(const Applicant& a) {
  constexpr double kGain = 60.0, kAboveOthers = 4.0, kAcross = 0.35, kOneStrength = 0.25, kErrors = 2.5, kLeastFall = 0.2;
  const CrossFit& left = a.left_out();
  if (a.earlier.empty() || a.chosen.between || left.blocks || a.family.gain < kGain || a.chosen.fall < kLeastFall ||
      a.chosen.strength_scatter > kOneStrength || left.log_ratio < kErrors * left.log_ratio_error)
    return false;
  for (const FamilyScore& other : a.result.families)
    if (other.kind != a.family.kind && !look_alike(*other.kind, *a.family.kind) && !other.kind->traits.between_records && !other.best.wrong_sign &&
        kAboveOthers * other.gain > a.family.gain)
      return false;
  return std::ranges::all_of(a.earlier, [&](const ChosenEffect& e) {
    return std::abs(signature_cosine(a.channel, a.result.base, e.fit, e.columns, a.family.best.fit, a.chosen.columns)) <= kAcross;
  });
}

bool leaves_most_for_others(const Applicant& a) { return leaves_most(a) && !stands_out(a) && !a.chosen.seen_in_place; }

// The bits of an output that hardly follows the force tell the output itself.
bool is_output_itself(const Applicant& a) {
  constexpr double kMostOfCodes = 0.1;  // of the span
  return a.is("adc_codes") && a.removed_rms() > kMostOfCodes;
}

// Bits soak up a little of many things, but then others soak it up as well.
bool has_few_jumps(const Applicant& a) {
  const double least = a.first() && is_alone(a.result, a.family) ? 0.3 : 0.5;
  return a.is("adc_codes") && !a.chosen.seen_in_place && std::max(a.chosen.fall, a.total_fall()) < least;
}

bool is_too_small(const Applicant& a) {
  const double seen = a.seen_rms();
  const double of_steps = (a.left_out().blocks ? kOfStepsInFew : kOfSteps) * removed_from_steps(a.channel, a.result.base, *a.family.kind);
  if (seen < a.rules.smallest_rms || seen < of_steps || seen < kOfSmoothed * smoothed_rms(a.channel)) return true;
  return a.family.kind->traits.timing && seen < std::max(kLeastOfTime, kOfNoise * allowed_rms(a.channel));
}

// A form that is not quite right has another strength in every manner of moving (the bits of a converter are what they are); yet every record then gains by that of the others (a play has
// one width).
bool differs(const Applicant& a) {
  constexpr double kSameBits = 0.3;
  if (a.is("adc_codes") && !a.chosen.seen_in_place && a.chosen.strength_scatter > kSameBits) return true;
  const bool helps_all = !a.left_out().blocks && a.left_out().improved == a.left_out().excited && !a.is("backlash");
  const bool known_form = a.family.kind->traits.known_form || (a.chosen.between && !a.chosen.by_records());
  const double same = takes_nearly_all(a.chosen) ? kSameOfNearlyAll : kSameOfKnownForm;
  return !a.told_twice() && (known_form ? a.chosen.strength_scatter > same : a.chosen.strength_scatter > kSameStrength && !helps_all);
}

// The form of an effect is known to a share of its size only: what it leaves along what resembles it is no second effect.
bool is_within_form(const Applicant& a) {
  const double alike = resemblance(a.channel, a.result.base, a.family, columns_of(a.channel, a.family.best.variant), a.earlier);
  return a.removed_rms() < a.rules.form_error * a.removed_before * alike && !takes_the_rest(a.family, a.chosen, a.earlier) && !a.chosen.seen_in_place;
}

bool is_in_few_records(const Applicant& a) { return a.left_out().blocks && a.family.gain < 2.0 * a.rules.later_gain; }

bool helps_none(const Applicant& a) {
  constexpr double kLeastShare = 0.02;
  return !a.chosen.describes_whole && !a.told_twice() && (!a.left_out().helps() || a.left_out().share < kLeastShare);
}

bool helps_no_parts(const Applicant& a) { return a.left_out().blocks && helps_none(a); }
bool helps_no_records(const Applicant& a) { return !a.left_out().blocks && helps_none(a); }

bool is_of_jitter(const Applicant& a) {
  const EffectTraits& traits = a.family.kind->traits;
  const bool is_shift = traits.shift == TimeShift::first_shape && traits.known_form && a.rules.row_step_s > 0.0 &&
                        std::abs(shift_s(a.channel, a.family)) >= a.rules.row_step_s;
  return !a.chosen.between && share_of_jitter(a.channel, a.result.base, a.family.best.fit, is_shift) > (a.is("adc_codes") ? kOfJitterOfCodes : kOfJitter);
}

struct Question {
  bool (*holds)(const Applicant&);
  Refusal refusal;
};

// In this order: what is no fit is not asked how small it is, and the dear questions come last.
constexpr std::array kQuestions = {Question{has_too_little_evidence, Refusal::too_little_evidence},
                                   Question{leaves_most_for_others, Refusal::leaves_most},
                                   Question{is_output_itself, Refusal::unphysical},
                                   Question{has_few_jumps, Refusal::few_jumps},
                                   Question{is_too_small, Refusal::too_small},
                                   Question{differs, Refusal::differs},
                                   Question{is_within_form, Refusal::within_form},
                                   Question{is_in_few_records, Refusal::in_few_records},
                                   Question{helps_no_parts, Refusal::helps_no_parts},
                                   Question{helps_no_records, Refusal::helps_no_records},
                                   Question{is_of_jitter, Refusal::jitter}};

// What the levels of the records say of an effect between them; empty: its rows are asked.
std::optional<Refusal> told_by_records(const Applicant& a) {
  if (!a.chosen.between) return std::nullopt;
  if (a.chosen.by_records() && std::ranges::any_of(a.earlier, &ChosenEffect::between)) return Refusal::second_between;
  if (a.chosen.by_records() && a.chosen.effect_rms < a.rules.smallest_rms) return Refusal::too_small;
  if (a.chosen.by_records() || a.total_fall() < a.rules.first_total_fall) return a.chosen.not_by_records;
  return std::nullopt;
}

}  // namespace

bool is_curve(const std::string& effect) { return effect == "static_nonlinearity" || effect == "dead_zone" || effect == "clipping"; }

Objection objection(const ResidualChannel& channel, const ScreenResult& result, const FamilyScore& family, const ChosenEffect& chosen,
                    const std::vector<ChosenEffect>& earlier, double removed_before, const SelectionRules& rules) {
  const Applicant applicant{channel, result, family, chosen, earlier, removed_before, rules};
  if (family.best.wrong_sign) return {Refusal::unphysical};
  if (const std::optional<Refusal> told = told_by_records(applicant)) return {*told};
  for (const Question& question : kQuestions)
    if (question.holds(applicant)) return {question.refusal};
  return {Refusal::none, leaves_most(applicant) && stands_out(applicant)};
}

}  // namespace forcegate::diagnose
