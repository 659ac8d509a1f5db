#pragma once
// `forcegate explain`: what a word of a report or an exit code means, and what to do about it.

#include <string>
#include <string_view>
#include <vector>

#include "hil/model/effect.h"

namespace forcegate {

struct Explanation {
  std::string term;  ///< "marginal", "NO-DECISION", "4"
  std::string kind;  ///< "verdict", "decision", "who must act", "exit code", "diagnosis", "side", "figure", "check", "effect", "form"
  std::string meaning;
  std::string what_to_do;
};

/// Sorted by kind as a report mentions them.
const std::vector<Explanation>& explanations();

/// Words beside the numbers of a report: those of explanations() that are of the kind "figure".
const std::vector<Explanation>& figure_explanations();

/// The checks of a gate, by the id that stands in its reports ("promise_maxima/CASE" without the case).
const std::vector<Explanation>& check_explanations();

/// Of an effect of the library: what it does, its equation, what it looks like and what parts it from that.
Explanation explanation_of(const EffectKind& effect);

/// Every meaning of a word, case-insensitive: "none" is said of a diagnosis and of who must act. Empty when there is none.
std::vector<Explanation> find_explanations(std::string_view term);

}  // namespace forcegate
