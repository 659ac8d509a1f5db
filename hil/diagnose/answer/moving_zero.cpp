#include "hil/diagnose/answer/moving_zero.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "hil/base/plain_number.h"
#include "hil/base/quantile.h"
#include "hil/diagnose/answer/findings.h"
#include "hil/diagnose/base/own_lines.h"
#include "hil/diagnose/base/repeatability.h"

namespace forcegate::diagnose {

namespace {

std::string size_text(double size, const std::string& unit) {
  const PrintedUnit printed = printed_unit(unit);
  return plain_number(printed.factor * size) + " " + printed.name;
}

constexpr double kListed = 0.4;

// Of the records of more than a minute, three and more.
template <double (*OfRecord)(const MixedFit&, std::size_t)>
std::optional<double> typical(const MixedFit& fit) {
  constexpr std::size_t kFewest = 3;
  std::vector<double> out;
  for (std::size_t k = 0; k < fit.zeta.size(); ++k)
    if (wander_of(fit, k) > 0.0) out.push_back(OfRecord(fit, k));
  return out.size() < kFewest ? std::nullopt : std::optional(quantile(std::move(out), 0.5));
}

}  // namespace

std::optional<Finding> listed_moving_zero(const Workspace& w, const Selection& selection, const std::vector<Finding>& findings) {
  constexpr double kOfNothing = 0.16, kOfGains = 0.35;  // of what one line, and lines with own gains, leave above what own lines leave
  constexpr double kLeast = 2e-3;                      // of the span
  constexpr std::size_t kFewestParts = 4;
  const EffectKind* drift = EffectRegistry::instance().find("reference_drift");
  // what was chosen and is not claimed may have taken the movement for its own
  const bool claims = std::ranges::any_of(findings, [](const Finding& f) { return f.claimed() && f.of_output(); });
  const MixedFit& fit = claims && selection.claimed.valid ? selection.claimed : selection.base;
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
  out.evidence = fmt::format("the zero moves by {} over the recording, whatever the force; not claimed: without a third channel nothing says whether it is "
                             "that of the reference or the sensor's own; a rest without load before and after shows both",
                             size_text(w.output.scale * moved, w.output.unit));
  return out;
}

void leave_creep_to_moving_zero(const Workspace& w, const MixedFit& fit, std::vector<Finding>& findings) {
  const std::optional<double> wander = w.input.single ? std::nullopt : typical<wander_of>(fit);
  if (!wander) return;
  for (Finding& f : findings)
    if (f.effect == "creep" && f.of_output() && f.claimed() && f.effect_rms < *wander * w.output.scale)
      f.name_is_open |= f.limit(kNoClaim, "the zero moves by more than that within the records, whatever the force, and not as evenly as the waves that stand for it");
}

std::optional<MovingZero> moving_zero_of_records(const Workspace& w, const MixedFit& fit) {
  constexpr double kOrdinary = 2e-3, kFar = 4e-3;  // of the span, RMS
  const EffectKind* drift = EffectRegistry::instance().find("reference_drift");
  const std::optional<double> wander = w.input.single ? std::nullopt : typical<wander_of>(fit);
  if (drift == nullptr || !(wander.value_or(0.0) > kOrdinary)) return std::nullopt;
  const std::string size = size_text(w.output.scale * *typical<wander_range_of>(fit), w.output.unit);
  MovingZero out{finding_about(*drift, w.output), *wander > kFar ? "the time within the record, in which the zero moves by " + size : std::string()};
  out.finding.form = "within_records";
  out.finding.probability = kListed;
  out.finding.side_witnessed = false;
  out.finding.evidence = fmt::format("the zero moves by {} within a record, whatever the force; not claimed: without a third channel nothing says whether it is "
                                     "that of the reference or the sensor's own; a rest without load before and after shows both",
                                     size);
  return out;
}

}  // namespace forcegate::diagnose
