#pragma once
// A wheel whose force departs from the rig's law by the same at the same angle, record for record: out of round, dented, or not of the declared form.

#include <optional>
#include <string>

#include "hil/diagnose/choose/select.h"
#include "hil/diagnose/diagnosis.h"
#include "hil/diagnose/workspace.h"

namespace forcegate::diagnose {

struct UnevenWheel {
  std::string follows;  ///< "the angle of the wheel, at which the force departs from the rig's law by 20 mN"
  ResidualMap map;      ///< F_ref less the rig's law over the angle
};

/// Where nothing that was found in `rig` explains it: the mean departure over 36 angles of all other records takes a third and more off what is left
/// of two records in three that come by half of these, three at least, and is 0.3 % of the force range (RMS).
std::optional<UnevenWheel> uneven_wheel(const Workspace& workspace, const Selection& rig);

}  // namespace forcegate::diagnose
