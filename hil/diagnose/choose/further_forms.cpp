#include "hil/diagnose/choose/further_forms.h"

#include <algorithm>

#include "hil/diagnose/base/left_out.h"
#include "hil/diagnose/choose/screen.h"

namespace forcegate::diagnose {

std::vector<int> further_forms(const ResidualChannel& channel, const EffectKind& kind,
                               std::vector<int>& present, MixedFit& fit) {
  constexpr int kMost = 2;
  constexpr double kWorth = 10.0;  // nats
  std::vector<int> out;
  // a course that is known is the same course at another shape: two delays are none
  const auto is_present = [&](const EffectForm* form) {
    return std::ranges::any_of(channel.candidates, [&](const Candidate& c) {
      return c.form == form && std::ranges::find(present, c.first) != present.end();
    });
  };
  // an equation of the user's own is one equation
  if (EffectRegistry::instance().find(kind.name) != &kind) return out;
  for (int round = 0; round < kMost && fit.valid; ++round) {
    VariantScore best;
    best.gain = kWorth;
    for (std::size_t v = 0; v < channel.variants.size(); ++v) {
      const Candidate& c = candidate_of(channel, static_cast<int>(v));
      if (c.kind != &kind || c.form->one_law || (kind.traits.known_form && is_present(c.form))) continue;
      VariantScore score = score_variant(channel, present, fit, static_cast<int>(v), nullptr);
      if (!score.wrong_sign && score.gain > best.gain) best = std::move(score);
    }
    if (!best.fit.valid || !cross_fit(channel, fit, best.fit).helps()) break;
    out.push_back(best.variant);
    const std::vector<int>& columns = columns_of(channel, best.variant);
    present.insert(present.end(), columns.begin(), columns.end());
    fit = std::move(best.fit);
  }
  return out;
}

}  // namespace forcegate::diagnose
