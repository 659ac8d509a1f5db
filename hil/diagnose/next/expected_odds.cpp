#include "hil/diagnose/next/expected_odds.h"

#include <algorithm>
#include <cmath>

#include "hil/diagnose/candidates/signatures.h"
#include "hil/diagnose/choose/refine.h"
#include "hil/diagnose/choose/shares.h"

namespace forcegate::diagnose {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// Newtons of a candidate's column at an entry of 1 in y.
double newtons_of(const ResidualChannel& channel) { return 1.0 / std::max(1e-12, std::abs(channel.column_factor)); }

MatrixXd columns_at(const Workspace& w, const RecordInput& r, const Hypothesis& h, const std::vector<double>& shape) {
  MatrixXd out = MatrixXd::Zero(static_cast<Eigen::Index>(r.rows()), h.strength.size());
  h.form->columns(w.input, r, shape, out);
  return out;
}

// How well the records hold the logarithm of one shape, from what moving it costs them (everything else refitted).
double precision_of_shape(const CampaignInput& input, ResidualChannel& channel, const MixedFit& base, const VariantScore& best, std::size_t k) {
  constexpr double kStep = 0.05;
  Candidate& c = channel.candidates[static_cast<std::size_t>(channel.variants[static_cast<std::size_t>(best.variant)].candidate)];
  const std::vector<double> shape = c.shape;
  double costs = 0.0;
  for (const double step : {-kStep, kStep}) {
    c.shape[k] = shape[k] * std::exp(step);
    fill_candidate(input, channel, c, 1);
    costs += std::max(0.0, best.gain - score_variant(channel, {}, base, best.variant, &best.fit).gain);
    c.shape = shape;
  }
  fill_candidate(input, channel, c, 1);
  return costs / (kStep * kStep);  // gain = best - precision step^2 / 2, at two places
}

Hypothesis hypothesis_of(const CampaignInput& input, ResidualChannel& channel, const MixedFit& base, const VariantScore& score, bool shapes_move) {
  const Variant variant = channel.variants[static_cast<std::size_t>(score.variant)];
  const Candidate c = channel.candidates[static_cast<std::size_t>(variant.candidate)];
  Hypothesis out{c.form, c.shape, VectorXd::Zero(c.count), {}, {}, 0.0};
  const auto n = static_cast<Eigen::Index>(variant.columns.size()), first = score.fit.coefficient.size() - n;
  for (const int column : variant.columns) out.strength[column - c.first] = score.fit.strength_of(column);
  for (std::size_t k = 0; shapes_move && k < c.shape.size(); ++k)
    if (!c.form->shape[k].choice && c.shape[k] != 0.0) out.moves.push_back(k);
  const auto moved = static_cast<Eigen::Index>(out.moves.size());
  // a column that the variant does not have stays out of it
  constexpr double kHeld = 1e12;
  out.precision = kHeld * MatrixXd::Identity(c.count + moved, c.count + moved);
  MatrixXd covariance = score.fit.covariance.block(first, first, n, n);
  covariance.diagonal().array() += 1e-12 * (1e-30 + covariance.trace());
  const MatrixXd known = covariance.ldlt().solve(MatrixXd::Identity(n, n));
  for (Eigen::Index a = 0; a < n; ++a)
    for (Eigen::Index b = 0; b < n; ++b)
      out.precision(variant.columns[static_cast<std::size_t>(a)] - c.first, variant.columns[static_cast<std::size_t>(b)] - c.first) = known(a, b);
  for (Eigen::Index k = 0; k < moved; ++k)
    out.precision(c.count + k, c.count + k) = precision_of_shape(input, channel, base, score, out.moves[static_cast<std::size_t>(k)]);
  return out;
}

// Over the records that were fitted, in newtons.
double left_by(const ResidualChannel& channel, const MixedFit& fit) {
  double sum = 0.0, n = 0.0;
  for (std::size_t i = 0; i < fit.adapted.size(); ++i)
    if (fit.counts(channel.problem.records[i])) sum += fit.adapted[i], n += 1.0;
  return newtons_of(channel) * std::sqrt(sum / std::max(1.0, n));
}

}  // namespace

std::vector<Rival> rivals_of(const Workspace& w, const std::vector<std::string>& effects) {
  ResidualChannel channel = w.output;  // shapes are tried in its spare columns
  ScreenResult screened = screen(channel, {}, families_but(channel, effects), nullptr, 1);
  std::vector<Rival> out;
  for (const std::string& name : effects)
    for (FamilyScore& family : screened.families) {
      if (family.kind->name != name) continue;
      const std::vector<int> others = family.of_other_forms;
      const bool refined = !family.kind->traits.between_records && refine_family(w.input, channel, {}, screened.base, family, 1);
      Rival rival{family.kind, {}, family.best.fall, left_by(channel, family.best.fit)};
      rival.forms.push_back(hypothesis_of(w.input, channel, screened.base, family.best, refined));
      for (const int other : others) {
        const VariantScore score = score_variant(channel, {}, screened.base, other, nullptr);
        if (!score.fit.valid || score.gain < -1e299) continue;
        rival.forms.push_back(hypothesis_of(w.input, channel, screened.base, score, false));
        rival.forms.back().behind = std::max(0.0, family.best.gain - score.gain);
      }
      out.push_back(std::move(rival));
    }
  return out;
}

void Imitation::add(const Imitation& more) {
  samples += more.samples;
  size += more.size;
  if (forms.empty()) {
    forms = more.forms;
    return;
  }
  for (std::size_t k = 0; k < forms.size(); ++k) {
    forms[k].gram += more.forms[k].gram;
    forms[k].slope += more.forms[k].slope;
    forms[k].apart += more.forms[k].apart;
  }
}

Imitation imitate(const Workspace& w, const RecordInput& r, const Rival& leader, const Rival& other, double noise_N) {
  MatrixXd law(static_cast<Eigen::Index>(r.rows()), 2);
  for (Eigen::Index i = 0; i < law.rows(); ++i) law.row(i) << r.base_force_N(static_cast<std::size_t>(i)), 1.0;
  MatrixXd normal = law.transpose() * law;
  normal.diagonal().array() += 1e-9 * normal.trace();
  const Eigen::LDLT<MatrixXd> solve(normal);
  const auto beside_law = [&](const MatrixXd& x) { return MatrixXd(x - law * solve.solve(law.transpose() * x)); };
  Imitation out;
  // a segment counts for its seconds, not for its rows
  out.samples = std::min(kMostSamples, r.duration_s);
  const double weight = out.samples / static_cast<double>(r.rows()) / (noise_N * noise_N);
  const Hypothesis& truth = leader.forms.front();
  const MatrixXd y = beside_law(columns_at(w, r, truth, truth.shape) * truth.strength);
  out.size = weight * y.squaredNorm();
  for (const Hypothesis& h : other.forms) {
    constexpr double kStep = 1e-3;
    const MatrixXd columns = columns_at(w, r, h, h.shape);
    MatrixXd X(columns.rows(), h.precision.rows());
    X.leftCols(columns.cols()) = columns;
    for (std::size_t k = 0; k < h.moves.size(); ++k) {
      std::vector<double> shape = h.shape;
      shape[h.moves[k]] *= std::exp(kStep);
      X.col(columns.cols() + static_cast<Eigen::Index>(k)) = (columns_at(w, r, h, shape) - columns) * h.strength / kStep;
    }
    const VectorXd apart = y - beside_law(columns * h.strength);
    X = beside_law(X);
    out.forms.push_back({weight * X.transpose() * X, weight * X.transpose() * apart, weight * apart.squaredNorm()});
  }
  return out;
}

namespace {

double log_growth(double samples, double square) { return samples > 0.0 ? 0.5 * samples * std::log1p(std::max(0.0, square) / samples) : 0.0; }

double score_of(const Diagnosis& d, const std::string& effect) {
  const auto at = std::ranges::find(d.ranking, effect, &RankedEffect::effect);
  return at == d.ranking.end() ? 0.0 : at->score;
}

}  // namespace

Expected expected_odds(const Workspace& w, const Diagnosis& d, const RivalOdds& now, const Rival& leader, const Rival& other,
                       const Imitation& played) {
  Expected out{now.log_odds, 1.0};
  if (played.forms.empty() || !(played.size > 0.0)) return out;
  double evidence = 1e300, apart = 0.0;
  for (std::size_t k = 0; k < played.forms.size(); ++k) {
    const Imitation::OfForm& f = played.forms[k];
    const double left = std::max(0.0, f.apart - f.slope.dot((f.gram + other.forms[k].precision).ldlt().solve(f.slope)));
    if (const double of_form = log_growth(played.samples, left) + other.forms[k].behind; of_form < evidence) evidence = of_form, apart = left;
  }
  const double share = std::min(1.0, apart / played.size);
  out.likeness = std::sqrt(1.0 - share);
  if (w.input.generic && std::sqrt(share) < least_apart(SelectionRules{}, leader.fall)) return out;
  if (!now.stated) {
    out.log_odds = now.log_odds + evidence;
    return out;
  }
  const double top = score_of(d, leader.kind->name), with_record = log_growth(played.samples, played.size);
  if (leader.kind->traits.between_records || other.kind->traits.between_records) {
    out.log_odds = now.log_odds + evidence / nats_of_a_factor(with_record);
    return out;
  }
  // where the rule made them equal, their evidence is not what the odds say
  double so_far = now.log_odds * nats_of_a_factor(top);
  if (w.input.generic) so_far = std::min(so_far, evidence_between(d, leader.kind->name, other.kind->name));
  out.log_odds = (so_far + evidence) / nats_of_a_factor(top + with_record);
  return out;
}

}  // namespace forcegate::diagnose
