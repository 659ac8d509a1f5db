#include "hil/diagnose/between/record_questions.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "hil/diagnose/between/mounting_places.h"
#include "hil/model/lagged_channel.h"

namespace forcegate::diagnose {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Sizes (RMS over the records) that an effect may have: shares of the gain, and of the span for a zero.
const std::vector<double> kGainSizes = {0.003, 0.01, 0.03, 0.1}, kZeroSizes = {0.001, 0.003, 0.01, 0.03};

bool moves_gain(const ResidualChannel& channel, const RecordLevels& levels, const std::vector<int>& columns) {
  double gain = 0.0, zero = 0.0;
  for (std::size_t i = 0; i < channel.problem.records.size(); ++i)
    for (const int j : columns) {
      const auto row = static_cast<Index>(i);
      gain += std::pow(levels.gain_of_column(row, j), 2) * channel.problem.records[i].gram(0, 0);
      zero += std::pow(levels.zero_of_column(row, j), 2);
    }
  return gain >= zero;
}

// Waves of the campaign's time: the slower, the larger. How much so is not known.
std::vector<VectorXd> priors_of(const Candidate& candidate, std::size_t columns) {
  const auto k = static_cast<Index>(columns);
  if (columns == 1) return {VectorXd::Ones(1)};
  if (candidate.form->name != kUnrecorded && !candidate.form->bank) return {VectorXd::Ones(k)};
  std::vector<VectorXd> out;
  for (const double power : {2.0, 4.0}) {
    VectorXd weight(k);
    for (Index j = 0; j < k; ++j) weight[j] = std::pow(static_cast<double>(j + 1), -power);
    out.push_back(weight);
  }
  return out;
}

// One column for each group of records, the first included: which one is the first must not matter.
RecordPredictor of_groups(const MatrixXd& map, const std::vector<int>& columns) {
  const auto groups = static_cast<Index>(columns.size()) + 1;
  MatrixXd member = MatrixXd::Zero(map.rows(), groups);
  for (Index i = 0; i < map.rows(); ++i) {
    Index group = 0;
    double most = 0.0;
    for (Index j = 1; j < groups; ++j)
      if (const double of = std::abs(map(i, columns[static_cast<std::size_t>(j - 1)])); of > most) most = of, group = j;
    member(i, group) = 1.0;
  }
  return {member, VectorXd::Ones(groups), false};
}

// As many steps as few: each number has the same share of the prior, however many places there are for it.
void weigh_numbers_of_steps(std::vector<Asked>& asked) {
  std::vector<double> of_number;
  const auto number = [](const Asked& a) { return std::max<std::size_t>(1, a.places.size()); };
  for (const Asked& a : asked) {
    of_number.resize(std::max(of_number.size(), number(a) + 1));
    of_number[number(a)] += 1.0;
  }
  const auto numbers = static_cast<double>(std::ranges::count_if(of_number, [](double n) { return n > 0.0; }));
  for (Asked& a : asked) {
    a.predictor.alone = true;
    a.log_weight = std::log(static_cast<double>(asked.size()) / (numbers * of_number[number(a)]));
  }
}

}  // namespace

FamilyQuestion ask(const ResidualChannel& channel, const RecordLevels& levels, const EffectKind& kind) {
  FamilyQuestion out;
  const auto put = [&](bool gain, Asked asked) {
    if (normalise(asked.predictor) > 0.0) (gain ? out.gain : out.zero).push_back(std::move(asked));
  };
  for (std::size_t v = 0; v < channel.variants.size(); ++v) {
    const Variant& variant = channel.variants[v];
    const Candidate& candidate = channel.candidates[static_cast<std::size_t>(variant.candidate)];
    // both columns of a form at once are asked by its single columns together
    if (candidate.kind != &kind || !moves_levels(candidate) || candidate.form->whole || (candidate.form->singles && variant.columns.size() > 1)) continue;
    const int steps = unknown_steps(candidate);
    out.seeks_places = out.seeks_places || steps > 0;
    if (steps > 1) {
      for (const std::vector<int>& places : places_of_mountings(levels.gain.value.size(), steps))
        for (const bool gain : {true, false}) put(gain, {static_cast<int>(v), predictor_of_places(levels.gain.value.size(), places), 0.0, places});
      continue;
    }
    const bool gain = moves_gain(channel, levels, variant.columns);
    const MatrixXd& map = gain ? levels.gain_of_column : levels.zero_of_column;
    if (candidate.form->groups) {
      put(gain, {static_cast<int>(v), of_groups(map, variant.columns)});
      continue;
    }
    for (const VectorXd& weight : priors_of(candidate, variant.columns.size())) {
      RecordPredictor p{MatrixXd(map.rows(), weight.size()), weight, false};
      for (Index j = 0; j < weight.size(); ++j) p.column.col(j) = map.col(variant.columns[static_cast<std::size_t>(j)]);
      p.positive = weight.size() == 1 && candidate.form->sign == StrengthSign::positive;
      put(gain, {static_cast<int>(v), std::move(p)});
    }
  }
  if (out.seeks_places)
    for (std::vector<Asked>* part : {&out.gain, &out.zero}) weigh_numbers_of_steps(*part);
  return out;
}

std::vector<RecordPredictor> predictors_of(const std::vector<Asked>& asked) {
  std::vector<RecordPredictor> out;
  for (const Asked& a : asked) out.push_back(a.predictor);
  return out;
}

std::vector<RecordScore> scores_of(const RecordLevels& levels, const FamilyQuestion& question, bool of_gain) {
  RecordSeries series = of_gain ? levels.gain : levels.zero;
  if (question.seeks_places) series.start_s = levels.start_s;
  return score_predictors(series, predictors_of(question.part(of_gain)), of_gain ? kGainSizes : kZeroSizes);
}

}  // namespace forcegate::diagnose
