#include "hil/diagnose/answer/reservation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "hil/diagnose/answer/findings.h"
#include "hil/diagnose/answer/rail_voltage.h"
#include "hil/diagnose/choose/objection.h"
#include "hil/diagnose/choose/reference_latency.h"
#include "hil/model/lagged_channel.h"

namespace forcegate::diagnose {

namespace {

// Whether the lab wrote down that the angle drives a spring.
bool has_declared_law(const CampaignInput& c) {
  return !c.bench.law.empty() || std::isfinite(c.bench.spring_N_per_mm) ||
         std::any_of(c.records.begin(), c.records.end(), [](const RecordInput& r) { return std::isfinite(r.eccentricity_mm); });
}

// Whether leads that a late reference may have take a third of what a loop takes.
bool may_be_late_reference(const Workspace& w, const ResidualChannel& channel, const MixedFit& base, const Finding& f) {
  constexpr double kShare = 1.0 / 3.0;
  std::vector<int> columns = base.columns;
  add_leads(channel, columns);
  const MixedFit leads = fit_mixed(channel.problem, columns, &base, 20, base.use);
  if (!leads.valid) return true;
  const double square = channel.scale * channel.scale * judged(channel, judge(channel, leads, base, w.judges).adapted, w.judges);
  return f.error_before * f.error_before - square > kShare * (f.error_before * f.error_before - f.error_after * f.error_after);
}

double last_corner_N(const Finding& clipping) {
  double out = -std::numeric_limits<double>::infinity();
  for (const FoundParameter& p : clipping.parameters)
    if (p.name.ends_with("Wr_N")) out = std::max(out, p.value);
  return out;
}

Reservation reservation(const Workspace& w, const ResidualChannel& channel, const MixedFit& base, const Finding& f) {
  const CampaignInput& campaign = w.input;
  const double declared_N = campaign.bench.reference_resolution_N, resolution_N = std::isfinite(declared_N) ? declared_N : w.scales.step_N;
  constexpr double kOrdinaryCurve = 8e-4;      // of the span, RMS: amplifiers, converters and references are bent by as much
  constexpr double kOrdinaryServo_pct = 0.5;  // of the span, width of a loop
  constexpr double kOrdinaryLead_pct = 1.0;   // the same of a loop that runs ahead of the load
  constexpr double kOfSteps = 4.0;            // of the reference's: what its rounding makes of a turning point at most
  constexpr double kStops = 0.1;              // of the slope, at least, however softly the rail is met
  constexpr double kStillRises = 0.2;         // of the slope, beyond the last corner
  constexpr double kFarAbove = 2.5;           // times what the instruments may leave
  constexpr double kOfNoSpring = 0.01;        // of the span, RMS: what a law of the rig leaves at most
  constexpr double kHardlyFalls = 0.95;
  constexpr double kErrors = 2.0;
  constexpr double kNothingToFind = 0.2;
  if (f.form == kUnrecorded) return {kNoClaim, "nobody recorded it, and whatever else changes as slowly does the same"};
  if (f.effect == "static_nonlinearity" && f.effect_rms < kOrdinaryCurve * channel.scale)
    return {kNothingToFind, "honest amplifiers and references are as bent as that"};
  if (f.form == "as_rig_shows" && f.effect_rms * campaign.range_N / channel.scale < 0.5 * resolution_N)
    return {kNothingToFind, "a zero is taken to half a step of the reference before a record, and this one jumps by no more"};
  if (f.effect == "clipping" && !f.parameters.empty()) {
    double taken = 0.0;
    for (const FoundParameter& p : f.parameters)
      if (p.name == "c" || p.name.ends_with(".c")) taken += p.value;
    if (taken < kStops) return {kNothingToFind, "a rail stops the output, and this hardly bends it"};
    // one that is met softly rises a little too, but its corners leave no more than the noise
    if (f.error_after > kFarAbove * allowed_rms(channel) * channel.scale && rise_beyond_rail(w, last_corner_N(f)).value_or(0.0) > kStillRises)
      return {kNothingToFind, "a rail stops the output at one value, and this one goes on rising with the force"};
  }
  // an error of 0: no record that is left out turns
  const bool fits = f.error_after > 0.0 && f.error_after <= kOfNoSpring * campaign.range_N;
  if (f.effect == "spring_nonlinearity" && !has_declared_law(campaign) && !fits)
    return {kNothingToFind, "nobody wrote down that the angle drives a spring, and a crank or a joint bends the force against its angle as well"};
  if (f.effect == "off_axis" && !has_declared_law(campaign) && f.error_after > kHardlyFalls * f.error_before)
    return {kNothingToFind, "nobody wrote down that the angle is that of a wheel, and left-out records hardly gain"};
  if (f.effect == "hysteresis" && channel.signs_known)
    for (const FoundParameter& p : f.parameters)
      if (p.name == "loop_width" && p.value <= 0.0 && p.value > -kOrdinaryLead_pct &&
          (-0.01 * p.value * campaign.range_N < kOfSteps * resolution_N || may_be_late_reference(w, channel, base, f)))
        return {kNothingToFind, "a film is behind its load; that an output is ahead of it by so little is what a late or coarse reference leaves"};
  if (f.effect == "hysteresis" || f.effect == "backlash")
    for (const FoundParameter& p : f.parameters)
      if (p.name == "loop_width" && std::abs(p.value) < kErrors * p.u) return {kNothingToFind, "its loop is no wider than that is known"};
  if (f.effect == "backlash" && !campaign.has_theta)
    for (const FoundParameter& p : f.parameters) {
      if (p.name != "loop_width") continue;
      if (p.value < 0.0) return {kNothingToFind, "nobody reads the angle, and no play is ahead of its command"};
      if (p.value < kOrdinaryServo_pct) return {kNothingToFind, "nobody reads the angle, and a servo leaves as much between command and force"};
    }
  return {};
}

}  // namespace

void reserve(const Workspace& w, const ResidualChannel& channel, const MixedFit& base, Finding& f) {
  const Reservation r = reservation(w, channel, base, f);
  f.limit(r.most, r.why);
}

void leave_curves_to_larger_causes(std::vector<Finding>& findings) {
  constexpr std::pair<const char*, const char*> kCauses[] = {
      {"hysteresis", "a loop that is wider at one end of the force has a curve of its own: it is asked again once the loop is in the model"},
      {"adc_codes", "codes of the converter that are off bend the output too: the curve is asked again with another converter"}};
  for (const auto& [effect, why] : kCauses) {
    const auto cause = std::ranges::find_if(findings, [&](const Finding& f) { return f.effect == effect && f.form != "raw" && f.effect_rms > 0.0; });
    if (cause == findings.end()) continue;
    for (Finding& f : findings)
      if (is_curve(f.effect) && f.side == "sensor" && f.form != "raw" && f.unit == cause->unit && f.effect_rms < cause->effect_rms) f.limit(kNoClaim, why);
  }
}

void leave_spikes_to_codes(const Workspace& w, std::vector<Finding>& findings) {
  constexpr double kOfSteps = 1.5;
  const auto codes = std::ranges::find_if(findings, [](const Finding& f) { return f.effect == "adc_codes" && f.form != "raw" && f.claimed(); });
  if (codes == findings.end()) return;
  double steps_N = 0.0, square_V2 = 0.0, n = 0.0;
  for (const FoundParameter& p : codes->parameters)
    if (p.unit == "N") steps_N += std::abs(p.value);
  for (const RecordHealth& h : w.health) {
    square_V2 += h.outlier_square_V2;
    n += static_cast<double>(h.outliers);
  }
  if (!(std::sqrt(square_V2 / std::max(1.0, n)) < kOfSteps * std::abs(w.gain_V_per_N) * steps_N)) return;
  for (Finding& f : findings)
    if (f.effect == "outliers" && f.form == "raw") f.limit(kNoClaim, "they stand off by no more than the steps of the converter's codes: where noise crosses one, a sample jumps");
}

}  // namespace forcegate::diagnose

namespace forcegate {

bool Finding::limit(double most, const std::string& why) {
  if (!(probability > most)) return false;
  probability = most;
  reservations.push_back({most, why});
  evidence += (most < 0.5 ? "; not claimed: " : "; less sure: ") + why;
  return true;
}

}  // namespace forcegate
