#pragma once
// `forcegate explain`: what a word of a report or an exit code means, and what to do about it.

#include <string>
#include <string_view>
#include <vector>

namespace forcegate {

struct Explanation {
  std::string term;  ///< "marginal", "NO-DECISION", "4"
  std::string kind;  ///< "verdict", "decision", "who must act", "exit code", "diagnosis"
  std::string meaning;
  std::string what_to_do;
};

/// Sorted by kind as a report mentions them.
const std::vector<Explanation>& explanations();

/// Every meaning of a word, case-insensitive: "none" is said of a diagnosis and of who must act. Empty when there is none.
std::vector<Explanation> find_explanations(std::string_view term);

}  // namespace forcegate
