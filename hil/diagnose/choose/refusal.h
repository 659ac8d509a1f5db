#pragma once
// Why an effect that the screen put forward is not taken. A new reason is one line in the enumeration and one in the table.

#include <array>
#include <cstddef>
#include <string_view>

namespace forcegate::diagnose {

enum class Refusal {
  none,                  ///< it is taken
  too_little_evidence,
  unphysical,            ///< wrong sign
  leads,                 ///< the output is ahead of the reference
  in_step,               ///< what is carried along has put output and reference in step
  jitter,                ///< it fits the noise of the reference at a standstill
  too_small,             ///< the declared instruments may feign it
  leaves_most,
  few_jumps,             ///< codes of the converter
  differs,               ///< no one strength over the records
  within_form,           ///< no more than the first effect's form may be wrong by
  in_few_records,
  helps_no_records,      ///< left-out records
  helps_no_parts,        ///< left-out parts of records
  second_between,        ///< one effect between records is in already
  records_scatter_on,    ///< between records: the spread does not fall enough
  helps_no_left_levels,  ///< between records: gains and zeros of left-out records
  start_unknown,         ///< a course over campaign time that nobody wrote down
  any_order,             ///< between records: chance
  needless               ///< the other effects do without
};

struct RefusalTraits {
  std::string_view code;      ///< key in the JSON
  std::string_view sentence;  ///< for people
  bool suspicion;             ///< the effect may be there although it was refused
  double probability;  ///< how often it was, of those refused with a score of 20 and more: counted on some 150 of them from three generators
};

inline constexpr double kUncountedSuspicion = 0.2;  // the mean of all reasons

struct RefusalRow {
  Refusal refusal;
  RefusalTraits traits;
};

// in the order of the enumeration
inline constexpr std::array kRefusals = {
    RefusalRow{Refusal::none, {"none", "", false, 0.0}},
    RefusalRow{Refusal::too_little_evidence, {"too_little_evidence", "too little evidence", false, 0.0}},
    RefusalRow{Refusal::unphysical, {"unphysical", "its sign or its size is unphysical", false, 0.0}},
    RefusalRow{Refusal::leads, {"leads", "the output leads the reference", false, 0.0}},
    RefusalRow{Refusal::in_step, {"in_step", "with what is carried along, output and reference are in step", false, 0.0}},
    RefusalRow{Refusal::jitter, {"jitter", "it flattens the noise of the reference where the force stands still", false, 0.0}},
    RefusalRow{Refusal::too_small, {"too_small", "too small beside the noise and the steps of the instruments", true, 0.35}},
    RefusalRow{Refusal::leaves_most, {"leaves_most", "it leaves most of the residual", true, 0.08}},
    RefusalRow{Refusal::few_jumps, {"few_jumps", "jumps at codes explain too little of it", true, 0.4}},
    RefusalRow{Refusal::differs, {"differs", "its strength differs too much between records", true, 0.25}},
    RefusalRow{Refusal::within_form, {"within_form", "it is no more than the first one's form may be wrong by", true, 0.08}},
    RefusalRow{Refusal::in_few_records, {"in_few_records", "only one or two records show it", true, kUncountedSuspicion}},
    RefusalRow{Refusal::helps_no_records, {"helps_no_records", "it does not help records that were left out", true, 0.1}},
    RefusalRow{Refusal::helps_no_parts, {"helps_no_parts", "it does not help parts of records that were left out", true, 0.1}},
    RefusalRow{Refusal::second_between, {"second_between", "another effect between the records is in: what its form leaves is no second one", true, kUncountedSuspicion}},
    RefusalRow{Refusal::records_scatter_on, {"records_scatter_on", "it does not make records predictable from each other", true, kUncountedSuspicion}},
    RefusalRow{Refusal::helps_no_left_levels, {"helps_no_left_levels", "records that were left out are not predicted better", true, kUncountedSuspicion}},
    RefusalRow{Refusal::start_unknown, {"start_unknown", "nobody wrote down when the records were taken: a course over time cannot be told", true, kUncountedSuspicion}},
    RefusalRow{Refusal::any_order, {"any_order", "the records in another order show as much", true, kUncountedSuspicion}},
    RefusalRow{Refusal::needless, {"needless", "needless beside the others", true, kUncountedSuspicion}},
};

constexpr bool refusals_in_order() {
  for (std::size_t i = 0; i < kRefusals.size(); ++i)
    if (static_cast<std::size_t>(kRefusals[i].refusal) != i) return false;
  return kRefusals.back().refusal == Refusal::needless;
}
static_assert(refusals_in_order(), "every reason has one row, in the order of the enumeration");

constexpr const RefusalTraits& traits_of(Refusal refusal) { return kRefusals[static_cast<std::size_t>(refusal)].traits; }

/// The probability of a suspicion. `beside_claim`: something else is claimed, whose form leaves small remains.
constexpr double suspicion_probability(Refusal refusal, bool beside_claim) {
  constexpr double kRemains = 0.1;
  return beside_claim && refusal == Refusal::too_small ? kRemains : traits_of(refusal).probability;
}

}  // namespace forcegate::diagnose
