#pragma once
// `forcegate bench faults`: every fault of rig, reference, sensor, link and board against a good and a bad build. A fault
// must neither reject the good build nor accept the bad one, and the party that has to act must be named.

#include <string>
#include <vector>

#include "hil/app/gate/gate.h"

namespace forcegate {

/// One fault to inject and who may be blamed for it.
struct FaultScenario {
  std::string name;  ///< "reference_offset"
  double magnitude = 0.0;
  std::string in_words;
  std::vector<Blame>
      culprits;  ///< first: the party itself; others: what cannot be told from it without more means
  /// Large enough to be seen: there must be no decision. A small one may go unseen when it cannot tip a verdict.
  bool clear = true;
};

const std::vector<FaultScenario>& fault_scenarios();

struct FaultMatrixRequest {
  std::filesystem::path good;
  std::filesystem::path bad;  ///< empty: none
  std::vector<std::filesystem::path>
      runaway;  ///< builds that drive the closed loop to a limit: must be REJECT
  std::string plan = "faults";
  std::vector<std::string> only;  ///< names of faults; empty = all
  unsigned threads = 0;
};

struct FaultRow {
  FaultScenario scenario;
  Decision good, bad;  ///< bad: kind no_decision, exit 6 when there is no bad build
  bool with_bad = false;
  std::string wrong;  ///< what is wrong with the row; "" = nothing
};

struct FaultMatrix {
  std::vector<FaultRow> rows;
  struct Runaway {
    std::string build;
    Decision decision;
    std::string wrong;
  };
  std::vector<Runaway> runaway;
  std::size_t wrong() const;
};

Result<FaultMatrix> fault_matrix(const FaultMatrixRequest& request, const GateProgress& progress = {},
                                 const std::atomic<bool>* cancelled = nullptr);
std::string fault_matrix_text(const FaultMatrix& matrix);
std::string fault_matrix_json(const FaultMatrix& matrix);

}  // namespace forcegate
