#include "hil/diagnose/choose/refusal.h"

#include <array>
#include <cstddef>

namespace forcegate::diagnose {
namespace {

constexpr double kUncounted = 0.2;  // the mean of all reasons

struct Row {
  Refusal refusal;
  RefusalTraits traits;
};

// in the order of the enumeration
constexpr std::array kRows = {
    Row{Refusal::none, {"none", "", false, 0.0}},
    Row{Refusal::too_little_evidence, {"too_little_evidence", "too little evidence", false, 0.0}},
    Row{Refusal::unphysical, {"unphysical", "its sign is unphysical", false, 0.0}},
    Row{Refusal::leads, {"leads", "the output leads the reference", false, 0.0}},
    Row{Refusal::in_step, {"in_step", "with what is carried along, output and reference are in step", false, 0.0}},
    Row{Refusal::jitter, {"jitter", "it flattens the noise of the reference where the force stands still", false, 0.0}},
    Row{Refusal::too_small, {"too_small", "too small for the declared instruments", true, 0.35}},
    Row{Refusal::leaves_most, {"leaves_most", "it leaves most of the residual", true, 0.08}},
    Row{Refusal::few_jumps, {"few_jumps", "jumps at codes explain too little of it", true, 0.4}},
    Row{Refusal::differs, {"differs", "its strength differs too much between records", true, 0.25}},
    Row{Refusal::within_form, {"within_form", "it is no more than the first one's form may be wrong by", true, 0.08}},
    Row{Refusal::in_few_records, {"in_few_records", "only one or two records show it", true, kUncounted}},
    Row{Refusal::helps_no_records, {"helps_no_records", "it does not help records that were left out", true, 0.1}},
    Row{Refusal::helps_no_parts, {"helps_no_parts", "it does not help parts of records that were left out", true, 0.1}},
    Row{Refusal::second_between, {"second_between", "another effect between the records is in: what its form leaves is no second one", true, kUncounted}},
    Row{Refusal::records_scatter_on, {"records_scatter_on", "it does not make records predictable from each other", true, kUncounted}},
    Row{Refusal::helps_no_left_levels, {"helps_no_left_levels", "records that were left out are not predicted better", true, kUncounted}},
    Row{Refusal::start_unknown, {"start_unknown", "nobody wrote down when the records were taken: a course over time cannot be told", true, kUncounted}},
    Row{Refusal::any_order, {"any_order", "the records in another order show as much", true, kUncounted}},
    Row{Refusal::needless, {"needless", "needless beside the others", true, kUncounted}},
};

constexpr bool in_order() {
  for (std::size_t i = 0; i < kRows.size(); ++i)
    if (static_cast<std::size_t>(kRows[i].refusal) != i) return false;
  return kRows.back().refusal == Refusal::needless;
}
static_assert(in_order(), "every reason has one row, in the order of the enumeration");

}  // namespace

const RefusalTraits& traits_of(Refusal refusal) { return kRows[static_cast<std::size_t>(refusal)].traits; }

double suspicion_probability(Refusal refusal, bool beside_claim) {
  constexpr double kRemains = 0.1;
  return beside_claim && refusal == Refusal::too_small ? kRemains : traits_of(refusal).probability;
}

}  // namespace forcegate::diagnose
