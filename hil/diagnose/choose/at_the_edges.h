#pragma once
// S5: a delay, a lag and a pole of the film that compete for a place are judged at the full rate where the force turns most sharply
// (hil/diagnose/raw/edges.h).
//
//   U = o_w + b_i D F + S c     within a window w of record i, S the form's columns at a shape, c one for all records
//
// at the shape that leaves least, c within what the form may have. What the noise of the reference leaves differs between them, since a lag smooths
// it and a delay does not: it is taken off, and a family loses where it does with and without. Where any other c describes the edges better than the
// best of them, something else is at work there, and nothing is said.

#include <string>
#include <vector>

#include "hil/diagnose/choose/select.h"
#include "hil/diagnose/workspace.h"

namespace forcegate::diagnose {

/// Names of the families that lose there to one of those that compete for the place of a chosen effect; empty where none do, the edges do not part
/// them, the model has a lag of its own, or the recording is another machine's, whose forms are rough.
std::vector<std::string> beaten_at_the_edges(const Workspace& workspace, const Selection& selection, const SelectionRules& rules, unsigned threads);

}  // namespace forcegate::diagnose
