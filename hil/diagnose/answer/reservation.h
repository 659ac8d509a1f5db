#pragma once
// What is borne out by the records and still no claim: imperfections that honest benches have, and causes that nobody recorded. A new cap is
// one line in the enumeration, one in the table, and its test in reservation.cpp.

#include <array>
#include <cstddef>
#include <string_view>

#include "hil/diagnose/diagnosis.h"
#include "hil/diagnose/workspace.h"

namespace forcegate::diagnose {

enum class Cap {
  unrecorded,          ///< a free course over the campaign in the name of a channel
  ordinary_curve,
  ordinary_codes,      ///< of the converter
  ordinary_zero,       ///< of the reference, from record to record
  ordinary_drift,      ///< of the reference
  ordinary_creep,      ///< of the reference, or of a film that warms as slowly
  never_below,         ///< the force, the end of a dead zone
  soft_rail,
  rising_rail,
  undeclared_spring,
  undeclared_wheel,
  loop_ahead,          ///< of a sensor
  unclear_loop,        ///< of a sensor or a rig
  loop_too_wide,       ///< for what it explains
  play_ahead,
  ordinary_servo,
  bump_that_stays,     ///< after a change of frequency
  within_a_sample,     ///< a lag or a delay
  skew_of_sweep,       ///< of two clocks, where the force has its own frequency at every time
  sagging_heat,        ///< of a film, that lowers its gain, at one drive
  helps_few,           ///< of the records, or parts, that it touches
  curve_of_loop,
  curve_of_codes,
  unclear_growth,      ///< of a sensor under load
  spikes_of_codes
};

struct CapRow {
  Cap cap;
  std::string_view name;  ///< in docs/diagnosis-engine.md
  double most;            ///< probability that it leaves
  std::string_view why;   ///< for people
  bool leaves_name_open = false;  ///< there is something, and the verdict is no "none"
};

// in the order of the enumeration, which is the one in which they are asked
inline constexpr std::array kCaps = {
    CapRow{Cap::unrecorded, "unrecorded", kNoClaim, "nobody recorded it, and whatever else changes as slowly does the same", true},
    CapRow{Cap::ordinary_curve, "ordinary_curve", kWithdrawn, "honest amplifiers and references are as bent as that"},
    CapRow{Cap::ordinary_codes, "ordinary_codes", kWithdrawn, "honest converters are off their straight line by as much"},
    CapRow{Cap::ordinary_zero, "ordinary_zero", kWithdrawn, "a zero is taken to half a step of the reference before a record, and this one jumps by no more"},
    CapRow{Cap::ordinary_drift, "ordinary_drift", kWithdrawn, "the zero of an honest reference moves by as much over a campaign"},
    CapRow{Cap::ordinary_creep, "ordinary_creep", kWithdrawn, "load cells creep by as much themselves"},
    CapRow{Cap::never_below, "never_below", kWithdrawn, "the force is below its end by the reference's noise alone, which flattens a rest as much"},
    CapRow{Cap::soft_rail, "soft_rail", kWithdrawn, "a rail stops the output, and this hardly bends it"},
    CapRow{Cap::rising_rail, "rising_rail", kWithdrawn, "a rail stops the output at one value, and this one goes on rising with the force"},
    CapRow{Cap::undeclared_spring, "undeclared_spring", kWithdrawn,
           "nobody wrote down that the angle drives a spring, and a crank or a joint bends the force against its angle as well"},
    CapRow{Cap::undeclared_wheel, "undeclared_wheel", kWithdrawn, "nobody wrote down that the angle is that of a wheel, and left-out records hardly gain"},
    CapRow{Cap::loop_ahead, "loop_ahead", kWithdrawn,
           "a film is behind its load; that an output is ahead of it by so little is what a late or coarse reference leaves"},
    CapRow{Cap::unclear_loop, "unclear_loop", kWithdrawn, "its loop is no wider than that is known"},
    CapRow{Cap::loop_too_wide, "loop_too_wide", kWithdrawn, "a loop as wide as that would make far more than it explains: its elements cancel each other"},
    CapRow{Cap::play_ahead, "play_ahead", kWithdrawn, "nobody reads the angle, and no play is ahead of its command"},
    CapRow{Cap::ordinary_servo, "ordinary_servo", kWithdrawn, "nobody reads the angle, and a servo leaves as much between command and force"},
    CapRow{Cap::bump_that_stays, "bump_that_stays", kNoClaim, "it is not seen to fade back: a gain that goes with the frequency leaves the same", true},
    CapRow{Cap::within_a_sample, "within_a_sample", kNoClaim, "it comes to less than half the time between two samples: channels that are read one after the other do as much"},
    CapRow{Cap::skew_of_sweep, "skew_of_sweep", kNoClaim, "the force goes faster and faster: a shift that grows with its frequency, as a mass or a filter makes, looks the same", true},
    CapRow{Cap::sagging_heat, "sagging_heat", kNoClaim,
           "a warm film conducts better, and this gain falls while the load lasts: a stage that leaks, tracks its zero or levels its gain does that too; two drive voltages would tell", true},
    CapRow{Cap::helps_few, "helps_few", kNoClaim, "a law of the sensor or an instrument helps wherever it acts, and this one misses more than a quarter of it", true},
    CapRow{Cap::curve_of_loop, "curve_of_loop", kNoClaim,
           "a loop that is wider at one end of the force has a curve of its own: it is asked again once the loop is in the model"},
    CapRow{Cap::curve_of_codes, "curve_of_codes", kNoClaim, "codes of the converter that are off bend the output too: the curve is asked again with another converter"},
    CapRow{Cap::unclear_growth, "unclear_growth", kNoClaim,
           "how much it grows in time is not known from these records: something remembers the load, and a lag or a loop does too; a hold of some minutes would tell", true},
    CapRow{Cap::spikes_of_codes, "spikes_of_codes", kNoClaim,
           "they stand off by no more than the steps of the converter's codes: where noise crosses one, a sample jumps"},
};

constexpr bool caps_in_order() {
  for (std::size_t i = 0; i < kCaps.size(); ++i)
    if (static_cast<std::size_t>(kCaps[i].cap) != i) return false;
  return kCaps.back().cap == Cap::spikes_of_codes;
}
static_assert(caps_in_order(), "every cap has one row, in the order of the enumeration");

constexpr const CapRow& row_of(Cap cap) { return kCaps[static_cast<std::size_t>(cap)]; }

/// Lowers the probability of a finding by the first cap that holds of it alone, and says why in its evidence.
void reserve(const Workspace& workspace, const ResidualChannel& channel, const MixedFit& base, Finding& finding);

/// curve_of_loop, curve_of_codes: a curve of a sensor beside a loop or beside wrong codes that are larger than it, whether or not these are
/// claimed. Loops whose elements do not close evenly over the force (Preisach) have a curve of their own, of up to their own size, and so have
/// codes; no record tells it from another one.
void leave_curves_to_larger_causes(std::vector<Finding>& findings);

/// unclear_growth, after what else explains a creep has been told: fast loads alone may tell the sum of its terms and none of them.
void leave_unclear_growth_open(std::vector<Finding>& findings);

/// spikes_of_codes, beside claimed steps of the codes.
void leave_spikes_to_codes(const Workspace& workspace, std::vector<Finding>& findings);

}  // namespace forcegate::diagnose
