#pragma once
// S6: two witnesses against the reference. A reference that reads F + d leaves the output g D d below what it reads, and stands d above the
// rig's law: what the output misses is then the rig's misfit, turned over and of the same size.

#include <string>
#include <vector>

#include "hil/diagnose/choose/select.h"
#include "hil/diagnose/diagnosis.h"

namespace forcegate::diagnose {

/// Claims of the output that are needless beside what the rig shows of the reference.
struct AgainstReference {
  std::vector<std::string> effects;
  double share = 0.0;  ///< of the rig's misfit that the output shows: 1, both witnesses agree
};

/// Empty where no rig is a witness, or the output does not show its misfit in its size. Spare columns of the channel are written and given back.
AgainstReference against_reference(const CampaignInput& input, ResidualChannel& channel, const Selection& selection, unsigned threads);

/// Takes them back, with those of the rig that acts within records, and says in the notes why.
void withdraw_against_reference(const AgainstReference& against, Diagnosis& out);

}  // namespace forcegate::diagnose
