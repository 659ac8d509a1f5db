#pragma once
// S5: effects of timing that fit the rows of a search about as well are judged once more on the rows where their answers differ.
//
// A search sees rows that are spread evenly over a record, and of an edge that takes a tenth of a second hardly any. A lag, a delay and a pole of
// the film of a few milliseconds are alike everywhere else. The rows are those on which the fitted answers of the rivals are furthest
// apart (the points of a T-optimal design: Atkinson and Fedorov 1975), beside as many spread evenly, which hold the law.

#include <string>
#include <vector>

#include "hil/diagnose/choose/select.h"

namespace forcegate::diagnose {

/// Names of the families that lose there plainly where all but one of those that compete for the place of a chosen effect of timing do. Empty
/// where none compete, the rows do not part them either, or the recording is another machine's, whose forms are rough.
std::vector<std::string> beaten_where_they_differ(Workspace& workspace, const Selection& selection, const SelectionRules& rules, unsigned threads);

}  // namespace forcegate::diagnose
