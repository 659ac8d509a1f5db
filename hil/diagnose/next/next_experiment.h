#pragma once
// S8: which segments of rig time separate the rivals best. Rivals are the effects that compete for the explanation, a user's own among them; each
// segment is simulated for all of them and the rival is refitted inside (T-optimality, Atkinson and Fedorov 1975):
// what counts is the part of an effect's signature that the rival and the base law cannot imitate, per minute.

#include "hil/diagnose/diagnosis.h"
#include "hil/diagnose/workspace.h"

namespace forcegate::diagnose {

/// One to four segments, greedy by the gain of the worst pair per minute; empty when nothing competes.
NextExperiment propose_experiment(const Workspace& workspace, const Diagnosis& diagnosis);

}  // namespace forcegate::diagnose
