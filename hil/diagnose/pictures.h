#pragma once
// Plot data of an answer: overlays of every record (`after`: the residual rows that the answer leaves), evidence of every claim.

#include "hil/diagnose/residual_map.h"
#include "hil/diagnose/search.h"

namespace forcegate::diagnose {

void add_pictures(const Workspace& workspace, const Search& search, const std::vector<std::vector<double>>& after, Diagnosis& out);

}  // namespace forcegate::diagnose
