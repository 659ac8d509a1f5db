#pragma once
// The words of the scenarios: a bench in some state, a build that is gated on it, and what the lab then sees.

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/support/process.h"

namespace forcegate::test {

struct Outcome {
  int exit_code = -1;
  std::string decision, reason, blame, text;
  bool safety_stop = false;
};

class Bench {
 public:
  /// "reference_offset=0.3"; faults of the emulated bench by name.
  void is_given(const std::string& fault) { arguments_.insert(arguments_.end(), {"--fault", fault}); }
  void calibrates_to_level(const std::string& level) {
    arguments_.insert(arguments_.end(), {"--calibration", level});
  }
  void plays_only(const std::string& case_name) {
    arguments_.insert(arguments_.end(), {"--case", case_name});
  }

  /// `build`: name below build/firmware, or a path.
  Outcome gates(const std::string& build) const {
    const TemporaryFolder folder;
    const std::string image = build.starts_with('/') ? build : FORCEGATE_BINARY_DIR "/firmware/" + build;
    std::vector<std::string> line = {"gate", image, "-o", folder / "run"};
    line.insert(line.end(), arguments_.begin(), arguments_.end());
    const ProcessResult r = forcegate(line, {.folder = FORCEGATE_SOURCE_DIR});
    Outcome outcome;
    outcome.exit_code = r.exit_code;
    outcome.text = r.out + r.err;
    const auto result = nlohmann::json::parse(read_text(folder / "run/result.json"), nullptr, false);
    if (!result.is_discarded()) {
      const auto& decision = result["decision"];
      outcome.decision = decision.value("kind", "");
      outcome.reason = decision.value("reason", "");
      outcome.blame = decision.value("blame", "");
      outcome.safety_stop = decision.value("safety_stop", false);
    }
    return outcome;
  }

 private:
  std::vector<std::string> arguments_;
};

}  // namespace forcegate::test
