#pragma once
// `forcegate check`: the decision of a stored run once more, from what the run measured.

#include "hil/app/gate/bundle.h"
#include "hil/app/gate/gate.h"

namespace forcegate {

struct CheckRequest {
  std::filesystem::path run;     ///< folder with bundle.json
  std::filesystem::path limits;  ///< other derived limits; empty = those of the run
  std::filesystem::path plan;  ///< another plan's rule and limits for the same cases; empty = that of the run
  std::string today;           ///< another day against which the run's waivers expire; "" = that of the run
  bool replay = false;         ///< play emulated records again from their recipe and compare the digests
  unsigned threads = 0;
};

struct CheckAnswer {
  std::string bundle_id;
  RunResult result;           ///< judged now
  Decision stored;            ///< of result.json
  bool same_bytes = false;    ///< the whole result.json, byte for byte
  bool other_limits = false;  ///< judged under --limits or --plan
  std::size_t records = 0;
  std::size_t measured_again = 0;        ///< records whose facts were measured again from their samples
  std::size_t played_again = 0;          ///< records whose digest was reproduced by the rig
  std::vector<std::string> not_repeated;  ///< records that the firmware gives otherwise from play to play
  std::vector<std::string> differences;   ///< what did not come out the same
};

/// Errors: those of read_bundle, of the limits file or plan; usage when a plan lacks one of the run's cases, or plays
/// another profile in it. What the plan asks for and the run has not is a required check that was not run.
Result<CheckAnswer> check_run(const CheckRequest& request, const GateProgress& progress = {},
                              const std::atomic<bool>* cancelled = nullptr);

std::string check_text(const CheckAnswer& answer);
std::string check_json(const CheckAnswer& answer);

}  // namespace forcegate
