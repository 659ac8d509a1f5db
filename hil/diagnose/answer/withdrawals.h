#pragma once
// S7: claims that are taken back, since something without a name explains more than they do.

#include <vector>

#include "hil/diagnose/answer/remainder.h"
#include "hil/diagnose/choose/outdone.h"
#include "hil/diagnose/choose/select.h"
#include "hil/diagnose/diagnosis.h"
#include "hil/diagnose/workspace.h"

namespace forcegate::diagnose {

struct Withdrawals {
  std::vector<Outdone> outdone;
  bool of_reference = false;     ///< an error of the reference, told by two witnesses, explains them (choose/reference_witness.h)
  bool explain_little = false;   ///< they leave most of the error (explains_little.h)
  bool tips = false;             ///< spikes may be the tips of what is left

  bool some_outdone() const;
  bool any() const { return explain_little || some_outdone() || of_reference || tips; }
};

/// Takes claims among the findings of `out` back, in this order: what an unnamed dependence outdoes, what an error of the reference explains,
/// what explains little, what a noisy reference bends, spikes that are the tips of structure. Says why in the findings and the notes.
Withdrawals withdraw(Workspace& workspace, const Selection& selection, const Remainder& rest, unsigned threads, Diagnosis& out);

/// Beside structure without a name a second claim may be part of it: limits all claims of the output but the first.
void doubt_later_claims(std::vector<Finding>& findings);

}  // namespace forcegate::diagnose
