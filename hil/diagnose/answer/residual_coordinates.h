#pragma once
// What a residual is mapped against: force, rate, history, time, and the columns that were recorded.

#include <cstddef>
#include <vector>

#include "hil/diagnose/workspace.h"

namespace forcegate::diagnose {

/// The last turning point of the force before a row, with a prominence of 5 % of the force range.
struct LastTurn {
  double force_N, time_s;
};

struct MappedRow {
  const RecordInput& record;
  std::size_t i;
  LastTurn turn;
};

struct ResidualCoordinate {
  const char* name;                    ///< ResidualMap::coordinate
  const char* group;                   ///< ResidualMap::group
  const char* unit;                    ///< lives as long as the workspace
  double (*of)(const MappedRow&);      ///< NaN where it does not apply
};

/// Those that these records have.
std::vector<ResidualCoordinate> residual_coordinates(const Workspace& workspace);

/// From -pi to pi, rad. Only where an angle was recorded.
ResidualCoordinate wheel_angle();

/// Of every chosen row of a record of `channel`.
std::vector<std::vector<MappedRow>> mapped_rows(const Workspace& workspace, const ResidualChannel& channel, unsigned threads);

}  // namespace forcegate::diagnose
