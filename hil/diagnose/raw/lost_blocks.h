#pragma once
// Blocks of samples that the logger of the output, or of the reference, lost without a gap in its clock: the two are apart by one block more
// from then on.
//
// In each of some windows of a record U = c0 + c1 F + c2 F' tells by how much the output is late there, s = atan(-w c2 / c1) / w,
// w the RMS of F' over that of F about its mean (the gain may decay from window to window). Over the windows s is a staircase: least
// squares with a price for each step, by dynamic programming (Jackson et al. 2005, optimal partitioning). Two clocks may run apart
// beside it: one slope within all levels. What a logger lost it has lost for good, so that all steps of a campaign go one way; lags
// and loops change s where the load changes its speed, and along a curve where it does so slowly, and none of these is a step here.

#include "hil/model/record_input.h"

namespace forcegate::diagnose {

/// Sets block_s of the campaign and lost_blocks of its records; leaves both empty where no record shows a plain staircase, or two go
/// different ways.
void find_lost_blocks(CampaignInput& campaign, unsigned threads);

}  // namespace forcegate::diagnose
