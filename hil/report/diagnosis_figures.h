#pragma once
// The pictures of a diagnosis. What each shows: residual against force by direction = hysteresis or
// nonlinearity; against log time = creep; against rate = viscosity or lag; spectrum = resonance, mains; map =
// where the error lives.

#include "hil/diagnose/diagnosis.h"
#include "hil/report/figures/figure.h"

namespace forcegate {

/// Error waterfall over the claimed findings, in their order.
figures::Figure diagnosis_waterfall(const Diagnosis& diagnosis);

/// Whether this is claimed of the rig's own law, and whether anything is.
bool is_of_rig(const Diagnosis& diagnosis, const Finding& finding);
bool shows_rig(const Diagnosis& diagnosis);

/// Whether a line of the mains is claimed.
bool claims_hum(const Diagnosis& diagnosis);

/// The same of F_ref against the rig's law, over its claims. Only where shows_rig().
figures::Figure rig_waterfall(const Diagnosis& diagnosis);

/// Probability of each ranked effect (at most 12 rows), and the share it takes away alone and only it takes
/// away, where any takes one.
figures::Figure ranking_figure(const Diagnosis& diagnosis);

/// "Held-out error", or of what it is where nothing could be held out.
std::string error_title(JudgedBy judged_by);

/// Held-out error of every record before and after, with its noise.
figures::Figure record_error_figure(const Diagnosis& diagnosis);

/// Whether anything entered the model: false where the maps after are those before, or there are none.
bool has_after(const Diagnosis& diagnosis);

/// Heat map of the residual, one row a coordinate, cells from its low to its high end; hatched where fewer
/// than three blocks stand behind the mean. `after` uses Diagnosis::maps_after; both pictures share rows and
/// colours.
figures::Figure residual_map_figure(const Diagnosis& diagnosis, bool after);

/// Cell means with U (k = 2) against one coordinate, before and, where there is one, after. Logarithmic, or logarithmic beyond a linear
/// middle, where many cells of few units stand beside few of many.
figures::Figure coordinate_figure(const ResidualMap& before, const ResidualMap* after, const std::string& residual_unit,
                                  const std::string& residual = "Residual");

/// F_ref less the rig's law against one coordinate.
figures::Figure rig_coordinate_figure(const ResidualMap& map);

/// Residual without and with the effect, side by side on one scale.
figures::Figure evidence_figure(const EvidenceSeries& series);

/// Samples as recorded beside what they should be, those that a claim names marked.
figures::Figure sample_figure(const SampleWindow& window);

}  // namespace forcegate
