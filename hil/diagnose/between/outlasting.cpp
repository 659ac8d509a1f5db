#include "hil/diagnose/between/outlasting.h"

#include <cmath>

#include "hil/diagnose/base/mixed_model.h"
#include "hil/diagnose/base/some_columns.h"
#include "hil/model/model.h"

namespace forcegate::diagnose {

namespace {

using Eigen::VectorXd;

// Of the last column of `columns`, the gain and zero of every record free.
Estimate told_by_rows(const ResidualChannel& channel, const std::vector<int>& columns, const MixedFit& warm) {
  constexpr double kFree = 1.0, kFirmly = 1e6;  // shares of the span; records that would have to say otherwise
  MixedProblem problem = with_columns(channel.problem, columns);
  for (std::size_t j = 0; j < 2; ++j) {
    VarianceComponent& level = problem.components[static_cast<std::size_t>(problem.component_of_z[j])];
    level.start_sd = level.prior_sd = kFree;
    level.prior_weight = kFirmly;
  }
  std::vector<int> all;
  for (int j = 0; j < problem.ns; ++j) all.push_back(j);
  MixedFit start = warm;
  for (std::size_t j = 0; j < 2; ++j) start.variance[problem.component_of_z[j]] = kFree * kFree;
  start.columns = all;
  const MixedFit fit = fit_mixed(problem, all, &start, 6, warm.use);
  if (!fit.valid) return {};
  return {fit.strength_of(all.back()), fit.standard_error_of(all.back())};
}

double told_by_levels(const RecordScore& score, const VectorXd& column) {
  const VectorXd x = column.array() - column.mean();
  return x.squaredNorm() > 0.0 ? score.added.dot(x) / x.squaredNorm() : 0.0;
}

}  // namespace

void prefer_what_both_tell(const ResidualChannel& channel, const RecordLevels& levels, const FamilyQuestion& asked, const std::vector<int>& present, const MixedFit& base,
                           const SelectionRules& rules, FamilyScore& family) {
  constexpr double kNearly = 0.8, kTwice = 2.0, kPlainly = 3.0;  // of the best form's evidence; of each other; standard errors
  double best = -1e300;
  for (const bool of_gain : {true, false}) {
    const std::vector<Asked>& part = asked.part(of_gain);
    const std::vector<RecordScore> scores = scores_of(levels, asked, of_gain);
    for (std::size_t a = 0; a < scores.size(); ++a) {
      const RecordScore& of_levels = scores[a];
      const std::vector<int>& own = columns_of(channel, part[a].variant);
      if (own.size() != 1 || !candidate_of(channel, part[a].variant).form->outlasts || !(of_levels.gain > 0.0)) continue;
      if (of_levels.explained < rules.between_fall || of_levels.left_out > rules.between_left_out) continue;
      VariantScore of_rows = score_variant(channel, present, base, part[a].variant, nullptr);
      if (of_rows.wrong_sign || !of_rows.fit.valid || of_rows.gain < std::max(rules.first_gain, kNearly * family.best.gain)) continue;
      const Estimate rows = told_by_rows(channel, of_rows.fit.columns, of_rows.fit);
      const double by_levels = told_by_levels(of_levels, (of_gain ? levels.gain_of_column : levels.zero_of_column).col(own.front()));
      const double ratio = by_levels / rows.value;
      if (!(std::abs(rows.value) > kPlainly * rows.se) || !(ratio > 1.0 / kTwice && ratio < kTwice)) continue;
      if (of_rows.gain + of_levels.gain <= best) continue;
      best = of_rows.gain + of_levels.gain;
      family.best = std::move(of_rows);
      family.records = {.valid = true, .variant = part[a].variant, .gain = of_levels.gain, .explained = of_levels.explained, .left_out = of_levels.left_out, .same_strength = true};
    }
  }
}

}  // namespace forcegate::diagnose
