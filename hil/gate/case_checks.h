#pragma once
// The checks of one record as they are entered: what the rig or a gap spoils carries no judgement.

#include <string>
#include <utility>
#include <vector>

#include "hil/gate/rule.h"

namespace forcegate {

class CaseChecks {
 public:
  explicit CaseChecks(std::string case_id) : case_id_(std::move(case_id)) {}

  /// Verdict and blame as given.
  Check& final_check(std::string id, std::string title, Verdict verdict, Blame blame, std::string evidence);

  /// A value against a limit; when the record cannot carry a judgement the verdict says why instead. Without a limit it is not required.
  Check& value_check(std::string id, std::string title, double value, std::string unit, double u,
                     std::uint64_t n, Limit limit, std::string evidence);

  /// A check that was judged elsewhere.
  void keep(Check check);

  /// The first cause is the one to name: later findings follow from it.
  void unsound(Blame blame);

  /// Of the last check: what the firmware did wrong in a part of a record on a sound rig stays wrong.
  void judge_even_if_incomplete();

  /// The last check is one that another session makes surer, but for this part of its u.
  void repeatable(double u_systematic);

  /// Of the last check: the part of its value that a calibration which does not fit may be.
  void explained_by_calibration(double part) { list.back().explained = part; }

  std::vector<JudgedCheck> list;
  bool rig_sound = true, complete = true;
  Blame rig_blame = Blame::none, incomplete_blame = Blame::none;  ///< who spoiled it, who cut it short

 private:
  std::string case_id_;
};

}  // namespace forcegate
