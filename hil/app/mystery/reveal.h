#pragma once
// `forcegate reveal`: opens the sealed truth of a mystery, checks its commitment, and scores an answer.

#include <filesystem>
#include <optional>
#include <string>

#include "hil/app/mystery/scoring.h"

namespace forcegate {

struct RevealRequest {
  std::filesystem::path folder;
  std::filesystem::path answer_file;  ///< JSON of diagnose; empty: none
  std::string effect;                 ///< or the name of an effect, "none", "unknown"; empty: none
};

struct RevealResult {
  std::string commitment;
  hidden::Truth truth;
  std::string truth_json;
  std::optional<Answer> answer;
  std::optional<Score> score;
  bool right = false;    ///< the answer names what was hidden (of a pair: both within the first three)
  std::string sentence;  ///< the score in one sentence
};

/// The seal is opened last. Errors: a seal that was changed; an effect or an answer that cannot be read, an answer that names another campaign (usage).
Result<RevealResult> reveal(const RevealRequest& request);

/// What was hidden, for a person: several lines.
std::string truth_text(const hidden::Truth& truth);

}  // namespace forcegate
