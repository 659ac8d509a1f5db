#pragma once
// What an effect does for records that its strengths were not fitted to. No effect is claimed without it: an effect that
// lowers the error of the records it was fitted to, and of no others, is a fit and no finding.

#include <vector>

#include "hil/diagnose/workspace.h"

namespace forcegate::diagnose {

/// Fall of the mean square error of parts that were left out. Parts are whole records where three or more show the
/// effect, else blocks of records. Both models may follow a part's own gain, offset and decay by the same spread, that of
/// the model without the effect, so that a model with a smaller spread is not blamed for it.
struct CrossFit {
  int parts = 0, excited = 0, improved = 0;  ///< excited: the effect moves its residual
  int voting = 0, in_favour = 0;  ///< excited parts that do not stay within what the instruments may leave; those that improve
  bool blocks = false;
  double before = 0.0, after = 0.0;  ///< mean squares over all parts
  double fall = 0.0,
         standard_error = 0.0;   ///< before - after, of whole records those excited alone, over all parts; its uncertainty from the scatter
  double log_ratio = 0.0;        ///< mean of ln(before/after) over excited parts
  double log_ratio_error = 0.0;  ///< standard error of that mean
  double share = 0.0;            ///< of what the noise does not explain in excited parts

  double risen = 0.0, fallen = 0.0;  ///< sums of |ln(before/after)| over excited parts that rise and that fall

  /// Blocks of one or two records do not repeat a rare event in the same size: their error must fall, no more. Of records most must
  /// improve, or some by so much that the others' rise is small beside it.
  bool helps() const {
    constexpr double kOutweighs = 4.0, kByMuch = 0.5, kErrors = 2.0;
    if (blocks) return fall > 0.0 && improved > 0;
    const bool most = in_favour * 2 > voting || (voting == 0 && improved * 2 > excited);
    const bool by_much = in_favour > 1 && log_ratio > kByMuch && fallen > kOutweighs * risen;
    // one record of a large error makes the scatter of the falls as large as their mean
    const bool plainly = fall > standard_error || (fall > 0.0 && log_ratio > kErrors * log_ratio_error);
    return plainly && log_ratio > 0.0 && (most || by_much);
  }
};
CrossFit cross_fit(const ResidualChannel& channel, const MixedFit& before, const MixedFit& after);

}  // namespace forcegate::diagnose
