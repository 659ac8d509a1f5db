#pragma once
// A claim that leaves most of the error is no name for it.

#include <vector>

#include "hil/diagnose/answer/remainder.h"
#include "hil/diagnose/choose/select.h"
#include "hil/diagnose/diagnosis.h"
#include "hil/diagnose/workspace.h"

namespace forcegate::diagnose {

/// Claims about the output are suspicions where all forms of their families leave more than an eighth of the mean square that the noise does not
/// explain (a fifth beside claims about raw samples, whose remains count here too), far above it (all records, or the typical one) or with
/// structure that `remains`, and they themselves leave more than half of the mean square, of all records and of the typical one that stood far
/// above the noise, or could take any course of their kind (a curve, a loop, a lag; not of another machine, of which the forms of the library
/// are rough): something else is at work. With one of them all others within records go. Nearer to the noise, where any form takes up what is left,
/// the claims themselves count: they go where they leave 1.3 to 2.5 times the noise and three tenths of the mean square beyond it (the typical record a fifth), unless bad samples, the
/// reference or an effect between records may leave it, or the machine is another one. So they do where they leave more than 0.93 of the RMS, of all
/// records and of the typical one, far above the noise. True when one was withdrawn.
bool withdraw_what_explains_little(const ResidualChannel& channel, const Selection& selection, const Remainder& rest, JudgedBy by,
                                   std::vector<Finding>& findings);

/// Gains that scatter about another load than none move the zeros too: the claim of a zero that drifts from record to record is a suspicion where the gains
/// go on scattering by more than kFarGain and left-out records keep more than three quarters of their RMS error.
void withdraw_drifts_beside_wide_gains(const ResidualChannel& channel, const Selection& selection, std::vector<Finding>& findings);

}  // namespace forcegate::diagnose
