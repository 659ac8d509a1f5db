#pragma once
// S8: the odds between two rivals that a further record would leave, by the rule that makes probabilities of evidence.
//
//   y        what the leading rival says of the record, less the base law (a gain and a zero of the record's own)
//   Q        least of  n (y - X (c + d))^2 / s^2 + d' P d  over d:  the other rival is refitted. c, P: its strengths and shape as the records so far
//            have them, and how well they know them; s: what the model leaves; n: samples that the record counts for (mean square over its rows)
//   evidence + n/2 ln(1 + Q/n) for the leader over the other, + n/2 ln(1 + y^2/s^2) for the leader over the base law: s is estimated from the records
//   odds       exp(evidence between them / nats_of_a_factor(evidence of the leader))          (rival_odds.h)
//
// Another machine's rivals share their place evenly as long as their answers differ by less than a form is known to.

#include <optional>
#include <string>
#include <vector>

#include "hil/diagnose/choose/screen.h"
#include "hil/diagnose/next/rival_odds.h"

namespace forcegate::diagnose {

/// One form of a rival at one shape, as the records so far have it.
struct Hypothesis {
  const EffectForm* form = nullptr;
  std::vector<double> shape;
  Eigen::VectorXd strength;         ///< N a unit of the form's columns
  std::vector<std::size_t> moves;   ///< shapes that may follow new records
  Eigen::MatrixXd precision;        ///< of the strengths and of the logarithms of those shapes
  double behind = 0.0;              ///< evidence that it lacks beside the rival's best, nats
};

struct Rival {
  const EffectKind* kind = nullptr;
  std::vector<Hypothesis> forms;  ///< the best first
  double fall = 0.0;              ///< share of the excess that the best takes away
  double left_N = 0.0;            ///< RMS that it leaves
};

/// The effects of that name, their shapes refined; those that the records cannot show are left out.
std::vector<Rival> rivals_of(const Workspace& workspace, const std::vector<std::string>& effects);

/// What one form of a rival makes of another's answers to some records: sums that add up.
struct Imitation {
  double samples = 0.0, size = 0.0;  ///< n; n y^2/s^2
  struct OfForm {
    Eigen::MatrixXd gram;
    Eigen::VectorXd slope;
    double apart = 0.0;  ///< n (y - X c)^2 / s^2
  };
  std::vector<OfForm> forms;
  void add(const Imitation& more);
};

/// `noise_N`: RMS that the instruments leave.
Imitation imitate(const Workspace& workspace, const RecordInput& record, const Rival& leader, const Rival& other, double noise_N);

struct Expected {
  double log_odds = 0.0;  ///< natural, of the leader against the other; the present ones where nothing was played
  double likeness = 1.0;  ///< cosine of the leader's answer and the nearest that the other has
};
/// `now`: of the leader, not below 0. Nothing played: `played` is as default.
Expected expected_odds(const Workspace& workspace, const Diagnosis& diagnosis, const RivalOdds& now, const Rival& leader, const Rival& other,
                       const Imitation& played);

}  // namespace forcegate::diagnose
