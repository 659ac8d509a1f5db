#pragma once
// A wheel whose force departs from the rig's law by the same at the same angle, record for record: out of round, dented, or not of the declared form.

#include <optional>
#include <string>

#include "hil/diagnose/choose/select.h"
#include "hil/diagnose/workspace.h"

namespace forcegate::diagnose {

struct UnevenWheel {
  double rms_N = 0.0;   ///< of the departure that the records have in common
  double share = 0.0;   ///< of what the rig's law leaves of them, mean square, each foretold from the others
  std::string follows;  ///< "the angle of the wheel, at which the force departs from the rig's law by 20 mN"
};

/// What nothing that was found in `rig` explains: the mean departure over 36 angles of all other records takes a third and more off what is left of
/// two records in three that go round half a turn, three at least, and is 0.3 % of the force range.
std::optional<UnevenWheel> uneven_wheel(const Workspace& workspace, const Selection& rig);

}  // namespace forcegate::diagnose
