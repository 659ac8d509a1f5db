#include "hil/diagnose/answer/moving_zero.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "hil/diagnose/answer/findings.h"
#include "hil/diagnose/base/own_lines.h"

namespace forcegate::diagnose {

std::optional<Finding> listed_moving_zero(const Workspace& w, const Selection& selection, const std::vector<Finding>& findings) {
  constexpr double kListed = 0.4;
  constexpr double kOfNothing = 0.16, kOfGains = 0.35;  // of what one line, and lines with own gains, leave above what own lines leave
  constexpr double kLeast = 2e-3;                      // of the span
  constexpr std::size_t kFewestParts = 4;
  const EffectKind* drift = EffectRegistry::instance().find("reference_drift");
  const MixedFit& fit = selection.claimed.valid ? selection.claimed : selection.base;
  if (!w.input.single || !w.zero_wanders || !fit.valid || w.output.rows.size() < kFewestParts || drift == nullptr ||
      std::ranges::find(findings, drift->name, &Finding::effect) != findings.end())
    return std::nullopt;
  const std::vector<LineSums> parts = line_sums_of_records(w.output, fit);
  const LineThrough zeros = line_through(parts, OwnOfLine::zero);
  const double moved = zeros.own.maxCoeff() - zeros.own.minCoeff(), without = line_through(parts, OwnOfLine::nothing).left;
  const double least = left_by_own_lines(parts), above = zeros.left - least;
  if (above > kOfNothing * (without - least) || above > kOfGains * (line_through(parts, OwnOfLine::gain).left - least) || moved < kLeast) return std::nullopt;
  Finding out = finding_about(*drift, w.output);
  out.form = "within_recording";
  out.probability = kListed;
  out.side_witnessed = false;
  out.error_before = w.output.scale * std::sqrt(without);
  out.error_after = w.output.scale * std::sqrt(zeros.left);
  out.evidence = fmt::format("the zero moves by {:.3g} m{} over the recording, whatever the force; not claimed: without a third channel nothing says whether it is "
                             "that of the reference or the sensor's own; a rest without load before and after shows both",
                             1e3 * w.output.scale * moved, w.output.unit);
  return out;
}

}  // namespace forcegate::diagnose
