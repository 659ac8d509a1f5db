#pragma once
// An answer of `forcegate diagnose --json` (or of a person) against the truth sheet of a campaign, and the
// arithmetic of the tables made from many of them.

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "hil/base/result.h"
#include "hil/diagnose/base_errors.h"
#include "rigs/emulated/hidden/truth.h"

namespace forcegate {

struct AnswerFinding {
  std::string effect, side;
  double probability = 1.0;
  std::vector<std::string> confounded_with;

  bool claimed() const;  ///< at even odds or better
};

/// One row of the engine's screening, where it tells it.
struct AnswerRank {
  std::string effect;
  double score = 0.0;
};

/// What a scorer reads of an answer; docs/campaign.md describes the whole.
struct Answer {
  std::string campaign;                 ///< that was diagnosed; empty: not told
  std::string verdict;                  ///< "none", "known", "unknown"
  std::vector<AnswerFinding> findings;  ///< best first
  std::vector<std::string> depends_on;
  std::optional<double> error_before, error_after;              ///< V, over the held-out records
  std::optional<double> force_error_before, force_error_after;  ///< N, when the rig side is at fault
  bool common_levels = false, force_common_levels = false;  ///< these errors keep the gain and zero of all records
  std::string reason;                                           ///< free text of the engine, may be empty
  std::vector<AnswerRank> ranking;                              ///< best first
  std::map<std::string, std::string> refused;  ///< effect that came up and was not taken, reason
};

/// Errors (parse) name the missing or mistyped key, with how such an answer is made.
Result<Answer> answer_from_json(const std::string& text);

/// The answer of a person who names one effect, "none" or "unknown".
Answer answer_of(const std::string& effect);

/// Held-out errors of the engine's starting model, without any effect: on the campaign, and on its twin, which has the same
/// records and random numbers and nothing hidden. The second is what the best model of the hidden effect would leave.
struct TwinErrors {
  diagnose::BaseErrors campaign, twin;
};

/// How much of what the hidden effect adds to the held-out error an answer takes away.
struct Reduction {
  std::string unit = "V";
  double before = 0.0, after = 0.0, twin = 0.0;

  /// (before - after) / (before - twin), clipped to [-1, 1]: 1 where the error falls to that of the twin.
  double share() const;
};

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
  std::optional<Reduction> reduction;  ///< where something was reducible
};

/// Of the catalogue and hidden; nullptr: it is not.
const hidden::TruthEffect* true_effect(const hidden::Truth& truth, const std::string& name);

/// A reduction is counted where one effect is hidden that a model can predict and the error is at least a tenth above the twin's:
/// else the effect is lost in the noise, or gain, zero and decay of the single records absorb it. Of the rig it is that of the force, of
/// the reference that of the force where it is told, else of the output. An answer that does not name the effect first
/// takes nothing away, of the error at the gain and zero of all records where the effect acts between them. Without `twin` none is
/// counted.
Score score(const hidden::Truth& truth, const Answer& answer, const TwinErrors* twin = nullptr);

struct Interval {
  double low = 0.0, high = 1.0;
};

/// Wilson score interval of k successes in n trials, 95 %. n = 0: [0, 1].
Interval wilson_95(std::size_t k, std::size_t n);

/// Value below which a share p of the values lies, linear between order statistics; NaN when there are none.
double score_quantile(std::vector<double> values, double p);

}  // namespace forcegate
