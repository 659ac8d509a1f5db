#pragma once
// Least squares of one law for all records: linear in gain, offset and the strengths of effects, Newton in log b and log q on what the linear part
// leaves (variable projection, Golub and Pereyra 1973). Every record weighs the same.

#include <Eigen/Dense>
#include <cstddef>
#include <vector>

#include "hil/base/result.h"
#include "hil/model/base_law.h"
#include "hil/model/effect.h"

namespace forcegate::diagnose {

/// A form of an effect at a shape.
struct FormAtShape {
  const EffectKind* kind = nullptr;
  const EffectForm* form = nullptr;
  std::vector<double> shape;
};

/// Sums of the rows of one record, each divided by their number. Columns: gain, offset, strengths of the effects in their order; y is U, V.
struct LawGram {
  Eigen::MatrixXd XX;
  Eigen::VectorXd Xy;
  double yy = 0.0;
};

class LawFitter {
 public:
  explicit LawFitter(CampaignInput input) : input_(std::move(input)) {}

  CampaignInput& input() { return input_; }

  /// Per record. Errors (parse): most of the output is not above 0.
  Result<std::vector<LawGram>> grams(const BaseLaw& law, const std::vector<FormAtShape>& effects);

  /// b and q by a quadratic through points around the present ones; the step shrinks when it does not help.
  Result<BaseLaw> refine(BaseLaw law, const std::vector<FormAtShape>& effects, int rounds = 6);

  /// Standard errors of log b and log q by the jackknife over records, of each of which one Newton step tells where the others would lead; 0 where
  /// the law does not decay.
  Result<Eigen::Vector2d> jackknife_of_decay(const BaseLaw& law, const std::vector<FormAtShape>& effects);

  /// Least squares without one record (all: grams.size()); columns that these records do not excite stay at zero.
  static Eigen::VectorXd solve(const std::vector<LawGram>& grams, std::size_t left_out);
  /// Mean square of a record at these coefficients, V^2.
  static double square_error(const LawGram& gram, const Eigen::VectorXd& beta);
  /// RMS over the records, all fitted together; each predicted from the others; V.
  static double error(const std::vector<LawGram>& grams);
  static double left_out(const std::vector<LawGram>& grams);

 private:
  Result<LawGram> gram(RecordInput& record, const BaseLaw& law, const std::vector<FormAtShape>& effects) const;

  CampaignInput input_;
};

}  // namespace forcegate::diagnose
