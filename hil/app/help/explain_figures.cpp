#include "hil/app/help/explain.h"

namespace forcegate {

const std::vector<Explanation>& figure_explanations() {
  static const std::vector<Explanation> kAll = {
      {"held-out", "figure", "An error of records that the fit did not see: those that campaign.json marks heldout, else each record left out in turn. RMS, each record weighs the same.",
       "Judge a model by it and not by the error of the records that it was fitted on (docs/diagnosis.md, Which error is which)."},
      {"adapted", "figure", "An error for which each record may have its own gain, zero and decay, and a zero that wanders slowly, within the spread that the campaign shows. It decides what is claimed.",
       "Where it is small and the error with one law for all is large, the records do not repeat: look at mounting, warm-up and rest between them."},
      {"refitted", "figure", "An error with gain, offset and decay fitted anew on the other records, the same for all of them.",
       "Compare it with \"adapted\": what lies between the two is how well records repeat, and no effect."},
      {"as written", "figure", "An error with the model file exactly as it stands, nothing fitted.",
       "Where it is far above \"refitted\", the file is of another sensor, mounting or unit: forcegate fit CAMPAIGN -o model.toml."},
      {"floor", "figure", "What the instruments may leave of the error: noise and steps of converter and reference, as these records show them. It is never above the error beside it.",
       "An error near it has nothing left to find; one far above it has structure. Less noise or a finer converter lowers it, no model does."},
      {"explainable", "figure", "Share of a record's squared error that lies above its floor, in %.", "Look first at the record with the largest share."},
      {"residual", "figure", "Measured output less what the model says. Its structure is what a diagnosis looks at.",
       "The page of forcegate diagnose --html shows where it is large: over time, force and rate."},
      {"claim", "figure", "An effect with a probability of one half or more, marked by a star; held-out records must say so too.", "forcegate add EFFECT takes it into a model."},
      {"rival", "figure", "An effect that explains the same part of the residual nearly as well as one that is claimed; it stands without a star.",
       "forcegate next CAMPAIGN names the record that parts the two."},
      {"probability", "figure", "How much the records speak for an effect against its rivals and none of them, calibrated on synthetic campaigns whose effects are known (docs/league.md).",
       "0.98 is not certain: the claim stands for sensors that are like those of the league."},
      {"likeness", "figure", "How alike two effects look on the records (cosine of what they leave): 1, nothing parts them; 0, they have nothing in common.",
       "forcegate next proposes the profile that lowers it most."},
      {"odds", "figure", "How many times one effect is as probable as its rival: 50 to 1 is a probability of 0.98 between the two. Behind an arrow: what to expect of a new record.",
       "Record the segment whose odds grow most in the least time."},
      {"ratio", "figure", "Value over limit of a check, limit over value where the limit is the least that is allowed: above 1 it lies outside.",
       "Rows are sorted by it; near 1 the uncertainty decides between pass, marginal, inconclusive and fail."},
      {"%GRR", "figure", "100 times 3 standard deviations of the rig's own repeats over the limit: the share of a limit that the rig takes. Above 30 % the limit is not resolved.",
       "Repeat more, mend what scatters, or widen the limit (docs/trust.md)."},
  };
  return kAll;
}

}  // namespace forcegate
