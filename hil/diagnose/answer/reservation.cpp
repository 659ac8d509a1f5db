#include "hil/diagnose/answer/reservation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "hil/diagnose/answer/rail_voltage.h"
#include "hil/diagnose/answer/swept_force.h"
#include "hil/diagnose/base/judge.h"
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

struct Asked {
  const Workspace& w;
  const ResidualChannel& channel;
  const MixedFit& base;
  const Finding& f;

  // Of the reference, N: as declared, else its smallest step.
  double resolution_N() const {
    const double declared_N = w.input.bench.reference_resolution_N;
    return std::isfinite(declared_N) ? declared_N : w.scales.step_N;
  }
  template <typename Test>
  bool any_width(Test test) const {
    return std::ranges::any_of(f.parameters, [&](const FoundParameter& p) { return p.name == "loop_width" && test(p); });
  }
  bool is_blind_play() const { return f.effect == "backlash" && !w.input.has_theta && !w.input.has_spindle; }
};

// A dead zone that ends beyond a quarter of the range is a bend.
bool is_ordinary_curve(const Asked& a) {
  constexpr double kOrdinary = 8e-4;  // of the span, RMS: amplifiers, converters and references are bent by as much
  constexpr double kOfRange = 0.25;
  const auto ends_far_up = [&](const FoundParameter& p) { return p.name == "F0_N" && p.value > kOfRange * a.w.input.range_N; };
  const bool bends = a.f.effect == "static_nonlinearity" || (a.f.effect == "dead_zone" && std::ranges::any_of(a.f.parameters, ends_far_up));
  return bends && a.f.effect_rms < kOrdinary * a.channel.scale;
}

bool is_ordinary_codes(const Asked& a) {
  constexpr double kOrdinary = 5e-4;  // of the span, RMS: two codes of twelve bits
  return a.f.effect == "adc_codes" && !a.f.of_samples() && a.f.effect_rms < kOrdinary * a.channel.scale;
}

// Rounding scatters by 0.29 of a step (RMS); of a course that is seen at several forces it makes half of that.
bool is_ordinary_zero(const Asked& a) {
  constexpr double kOfZero = 0.5, kOfCourse = 0.15;  // of a step
  const double steps = a.f.effect_rms * a.w.input.range_N / a.channel.scale / a.resolution_N();
  return (a.f.form == "as_rig_shows" && steps < kOfZero) || (a.f.form == "course_over_rig" && steps < kOfCourse);
}

bool is_ordinary_drift(const Asked& a) {
  constexpr double kOrdinary = 1e-3;  // of the span, RMS: load cells are sold with as much
  return a.f.effect == "reference_drift" && a.f.effect_rms > 0.0 && a.f.effect_rms < kOrdinary * a.channel.scale;
}

bool is_ordinary_creep(const Asked& a) {
  constexpr double kOrdinary = 3e-4;  // of the span, RMS: what good load cells are sold with
  return (a.f.effect == "creep" || a.f.effect == "self_heating") && a.f.effect_rms > 0.0 && a.f.effect_rms < kOrdinary * a.channel.scale;
}

// A dead zone shows by loads that are below its end. Where the force only rests there, its readings go below by their noise, and the output does not.
bool is_never_below(const Asked& a) {
  constexpr double kErrors = 2.0, kFewest = 0.1;  // of the rows below it
  if (a.f.effect != "dead_zone") return false;
  double end_N = -std::numeric_limits<double>::infinity(), below = 0.0, plainly = 0.0;
  for (const FoundParameter& p : a.f.parameters)
    if (p.name.ends_with("F0_N")) end_N = std::max(end_N, p.value);
  for (std::size_t k = 0; k < a.w.input.records.size(); ++k) {
    const RecordInput& r = a.w.input.records[k];
    const double noise_N = std::hypot(a.w.health[k].noise_F_N, a.w.health[k].lsb_F_N / std::sqrt(12.0));
    for (std::size_t i = 0; i < r.rows(); ++i) {
      if (r.ok[i] == 0 || !(r.F_N[i] < end_N)) continue;
      below += 1.0;
      plainly += r.F_N[i] < end_N - kErrors * noise_N ? 1.0 : 0.0;
    }
  }
  return plainly < kFewest * below;
}

bool is_soft_rail(const Asked& a) {
  constexpr double kStops = 0.25;  // of the slope, at least, however softly the rail is met; a curve that the model has not quite is bent by less
  if (a.f.effect != "clipping" || a.f.parameters.empty()) return false;
  double taken = 0.0;
  for (const FoundParameter& p : a.f.parameters)
    if (p.name == "c" || p.name.ends_with(".c")) taken += p.value;
  return taken < kStops;
}

// One that is met softly rises a little too, but its corners leave no more than the noise.
bool is_rising_rail(const Asked& a) {
  constexpr double kStillRises = 0.2;  // of the slope, beyond the last corner
  return a.f.effect == "clipping" && !a.f.parameters.empty() && a.f.error_after > kFarAboveNoise * allowed_rms(a.channel) * a.channel.scale &&
         rise_beyond_rail(a.w, last_corner_N(a.f)).value_or(0.0) > kStillRises;
}

bool is_undeclared_spring(const Asked& a) {
  constexpr double kOfNoSpring = 0.01;  // of the span, RMS: what a law of the rig leaves at most
  // an error of 0: no record that is left out turns
  const bool fits = a.f.error_after > 0.0 && a.f.error_after <= kOfNoSpring * a.w.input.range_N;
  return a.f.effect == "spring_nonlinearity" && !has_declared_law(a.w.input) && !fits;
}

bool is_undeclared_wheel(const Asked& a) {
  constexpr double kHardlyFalls = 0.95;
  return a.f.effect == "off_axis" && !has_declared_law(a.w.input) && a.f.error_after > kHardlyFalls * a.f.error_before;
}

bool is_loop_ahead(const Asked& a) {
  constexpr double kOrdinary_pct = 1.0;  // of the span, width of a loop
  constexpr double kOfSteps = 4.0;       // of the reference's: what its rounding makes of a turning point at most
  return a.f.effect == "hysteresis" && a.channel.signs_known && a.any_width([&](const FoundParameter& p) {
    return p.value <= 0.0 && p.value > -kOrdinary_pct &&
           (-0.01 * p.value * a.w.input.range_N < kOfSteps * a.resolution_N() || may_be_late_reference(a.w, a.channel, a.base, a.f));
  });
}

// Gain and zero of the records take a part of a loop, and it keeps a tenth of its width at least.
bool is_loop_too_wide(const Asked& a) {
  constexpr double kOfEffect = 50.0;  // width over RMS
  return a.f.effect == "hysteresis" && a.f.effect_rms > 0.0 &&
         a.any_width([&](const FoundParameter& p) { return 0.01 * std::abs(p.value) > kOfEffect * a.f.effect_rms / a.channel.scale; });
}

bool is_unclear_loop(const Asked& a) {
  constexpr double kErrors = 2.0;
  return (a.f.effect == "hysteresis" || a.f.effect == "backlash") && a.any_width([](const FoundParameter& p) { return std::abs(p.value) < kErrors * p.u; });
}

bool is_play_ahead(const Asked& a) {
  return a.is_blind_play() && a.any_width([](const FoundParameter& p) { return p.value < 0.0; });
}

bool is_ordinary_servo(const Asked& a) {
  constexpr double kOrdinary_pct = 0.5;  // of the span, width of a loop
  return a.is_blind_play() && a.any_width([](const FoundParameter& p) { return p.value < kOrdinary_pct; });
}

bool is_bump_that_stays(const Asked& a) {
  constexpr double kFades_s = 90.0;  // what takes longer, records of some minutes hardly tell from a step
  if (a.f.effect != "frequency_bump") return false;
  double shortest_s = std::numeric_limits<double>::infinity();
  for (const FoundParameter& p : a.f.parameters)
    if (p.name.ends_with("tau_s")) shortest_s = std::min(shortest_s, p.value);
  return std::isfinite(shortest_s) && shortest_s > kFades_s;
}

// A lag that differs with the load is no delay. Rounded to the nearest sample such a shift is none.
bool is_within_a_sample(const Asked& a) {
  constexpr double kHalf = 0.5;
  if (a.f.parameters.size() != 1 || a.f.form == "sooner_under_load") return false;
  const FoundParameter& shift = a.f.parameters.front();
  return (shift.name == "lag_s" || shift.name == "delay_s") && std::abs(shift.value) < kHalf * shortest_sample_s(a.w.input);
}

// A block that a logger lost shifts the output at once: no frequency does.
bool is_skew_of_sweep(const Asked& a) {
  constexpr double kSame = 0.9;
  return a.f.effect == "clock_skew" && a.f.form == "linear" && time_as_frequency(a.w.input) > kSame;
}

// Conduction by tunnelling and hopping grows with the temperature. Heat that goes with the square of the drive is heat, whatever its sign.
bool is_sagging_heat(const Asked& a) {
  constexpr double kSame = 0.2;
  double low = std::numeric_limits<double>::infinity(), high = 0.0;
  for (const RecordInput& r : a.w.input.records)
    if (std::isfinite(r.drive_mean_V)) {
      low = std::min(low, std::abs(r.drive_mean_V));
      high = std::max(high, std::abs(r.drive_mean_V));
    }
  return a.f.effect == "self_heating" && !(high > (1.0 + kSame) * low) &&
         std::ranges::any_of(a.f.parameters, [](const FoundParameter& p) { return (p.name == "c" || p.name.ends_with(".c")) && p.value < 0.0; });
}

// No form of a loop or a curve is right everywhere; what acts between records is judged by levels.
bool helps_few(const Asked& a) {
  constexpr double kMost = 0.75;
  constexpr int kFewest = 4;
  return a.f.effect != "hysteresis" && !is_curve(a.f.effect) && !a.f.between_records && a.f.records_excited >= kFewest &&
         a.f.records_improved < kMost * a.f.records_excited;
}

// Of a finding alone.
constexpr std::pair<Cap, bool (*)(const Asked&)> kTests[] = {
    {Cap::unrecorded, [](const Asked& a) { return a.f.form == kUnrecorded; }},
    {Cap::ordinary_curve, is_ordinary_curve},
    {Cap::ordinary_codes, is_ordinary_codes},
    {Cap::ordinary_zero, is_ordinary_zero},
    {Cap::ordinary_drift, is_ordinary_drift},
    {Cap::ordinary_creep, is_ordinary_creep},
    {Cap::never_below, is_never_below},
    {Cap::soft_rail, is_soft_rail},
    {Cap::rising_rail, is_rising_rail},
    {Cap::undeclared_spring, is_undeclared_spring},
    {Cap::undeclared_wheel, is_undeclared_wheel},
    {Cap::loop_ahead, is_loop_ahead},
    {Cap::unclear_loop, is_unclear_loop},
    {Cap::loop_too_wide, is_loop_too_wide},
    {Cap::play_ahead, is_play_ahead},
    {Cap::ordinary_servo, is_ordinary_servo},
    {Cap::bump_that_stays, is_bump_that_stays},
    {Cap::within_a_sample, is_within_a_sample},
    {Cap::skew_of_sweep, is_skew_of_sweep},
    {Cap::sagging_heat, is_sagging_heat},
    {Cap::helps_few, helps_few},
};

void lower(Cap cap, Finding& f) {
  const CapRow& row = row_of(cap);
  f.limit(row.most, std::string(row.why));
  f.name_is_open |= row.leaves_name_open;
}

}  // namespace

void reserve(const Workspace& w, const ResidualChannel& channel, const MixedFit& base, Finding& f) {
  const Asked asked{w, channel, base, f};
  for (const auto& [cap, holds] : kTests)
    if (holds(asked)) return lower(cap, f);
}

void leave_curves_to_larger_causes(std::vector<Finding>& findings) {
  constexpr std::pair<const char*, Cap> kCauses[] = {{"hysteresis", Cap::curve_of_loop}, {"adc_codes", Cap::curve_of_codes}};
  for (const auto& [effect, cap] : kCauses) {
    const auto cause = std::ranges::find_if(findings, [&, name = effect](const Finding& f) { return f.effect == name && !f.of_samples() && f.effect_rms > 0.0; });
    if (cause == findings.end()) continue;
    for (Finding& f : findings)
      if (is_curve(f.effect) && f.side == "sensor" && f.shown_in == cause->shown_in && f.effect_rms < cause->effect_rms) lower(cap, f);
  }
}

void leave_unclear_growth_open(std::vector<Finding>& findings) {
  constexpr double kErrors = 2.0;
  const auto grows = [](const FoundParameter& p) { return p.name.starts_with("growth_"); };
  const auto is_known = [&](const FoundParameter& p) { return grows(p) && std::abs(p.value) >= kErrors * p.u; };
  for (Finding& f : findings)
    if (f.effect == "creep" && f.claimed() && std::ranges::any_of(f.parameters, grows) && std::ranges::none_of(f.parameters, is_known)) lower(Cap::unclear_growth, f);
}

void leave_spikes_to_codes(const Workspace& w, std::vector<Finding>& findings) {
  constexpr double kOfSteps = 1.5;
  const auto codes = std::ranges::find_if(findings, [](const Finding& f) { return f.effect == "adc_codes" && !f.of_samples() && f.claimed(); });
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
    if (f.effect == "outliers" && f.of_samples()) lower(Cap::spikes_of_codes, f);
}

}  // namespace forcegate::diagnose
