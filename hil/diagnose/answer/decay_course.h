#pragma once
// What the base law takes for the decay of the maxima: every record may have a course of its own, and the reader is told where that hides
// something.

#include "hil/diagnose/diagnosis.h"
#include "hil/diagnose/workspace.h"

namespace forcegate::diagnose {

/// A campaign whose maxima decay along another law than the model's, and where nothing else is said to be missing, is "unknown". Adds notes. One
/// recording: how far its swing goes down, and what the model's constants would make of it. A campaign where nothing is claimed:
/// the records whose decay is no single exponential at any rate and depth, by what that leaves (RMS) beside what `fit` leaves.
void tell_decay(const Workspace& workspace, const MixedFit& fit, unsigned threads, Diagnosis& out);

}  // namespace forcegate::diagnose
