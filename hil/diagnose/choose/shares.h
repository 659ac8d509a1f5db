#pragma once
// S9: how the families that compete for one place share its probability.

#include "hil/diagnose/choose/select.h"

namespace forcegate::diagnose {

/// Signatures of another machine's rivals that are no further apart (sine) cannot be parted by how well they fit: by so much is a form not known, and
/// one that leaves nothing is no rough one. `fall`: of the leader.
double least_apart(const SelectionRules& rules, double fall);

/// Softmax of the evidence at the working temperature among the families from `place` on: what was turned down for its own reasons is no
/// rival, unless its rows were turned down and levels chose. Levels are weighed with the prior of their cause and with what the rows within the
/// records say of it. Families whose signatures differ by less than a form is known to have equal shares, but for what levels say.
/// `beside_another`: something was taken before, and what explains less than half of its remains is none. Sets share_of_family and rivals.
void set_shares(const ResidualChannel& channel, const ScreenResult& result, std::size_t place, const SelectionRules& rules, bool beside_another,
                ChosenEffect& chosen);

/// What acts between records and stands in for a look-alike that left-out records did not bear out shares its place with it, by their evidence: a
/// handful of records that does not foretell the others speaks against neither. Of `idle` those that act between records count.
void share_with_idle(const std::vector<ChosenEffect>& idle, Selection& selection);

}  // namespace forcegate::diagnose
