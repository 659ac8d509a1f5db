#include "hil/diagnose/choose/screen.h"

#include <algorithm>
#include <cmath>

#include "hil/base/parallel.h"
#include "hil/diagnose/base/left_out.h"

namespace forcegate::diagnose {

namespace {

// A form whose grid missed the right shape loses so much of its evidence to one that is wrong.
constexpr double kComesNear = 0.4;

// Strengths that together go beyond what the effect can physically have, by more than twice their uncertainty. A pole of twice the force
// with half the time constant is a delay in disguise, half a delay of twice the length a pole, and a growth to many times the load a lag.
bool is_beyond_bounds(const ResidualChannel& channel, const MixedFit& fit, const Variant& variant) {
  const Candidate& c = channel.candidates[static_cast<std::size_t>(variant.candidate)];
  const auto n = static_cast<Eigen::Index>(variant.columns.size()), first = fit.coefficient.size() - n;
  // a share of the gain that is fitted beside it, not of the one that the search began with
  constexpr double kLeastGain = 0.05;
  const double fitted = fit.coefficient[0] * channel.gain_of_unit;
  const double gain = std::abs(fitted) > kLeastGain ? fitted : n > 1 ? std::copysign(kLeastGain, fitted) : 1.0;
  const double value = fit.coefficient.tail(n).sum() / gain,
               slack = 2.0 * std::sqrt(std::max(0.0, fit.covariance.block(first, first, n, n).sum())) / std::abs(gain);
  return value > c.form->most + slack || value < c.form->least - slack;
}

bool has_wrong_sign(const ResidualChannel& channel, const VariantScore& score, const Variant& variant) {
  const Candidate& c = channel.candidates[static_cast<std::size_t>(variant.candidate)];
  if (c.form->sign == StrengthSign::either || !channel.signs_known) return false;
  const Eigen::VectorXd coefficient = score.fit.strengths_of(variant.columns);
  // growths of both signs that nearly cancel fit a wander; plays of both signs may be a loop
  const double cancels = c.kind->name == "creep" ? 0.9 : 1.0;
  double up = 0.0, down = 0.0;
  for (std::size_t j = 0; j < variant.columns.size(); ++j) {
    const double size =
        coefficient[static_cast<Eigen::Index>(j)] / channel.problem.column_prior_sd[variant.columns[j]];
    (size > 0.0 ? up : down) += std::abs(size);
  }
  return c.form->sign == StrengthSign::positive ? down > cancels * up : up > cancels * down;
}

}  // namespace

MixedFit fit_to_the_end(const ResidualChannel& channel, const std::vector<int>& present, const MixedFit* warm,
                        int iterations, RecordUse use) {
  constexpr int kRounds = 12;
  constexpr double kStill = 0.02;  // nats
  MixedFit fit = fit_mixed(channel.problem, present, warm, iterations, use);
  for (int round = 0; fit.valid && round < kRounds; ++round) {
    MixedFit next = fit_mixed(channel.problem, present, &fit, iterations, use);
    if (!next.valid) break;
    const double climbed = next.log_evidence - fit.log_evidence;
    fit = std::move(next);
    if (climbed < kStill) break;
  }
  return fit;
}

namespace {
constexpr int kLevels = 2;  // the first components of a record: gain, zero
}

std::vector<const EffectKind*> kinds_of(const ResidualChannel& channel) {
  std::vector<const EffectKind*> out;
  for (const Candidate& c : channel.candidates)
    if (std::find(out.begin(), out.end(), c.kind) == out.end()) out.push_back(c.kind);
  return out;
}

std::vector<std::string> families_but(const ResidualChannel& channel, const std::vector<std::string>& names) {
  std::vector<std::string> out;
  for (const EffectKind* kind : kinds_of(channel))
    if (std::ranges::find(names, kind->name) == names.end()) out.push_back(kind->name);
  return out;
}

double excess_mean_square(const ResidualChannel& channel, const MixedFit& fit) {
  double sum = 0.0, n = 0.0;
  for (std::size_t i = 0; i < fit.adapted.size(); ++i) {
    if (!fit.counts(channel.problem.records[i])) continue;
    sum += std::max(0.0, fit.adapted[i] - channel.problem.records[i].allowed_variance);
    n += 1.0;
  }
  return n > 0.0 ? sum / n : 0.0;
}

double total_fall(const ResidualChannel& channel, const MixedFit& before, const MixedFit& after) {
  double a = 0.0, b = 0.0;
  for (std::size_t i = 0; i < before.adapted.size(); ++i)
    if (before.counts(channel.problem.records[i])) {
      b += before.adapted[i];
      a += after.adapted[i];
    }
  return b > 0.0 ? 1.0 - a / b : 0.0;
}

double effect_rms(const ResidualChannel& channel, const MixedFit& fit, const std::vector<int>& columns) {
  const Eigen::VectorXd c = fit.strengths_of(columns);
  double sum = 0.0;
  for (const RecordGram& record : channel.problem.records) {
    double square = 0.0;
    for (std::size_t a = 0; a < columns.size(); ++a)
      for (std::size_t b = 0; b < columns.size(); ++b)
        square += c[static_cast<Eigen::Index>(a)] * c[static_cast<Eigen::Index>(b)] *
                  record.gram(channel.problem.nz + columns[a], channel.problem.nz + columns[b]);
    sum += std::max(0.0, square);
  }
  return std::sqrt(sum / std::max<double>(1.0, static_cast<double>(channel.problem.records.size())));
}

double effect_rms_between(const ResidualChannel& channel, const MixedFit& fit, const std::vector<int>& columns) {
  const Eigen::VectorXd c = fit.strengths_of(columns);
  std::vector<int> levels;
  for (int z = 0; z < channel.problem.nz; ++z)
    if (channel.problem.component_of_z[static_cast<std::size_t>(z)] < kLevels) levels.push_back(z);
  const auto n = static_cast<Eigen::Index>(levels.size());
  if (n == 0) return effect_rms(channel, fit, columns);
  Eigen::MatrixXd of_levels = Eigen::MatrixXd::Zero(n, n);
  Eigen::VectorXd shared = Eigen::VectorXd::Zero(n);
  for (const RecordGram& record : channel.problem.records) {
    of_levels += record.gram(levels, levels);
    for (std::size_t a = 0; a < columns.size(); ++a) shared += c[static_cast<Eigen::Index>(a)] * record.gram(levels, channel.problem.nz + columns[a]);
  }
  const double common = shared.dot(of_levels.ldlt().solve(shared)) / std::max<double>(1.0, static_cast<double>(channel.problem.records.size()));
  const double whole = effect_rms(channel, fit, columns);
  return std::sqrt(std::max(0.0, whole * whole - common));
}

namespace {

// Records whose gain and zero run far apart leave a spread so wide that what explains it is not seen, and EM stays there: it begins once more
// from a spread to which records usually repeat.
MixedFit from_records_that_repeat(const ResidualChannel& channel, const std::vector<int>& columns, const MixedFit& base, int iterations) {
  constexpr double kFar = 10.0;     // of the usual spread
  MixedFit start = base;
  bool far = false;
  for (int k = 0; k < kLevels; ++k) {
    const double usual = std::pow(channel.problem.components[static_cast<std::size_t>(k)].prior_sd, 2);
    far = far || base.variance[k] > kFar * kFar * usual;
    start.variance[k] = std::min(base.variance[k], usual);
  }
  if (!far) return {};
  return fit_mixed(channel.problem, columns, &start, 2 * iterations, base.use);
}

// Records of which the base leaves far more than of others hardly count beside them: a candidate that explains just these, nearly, is pinned by
// what it leaves of the others, and EM stays there. It begins once more with all records as exact as their instruments.
MixedFit from_equal_weights(const ResidualChannel& channel, const std::vector<int>& columns, const MixedFit& base, int iterations) {
  constexpr double kFar = 10.0;  // RMS beside the noise, of the worst record over that of the best
  const auto& records = channel.problem.records;
  MixedFit start = base;
  double least = 1e300, most = 0.0;
  for (std::size_t i = 0; i < records.size(); ++i) {
    start.s2[i] = std::min(base.s2[i], std::max(records[i].noise_variance, records[i].allowed_variance));
    least = std::min(least, base.s2[i] / start.s2[i]);
    most = std::max(most, base.s2[i] / start.s2[i]);
  }
  if (!(most > kFar * kFar * least)) return {};
  return fit_mixed(channel.problem, columns, &start, 2 * iterations, base.use);
}

enum class Start { base, equal_weights };

VariantScore score_from(const ResidualChannel& channel, const std::vector<int>& present, const MixedFit& base, int index, const MixedFit* warm, int iterations, Start start) {
  const Variant& variant = channel.variants[static_cast<std::size_t>(index)];
  VariantScore score;
  score.variant = index;
  score.gain = -1e300;
  std::vector<int> columns = present;
  for (int j : variant.columns) {
    if (std::find(columns.begin(), columns.end(), j) != columns.end()) return score;
    columns.push_back(j);
  }
  score.fit = fit_mixed(channel.problem, columns, warm != nullptr ? warm : &base, iterations, base.use);
  if (warm == nullptr && moves_levels(candidate_of(channel, index))) {
    MixedFit other = from_records_that_repeat(channel, columns, base, iterations);
    if (other.valid && other.log_evidence > score.fit.log_evidence) score.fit = std::move(other);
  }
  if (start == Start::equal_weights) {
    MixedFit other = from_equal_weights(channel, columns, base, iterations);
    if (other.valid && other.log_evidence > score.fit.log_evidence) score.fit = std::move(other);
  }
  if (!score.fit.valid || is_beyond_bounds(channel, score.fit, variant)) return score;
  score.gain = score.fit.log_evidence - base.log_evidence;
  score.effect_rms = effect_rms(channel, score.fit, variant.columns);
  score.wrong_sign = has_wrong_sign(channel, score, variant);
  if (score.wrong_sign) score.gain *= score.gain > 0.0 ? 0.3 : 1.0;
  const double base_excess = excess_mean_square(channel, base),
               excess = excess_mean_square(channel, score.fit);
  score.fall = base_excess > 0.0 ? 1.0 - excess / base_excess : 0.0;
  score.total_fall = total_fall(channel, base, score.fit);
  return score;
}

}  // namespace

VariantScore score_variant(const ResidualChannel& channel, const std::vector<int>& present,
                           const MixedFit& base, int index, const MixedFit* warm, int iterations) {
  return score_from(channel, present, base, index, warm, iterations, Start::base);
}

ScreenResult screen(const ResidualChannel& channel, const std::vector<int>& present,
                    const std::vector<std::string>& skip, const MixedFit* warm, unsigned threads,
                    int iterations, RecordUse use, Forms forms) {
  ScreenResult out;
  out.base = fit_to_the_end(channel, present, warm, 2 * iterations, use);
  if (!out.base.valid) return out;
  std::vector<VariantScore> scores(channel.variants.size());
  std::vector<char> used(channel.variants.size(), 0);
  const auto is_screened = [&](std::size_t v) { return candidate_of(channel, static_cast<int>(v)).form->competes() && !channel.variants[v].of_levels_alone; };
  const auto score_all = [&](Start start = Start::base) {
    parallel_for(channel.variants.size(), threads, [&](std::size_t v) {
      const Candidate& c = candidate_of(channel, static_cast<int>(v));
      if (!is_screened(v) || (c.form->last && forms == Forms::ordinary) || std::find(skip.begin(), skip.end(), c.kind->name) != skip.end()) return;
      scores[v] = score_from(channel, present, out.base, static_cast<int>(v), nullptr, iterations, start);
      used[v] = scores[v].gain > -1e299 ? 1 : 0;
    });
  };
  const auto best_of = [&] {
    const VariantScore* best = nullptr;
    for (std::size_t v = 0; v < scores.size(); ++v)
      if (used[v] != 0 && (best == nullptr || scores[v].gain > best->gain)) best = &scores[v];
    return best;
  };
  score_all();
  // EM climbs the hill that it stands on. When the spreads that a candidate found serve the base as well, the candidate had
  // no part in what it seemed to gain
  constexpr int kRestarts = 2;
  constexpr double kHigher = 0.5;  // nats
  for (int restart = 0; restart < kRestarts; ++restart) {
    const VariantScore* best = best_of();
    if (best == nullptr || best->gain < kHigher) break;
    MixedFit again = fit_to_the_end(channel, present, &best->fit, 2 * iterations, use);
    if (!again.valid || again.log_evidence < out.base.log_evidence + kHigher) break;
    out.base = std::move(again);
    score_all();
  }
  constexpr double kPlain = 14.0;  // nats: with less nothing is chosen within records
  if (const VariantScore* best = best_of(); best == nullptr || best->gain < kPlain) score_all(Start::equal_weights);
  for (const EffectKind* kind_of_family : kinds_of(channel)) {
    const EffectKind& kind = *kind_of_family;
    FamilyScore family;
    family.kind = &kind;
    double best = -1e300, n = 0.0;
    int at = -1;
    std::map<const EffectForm*, int> of_form;
    for (std::size_t v = 0; v < scores.size(); ++v) {
      const Candidate& c = candidate_of(channel, static_cast<int>(v));
      if (c.kind != &kind || !is_screened(v)) continue;
      n += 1.0;  // one beyond its bounds had a share of the prior as well
      if (used[v] == 0) continue;
      const auto index = static_cast<int>(v);
      const auto [held, first] = of_form.try_emplace(c.form, index);
      if (!first && scores[v].gain > scores[static_cast<std::size_t>(held->second)].gain) held->second = index;
      if (scores[v].gain > best) best = scores[v].gain, at = index;
    }
    if (at < 0) continue;
    double sum = 0.0;
    for (std::size_t v = 0; v < scores.size(); ++v)
      if (used[v] != 0 && candidate_of(channel, static_cast<int>(v)).kind == &kind)
        sum += std::exp(std::max(-700.0, scores[v].gain - best));
    for (const auto& [form, index] : of_form)
      if (index != at && scores[static_cast<std::size_t>(index)].gain > kComesNear * best) family.of_other_forms.push_back(index);
    std::ranges::sort(family.of_other_forms, [&](int a, int b) {
      const double gain_a = scores[static_cast<std::size_t>(a)].gain, gain_b = scores[static_cast<std::size_t>(b)].gain;
      return gain_a != gain_b ? gain_a > gain_b : a < b;
    });
    family.gain = best + std::log(sum / n);
    family.best = std::move(scores[static_cast<std::size_t>(at)]);
    out.families.push_back(std::move(family));
  }
  std::stable_sort(out.families.begin(), out.families.end(),
                   [](const FamilyScore& a, const FamilyScore& b) { return a.gain > b.gain; });
  return out;
}

ScreenResult screen_alone(const ResidualChannel& channel, const std::vector<int>& present, const std::vector<std::string>& others, const MixedFit* warm,
                          unsigned threads) {
  constexpr int kIterations = 9;
  constexpr double kBetter = 0.9;  // mean square
  const auto screened = [&](Forms forms) { return screen(channel, present, others, warm, threads, kIterations, RecordUse::fit_records, forms); };
  ScreenResult ordinary = screened(Forms::ordinary);
  if (std::ranges::none_of(channel.candidates, [&](const Candidate& c) { return c.form->last && std::ranges::find(others, c.kind->name) == others.end(); }))
    return ordinary;
  ScreenResult all = screened(Forms::all);
  if (ordinary.families.empty() || all.families.empty()) return all;
  const auto left_out = [&](const ScreenResult& result) { return cross_fit(channel, result.base, result.families.front().best.fit).after; };
  return left_out(all) < kBetter * left_out(ordinary) ? all : ordinary;
}

}  // namespace forcegate::diagnose
