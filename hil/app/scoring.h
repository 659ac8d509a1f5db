#pragma once
// An answer of `forcegate diagnose --json` (or of a person) against the truth sheet of a campaign, and the
// arithmetic of the tables made from many of them.

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "hil/base/result.h"
#include "rigs/emulated/hidden/truth.h"

namespace forcegate {

struct AnswerFinding {
  std::string effect, side;
  double probability = 1.0;
  std::vector<std::string> confounded_with;
};

/// One row of the engine's screening, where it tells it.
struct AnswerRank {
  std::string effect;
  double score = 0.0;
};

/// What a scorer reads of an answer; docs/campaign.md describes the whole.
struct Answer {
  std::string verdict;                  ///< "none", "known", "unknown"
  std::vector<AnswerFinding> findings;  ///< best first
  std::vector<std::string> depends_on;
  std::optional<double> error_before, error_after;              ///< V, over the held-out records
  std::optional<double> force_error_before, force_error_after;  ///< N, when the rig side is at fault
  std::string reason;                                           ///< free text of the engine, may be empty
  std::vector<AnswerRank> ranking;                              ///< best first
  std::map<std::string, std::string> refused;  ///< effect that came up and was not taken, reason
};

/// Errors name the missing or mistyped key.
Result<Answer> answer_from_json(const std::string& text);

/// The answer of a person who names one effect, "none" or "unknown".
Answer answer_of(const std::string& effect);

/// A finding of probability 0.5 or more is a claim.
inline constexpr double kClaim = 0.5;

struct Score {
  int rank = 0;        ///< place of the first true effect among the findings; 0 = not listed
  bool named = false;  ///< verdict "known" and the first finding is true
  bool top2 = false, top3 = false;
  bool look_alike = false;     ///< not named, but the first finding admits a true one as inseparable from it
  bool pair_in_three = false;  ///< of two true effects, both among the first three findings
  bool side_right = false;     ///< of the first true finding
  bool honest = false;         ///< foreign: the verdict is "unknown" and no catalogue effect is claimed
  bool clean = false;          ///< nothing hidden: the verdict is "none" and there is no claim
  bool sensor_blamed = false;  ///< the fault is elsewhere and an absent sensor effect is claimed
  int false_claims = 0;        ///< claims of effects that are not there
  std::optional<double> removed;  ///< share of the reducible held-out error that the answer removes
};

/// The reducible part is what the hidden effect adds: best = sqrt(max(0, before^2 - effect^2)),
/// removed = (before - after) / (before - best), clipped to [-1, 1]; only where a model can predict the
/// effect and it makes up at least a tenth of the error.
Score score(const hidden::Truth& truth, const Answer& answer);

struct Interval {
  double low = 0.0, high = 1.0;
};

/// Wilson score interval of k successes in n trials, 95 %. n = 0: [0, 1].
Interval wilson_95(std::size_t k, std::size_t n);

/// Value below which a share p of the values lies, linear between order statistics; NaN when there are none.
double score_quantile(std::vector<double> values, double p);

}  // namespace forcegate
