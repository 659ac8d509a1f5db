#pragma once
// S5: forward choice of effects with a backward check, on log evidence and on records that were left out.

#include <string>
#include <vector>

#include "hil/diagnose/screen.h"

namespace forcegate::diagnose {

struct ChosenEffect {
  const EffectKind* kind = nullptr;
  int variant = 0;
  std::vector<int> columns;      ///< the variant's own
  double gain = 0.0;             ///< log evidence when it entered
  double fall = 0.0;             ///< share of the excess mean square that it removed when it entered
  double effect_rms = 0.0;       ///< share of the span
  double share_of_family = 0.0;  ///< softmax over the families that competed, at the working temperature
  int records_improved = 0, records_excited = 0;
  std::vector<std::pair<std::string, double>> rivals;  ///< family, share
  MixedFit fit;                  ///< of the model with everything up to this effect
};

struct Selection {
  ScreenResult first;            ///< screen over the base model alone
  std::vector<ChosenEffect> chosen;
  MixedFit base, final;
  double excess_before = 0.0, excess_after = 0.0;  ///< mean squares above the noise
  std::vector<std::string> nuisance;  ///< what was carried along without being a finding
  std::vector<std::string> rejected;  ///< why the next one was not taken
};

struct SelectionRules {
  double first_gain = 14.0, later_gain = 20.0;
  double between_gain = 8.0;     ///< n counts records; chance reaches 2 nats once in a thousand (mixed_model_test)
  double between_left_out = 3.0; ///< nats by which records that were left out must be predicted better
  double between_fall = 0.5;     ///< share of the spread between records (a variance) that it must explain
  double between_chance = 0.10;  ///< largest share of sign-flipped records that may do as well

  double first_fall = 0.10, later_fall = 0.50;
  double first_total_fall = 0.06, later_total_fall = 0.35;  ///< where the declared noise allows the whole residual
  double sure_gain = 40.0, sure_total_fall = 0.02;  ///< a small share is enough where the evidence is overwhelming
  double smallest_rms = 2.5e-4;  ///< of the span: less is below what the declared instruments can tell
  bool clock_slack = true;       ///< a few milliseconds between two instruments are nobody's fault
  int most = 3;
};

/// Score from which an effect is considered at all.
double threshold_of(const std::string& effect, const SelectionRules& rules);

Selection select_effects(const CampaignInput& input, ResidualChannel& channel, const std::vector<int>& always,
                         const std::vector<std::string>& skip, const SelectionRules& rules, unsigned threads);

/// |cos| between what two sets of columns add, after the base law and the repeatability are projected off.
double signature_cosine(const ResidualChannel& channel, const MixedFit& base, const MixedFit& a,
                        const std::vector<int>& columns_a, const MixedFit& b, const std::vector<int>& columns_b);

/// All columns of the screening grid of a family: what a form that is not quite right leaves behind must not be named.
std::vector<int> family_columns(const ResidualChannel& channel, const EffectKind& kind);

/// Columns of the family's most flexible form.
std::vector<int> bank_columns(const ResidualChannel& channel, const EffectKind& kind);

}  // namespace forcegate::diagnose
