#pragma once
// S4: log evidence of every variant beside what is already in the model, and of every family.

#include <map>
#include <string>
#include <vector>

#include "hil/diagnose/workspace.h"

namespace forcegate::diagnose {

struct VariantScore {
  int variant = 0;
  double gain = 0.0;        ///< log evidence over the present model
  double effect_rms = 0.0;  ///< of what the columns add, share of the span, mean over records
  double fall = 0.0;        ///< share of the excess mean square (above noise) that goes away
  double total_fall = 0.0;  ///< share of the whole adapted mean square that goes away
  bool wrong_sign = false;
  MixedFit fit;
};

/// What one gain and one zero for each record say about a family that acts between records.
struct RecordEvidence {
  bool valid = false;
  int variant = 0;
  double gain = -1e300;    ///< ln Bayes factor
  double explained = 0.0;  ///< share of the spread between records (a variance) that goes away
  double left_out = 1.0;   ///< mean square error of records predicted from the others, over the same without the effect
  double prior = 0.0;      ///< nats against its rivals: a cause that nobody recorded may be any that changes as slowly
  bool same_strength = false;  ///< of a form that outlasts a record: the rows within the records tell the same strength
  double within = 0.0;     ///< log evidence of the rows within the records, where they follow a cause that was recorded
};

struct FamilyScore {
  const EffectKind* kind = nullptr;
  double gain = -1e300;  ///< best variant less what the number of variants costs
  VariantScore best;
  std::vector<int> of_other_forms;  ///< best variant of each other form that comes near the best, best first
  RecordEvidence records;
};

struct ScreenResult {
  MixedFit base;                      ///< fit with the columns that are already in
  std::vector<FamilyScore> families;  ///< best first
};

/// Which forms compete: those that are `EffectForm::last` too, or not.
enum class Forms { ordinary, all };

/// Columns already in the model stay. A variant whose family is in `skip` is left out.
ScreenResult screen(const ResidualChannel& channel, const std::vector<int>& present,
                    const std::vector<std::string>& skip, const MixedFit* warm, unsigned threads,
                    int iterations = 9, RecordUse use = RecordUse::all_records, Forms forms = Forms::ordinary);

/// The family that is not in `others` alone, on the records of the fit. Its forms that are `EffectForm::last` only where records that are left
/// out are foretold plainly better by them.
ScreenResult screen_alone(const ResidualChannel& channel, const std::vector<int>& present, const std::vector<std::string>& others, const MixedFit* warm,
                          unsigned threads);

/// EM from `warm` (or from the components' starts) until the evidence stands still: a base that still climbs would lend its climb to every
/// candidate.
MixedFit fit_to_the_end(const ResidualChannel& channel, const std::vector<int>& present, const MixedFit* warm, int iterations, RecordUse use);

/// The families that have candidates in a channel, in the order of the registry, the user's own last.
std::vector<const EffectKind*> kinds_of(const ResidualChannel& channel);

/// Names of those that are not among `names`.
std::vector<std::string> families_but(const ResidualChannel& channel, const std::vector<std::string>& names);

/// One variant beside the present columns, on the records that the base was fitted to; gain -1e300 when it cannot be fitted or its strength is out of bounds.
VariantScore score_variant(const ResidualChannel& channel, const std::vector<int>& present,
                           const MixedFit& base, int variant, const MixedFit* warm, int iterations = 9);

/// Mean over the records of the fit of the adapted mean square above the noise, never below 0.
double excess_mean_square(const ResidualChannel& channel, const MixedFit& fit);

/// Share of the adapted mean square of the records of a fit that goes away between two fits.
double total_fall(const ResidualChannel& channel, const MixedFit& before, const MixedFit& after);

/// RMS over rows of what the columns add, share of the span.
double effect_rms(const ResidualChannel& channel, const MixedFit& fit, const std::vector<int>& columns);
/// The same of what one gain and one zero for all records do not take: what differs between records.
double effect_rms_between(const ResidualChannel& channel, const MixedFit& fit, const std::vector<int>& columns);

}  // namespace forcegate::diagnose
