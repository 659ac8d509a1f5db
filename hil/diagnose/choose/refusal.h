#pragma once
// Why an effect that the screen put forward is not taken. A new reason is one line here and one in refusal.cpp.

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

const RefusalTraits& traits_of(Refusal refusal);

/// The probability of a suspicion. `beside_claim`: something else is claimed, whose form leaves small remains.
double suspicion_probability(Refusal refusal, bool beside_claim);

}  // namespace forcegate::diagnose
