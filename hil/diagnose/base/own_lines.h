#pragma once
// Lines through parts of a recording, U = gain W + zero (W the base force), of which every part may have its own zero or gain.

#include <Eigen/Dense>
#include <vector>

#include "hil/diagnose/base/mixed_model.h"
#include "hil/diagnose/workspace.h"

namespace forcegate::diagnose {

/// Sums over rows: of W, and of what a fit leaves of the output beside its line. Shares of the channel's scale.
struct LineSums {
  double n = 0.0, W = 0.0, WW = 0.0, y = 0.0, Wy = 0.0, yy = 0.0;
};

/// Rows `begin` to `end` of the record's chosen ones; empty where begin is end.
LineSums line_sums(const ResidualChannel& channel, const MixedFit& fit, std::size_t record, Eigen::Index begin, Eigen::Index end);

/// All chosen rows of every record.
std::vector<LineSums> line_sums_of_records(const ResidualChannel& channel, const MixedFit& fit);

enum class OwnOfLine { nothing, zero, gain };

struct LineThrough {
  double left = 0.0;    ///< mean square
  Eigen::VectorXd own;  ///< of each part; empty for nothing
};

/// Least squares of one line through all parts, of which each has its own zero or gain.
LineThrough line_through(const std::vector<LineSums>& parts, OwnOfLine own);

/// Mean square that a line of its own leaves in every part.
double left_by_own_lines(const std::vector<LineSums>& parts);

}  // namespace forcegate::diagnose
