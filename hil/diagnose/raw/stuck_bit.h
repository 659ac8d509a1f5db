#pragma once
// A bit of the converter that stands still. The values of the output then lie on islands of one width, the weight w of the bit, with gaps of the
// same width between them, and where the signal passes from one to the next the output jumps by w, up or down. No level of a staircase does
// that: between islands it jumps by 2 w and more.

#include <optional>
#include <string>
#include <vector>

#include "hil/diagnose/raw/health_claims.h"
#include "hil/trace/campaign.h"

namespace forcegate::diagnose {

struct StuckBit {
  double weight_V = 0.0, step_V = 0.0;  ///< of the bit; between neighbouring values
  double samples = 0.0, off = 0.0;      ///< of all records; of these, without the bit
  std::vector<double> mean_square_V2{};  ///< what it adds to the mean squared error of each record, in the order of the campaign
};

/// Adds the bit to the samples that lack it, in all records: after a jump down it is missing, after one up it is there, and where other jumps part
/// them a straight line in the force decides (whether it stands at 0 or at 1 is a matter of the zero). Nothing is changed, and nothing told, where
/// the output does not lie the nearer to such a line. Says in `notes` what was mended.
std::optional<StuckBit> mend_stuck_bit(Campaign& campaign, std::vector<std::string>& notes);

HealthClaim claim_of_stuck_bit(const StuckBit& bit, const std::string& unit);

}  // namespace forcegate::diagnose
