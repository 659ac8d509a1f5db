#pragma once
// One judged quantity, and the decision over all of them (docs/gate.md, 4 and 5).

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace forcegate {

enum class Verdict { pass, marginal, fail, inconclusive, rig_error, not_run, waived };
enum class DecisionKind { accept, reject, no_decision };
/// Who must act. `none` goes with ACCEPT.
enum class Blame { none, firmware, sensor, rig, reference, link, calibration, user, harness, recording };

// The words of files and reports; empty for a value that the enumeration does not have.
std::string_view to_string(Verdict v);       ///< "pass" ... "waived"
std::string_view to_string(DecisionKind d);  ///< "ACCEPT", "REJECT", "NO-DECISION"
std::string_view to_string(Blame b);

/// Every word of an enumeration that counts from 0 and whose to_string is empty beyond its last value, in its order.
template <class E>
std::vector<std::string_view> words_of() {
  std::vector<std::string_view> out;
  for (std::string_view word; !(word = to_string(static_cast<E>(out.size()))).empty();) out.push_back(word);
  return out;
}

/// Limits are inclusive: value == limit passes.
struct Limit {
  enum class Kind { none, upper, lower, equal } kind = Kind::none;
  double value = 0.0;
  std::string source;  ///< "Lebosse 2011, IV-B2", "derived: p99 of n=300, 2026-11-21, rig emulated/1"
};
std::string_view to_string(Limit::Kind k);  ///< "none" ... "equal"

struct Check {
  std::string id;           ///< "mre_maxima", unique within its case
  std::string case_id;      ///< "" for a check of the whole run
  std::string title;        ///< "Mean relative error of the maxima, ATI against set-point"
  double value = 0.0;       ///< NaN when it could not be measured
  std::string unit;         ///< "%", "N", "LSB", "1"
  double u = 0.0;           ///< standard uncertainty, k = 1; 0 = exact count
  double expanded_u = 0.0;  ///< U = k u that the rule used; 0 = none was needed
  std::uint64_t n = 0;      ///< independent items behind the value (cycles, specimens)
  Limit limit;
  Verdict verdict = Verdict::not_run;
  Blame blame = Blame::none;
  bool required = true;
  std::string evidence;  ///< one sentence for a person
  double u_against_derived = 0.0;  ///< of u, what does not cancel against a limit that was derived on the same rig; not stored
};

struct Decision {
  DecisionKind kind = DecisionKind::no_decision;
  Blame blame = Blame::harness;
  std::string reason = "nothing was judged";  ///< one sentence, first line of every report
  bool safety_stop = false;
  int exit_code = 6;
};

}  // namespace forcegate
