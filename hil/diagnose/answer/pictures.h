#pragma once
// Plot data of an answer: overlays of every record (`shown`: the model that the answer leaves), evidence of every claim.

#include "hil/diagnose/answer/residual_map.h"
#include "hil/diagnose/choose/search.h"

namespace forcegate::diagnose {

/// Overlays as record_course() gives them: the series of few cycles stands behind that of its record.
void add_pictures(const Workspace& workspace, const Search& search, const MixedFit& shown, unsigned threads, Diagnosis& out);

}  // namespace forcegate::diagnose
