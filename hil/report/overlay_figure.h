#pragma once
// Measured and modelled output of one record over time, residual below.

#include "hil/diagnose/diagnosis.h"
#include "hil/report/figures/figure.h"

namespace forcegate {

/// Lines, or, where the record has more cycles than a picture can part, what lies between the smallest and the largest of each stretch of
/// one cycle or more. `few_cycles` of the same record are drawn beside it then; nullptr: none.
figures::Figure record_overlay_figure(const EvidenceSeries& series, const EvidenceSeries* few_cycles = nullptr);

}  // namespace forcegate
