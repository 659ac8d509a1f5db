#include "hil/diagnose/answer/late_drive.h"

#include <fmt/format.h>

#include <algorithm>

namespace forcegate::diagnose {

std::optional<Finding> listed_late_drive(const Workspace& w, const std::vector<Finding>& findings) {
  constexpr double kListed = 0.4;
  const LateDrive& late = w.late_drive;
  const EffectKind* motor = EffectRegistry::instance().find("motor");
  if (!w.has_command || !(late.lag_s > 0.0) || motor == nullptr || std::ranges::find(findings, motor->name, &Finding::effect) != findings.end()) return std::nullopt;
  Finding out = finding_about(*motor, w.command);
  out.form = "late";
  out.probability = kListed;
  out.parameters.push_back({"lag_s", late.lag_s, late.u_s, "s"});
  out.error_before = late.before_N;
  out.error_after = late.after_N;
  out.evidence = fmt::format("the force follows its command {:.3g} ms late in {} {}, and the sensor is innocent; not claimed: drives are late, and nothing "
                             "here says by how much this one may be",
                             1e3 * late.lag_s, late.records, w.input.single ? "parts of the recording" : "records");
  return out;
}

}  // namespace forcegate::diagnose
