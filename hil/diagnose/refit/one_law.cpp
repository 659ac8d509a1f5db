#include "hil/diagnose/refit/one_law.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "hil/base/plain_number.h"
#include "hil/diagnose/base/own_decay.h"
#include "hil/diagnose/candidates/user_candidates.h"
#include "hil/diagnose/engine.h"
#include "hil/diagnose/refit/replaced_forms.h"
#include "hil/diagnose/refit/seen_terms.h"

namespace forcegate::diagnose {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kRounds = 6, kFirstRounds = 1;
constexpr double kStep = 0.02;  // of log b and log q, for differences
constexpr double kRidge = 1e-9;
constexpr double kWorth = 0.97;  // an effect must lower the error of left-out records to this

struct Chosen {
  const EffectKind* kind = nullptr;
  const EffectForm* form = nullptr;
  std::vector<double> shape;
};

struct Gram {
  MatrixXd XX;
  VectorXd Xy;
  double yy = 0.0;
};

class Fitter {
 public:
  explicit Fitter(CampaignInput input) : input_(std::move(input)) {}

  CampaignInput& input() { return input_; }

  // Weighted rows of one record: sqrt(1/n) each, so that records weigh the same.
  Result<Gram> gram(RecordInput& r, const BaseLaw& law, const std::vector<Chosen>& effects) const {
    set_decay(r, law);
    Index columns = 2;
    for (const Chosen& c : effects) columns += static_cast<Index>(c.form->strength.size());
    const auto n = static_cast<Index>(r.rows());
    MatrixXd X = MatrixXd::Zero(n, columns);
    for (Index i = 0; i < n; ++i) X(i, 0) = r.base_force_N(static_cast<std::size_t>(i));
    X.col(1).setOnes();
    Index at = 2;
    for (const Chosen& c : effects) {
      const auto count = static_cast<Index>(c.form->strength.size());
      c.form->columns(input_, r, c.shape, X.middleCols(at, count));
      for (Index j = 0; j < count; ++j)
        if (!is_seen(*c.form, static_cast<std::size_t>(j), input_)) X.col(at + j).setZero();
      at += count;
    }
    VectorXd y(n);
    for (Index i = 0; i < n; ++i) y[i] = r.U_V[static_cast<std::size_t>(i)];
    double used = 0.0, above_0 = 0.0;
    for (Index i = 0; i < n; ++i)
      if (r.ok[static_cast<std::size_t>(i)] == 0 || !std::isfinite(y[i])) {
        X.row(i).setZero();
        y[i] = 0.0;
      } else {
        used += 1.0;
        above_0 += y[i] > 0.0 ? 1.0 : 0.0;
      }
    if (above_0 < 0.5 * used)
      return fail(ErrorCode::parse, "most of the output is not above 0", r.name,
                  "a compensator divides by an output that grows from 0: turn the sign of an inverting amplifier");
    used = std::max(1.0, used);
    return Gram{X.transpose() * X / used, X.transpose() * y / used, y.squaredNorm() / used};
  }

  Result<std::vector<Gram>> grams(const BaseLaw& law, const std::vector<Chosen>& effects) {
    std::vector<Gram> out;
    for (RecordInput& r : input_.records) {
      FORCEGATE_TRY(Gram g, gram(r, law, effects));
      out.push_back(std::move(g));
    }
    return out;
  }

  // Least squares; columns that these records do not excite stay at zero.
  static VectorXd solve(const std::vector<Gram>& grams, std::size_t left_out) {
    const Index m = grams.front().Xy.size();
    MatrixXd A = MatrixXd::Zero(m, m);
    VectorXd b = VectorXd::Zero(m);
    for (std::size_t k = 0; k < grams.size(); ++k)
      if (k != left_out) A += grams[k].XX, b += grams[k].Xy;
    const double least = 1e-12 * A.diagonal().maxCoeff();
    for (Index j = 0; j < m; ++j)
      if (A(j, j) <= least) {
        A.row(j).setZero();
        A.col(j).setZero();
        A(j, j) = 1.0;
        b[j] = 0.0;
      }
    A.diagonal() *= 1.0 + kRidge;
    return A.ldlt().solve(b);
  }

  static double square_error(const Gram& g, const VectorXd& beta) {
    return std::max(0.0, g.yy - 2.0 * beta.dot(g.Xy) + beta.dot(g.XX * beta));
  }

  static double error(const std::vector<Gram>& g) {
    const VectorXd beta = solve(g, g.size());
    double sum = 0.0;
    for (const Gram& one : g) sum += square_error(one, beta);
    return std::sqrt(sum / static_cast<double>(g.size()));
  }

  static double left_out(const std::vector<Gram>& g) {
    double sum = 0.0;
    for (std::size_t k = 0; k < g.size(); ++k) sum += square_error(g[k], solve(g, k));
    return std::sqrt(sum / static_cast<double>(g.size()));
  }

  // b and q by a quadratic through points around the present ones; the step shrinks when it does not help.
  Result<BaseLaw> refine(BaseLaw law, const std::vector<Chosen>& effects, int rounds = kRounds) {
    if (!law.decays) return law;
    const auto at = [&](double b, double q) -> Result<double> {
      BaseLaw changed = law;
      changed.b_scale *= std::exp(b);
      changed.q_scale *= std::exp(q);
      FORCEGATE_TRY(const std::vector<Gram> g, grams(changed, effects));
      const double e = error(g);
      return e * e;
    };
    FORCEGATE_TRY(double here, at(0.0, 0.0));
    for (int round = 0; round < rounds; ++round) {
      FORCEGATE_TRY(const double b1, at(kStep, 0.0));
      FORCEGATE_TRY(const double b0, at(-kStep, 0.0));
      FORCEGATE_TRY(const double q1, at(0.0, kStep));
      FORCEGATE_TRY(const double q0, at(0.0, -kStep));
      FORCEGATE_TRY(const double both, at(kStep, kStep));
      const double gb = (b1 - b0) / (2.0 * kStep), gq = (q1 - q0) / (2.0 * kStep);
      Eigen::Matrix2d H;
      H(0, 0) = (b1 - 2.0 * here + b0) / (kStep * kStep);
      H(1, 1) = (q1 - 2.0 * here + q0) / (kStep * kStep);
      H(0, 1) = H(1, 0) = (both - b1 - q1 + here) / (kStep * kStep);
      const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(H);
      const Eigen::Vector2d d =
          eigen.eigenvalues().cwiseAbs().cwiseMax(1e-3 * eigen.eigenvalues().cwiseAbs().maxCoeff() + 1e-15);
      Eigen::Vector2d step =
          -(eigen.eigenvectors() * d.cwiseInverse().asDiagonal() * eigen.eigenvectors().transpose()) *
          Eigen::Vector2d(gb, gq);
      const double longest = step.cwiseAbs().maxCoeff();
      if (longest > 0.3) step *= 0.3 / longest;
      bool better = false;
      for (int half = 0; half < 5 && !better; ++half, step *= 0.5) {
        FORCEGATE_TRY(const double there, at(step[0], step[1]));
        if (there >= here) continue;
        law.b_scale *= std::exp(step[0]);
        law.q_scale *= std::exp(step[1]);
        better = here - there > 1e-5 * here;
        here = there;
        if (!better) break;
      }
      if (!better) break;
    }
    return law;
  }

 private:
  CampaignInput input_;
};

std::vector<Chosen> variants_of(const EffectKind& kind, const std::vector<Chosen>& beside, const CampaignInput& input) {
  std::vector<Chosen> out;
  for (const EffectForm& form : kind.forms) {
    if (form.outlasts) continue;  // a firmware does not know what was before it
    if (soaks_up(kind, form)) continue;
    if (!form.beside.empty() && std::ranges::none_of(beside, [&](const Chosen& c) { return c.kind->name == form.beside; })) continue;
    for (std::vector<double>& shape : form.grid(input)) out.push_back({&kind, &form, std::move(shape)});
  }
  return out;
}

// Law and effects of the joint fit; uncertainties from the jackknife over records.
Model assembled(const Model& start, const CampaignInput& input, const BaseLaw& law, const std::vector<Chosen>& effects, const std::vector<Gram>& grams) {
  const VectorXd all = Fitter::solve(grams, grams.size());
  const auto n = static_cast<double>(grams.size());
  VectorXd mean = VectorXd::Zero(all.size()), square = mean;
  for (std::size_t k = 0; k < grams.size(); ++k) {
    const VectorXd beta = Fitter::solve(grams, k);
    mean += beta / n;
    square += beta.cwiseProduct(beta) / n;
  }
  const VectorXd se = ((square - mean.cwiseProduct(mean)).cwiseMax(0.0) * (n - 1.0)).cwiseSqrt();
  Model m = start;
  m.law = law;
  m.frame = frame_of(input);
  const double g = all[0];
  m.law.gain_N_per_V = 1.0 / g;
  m.law.offset_N = -all[1] / g;
  m.se_gain = se[0] / (g * g);
  m.se_offset = se[1] / std::fabs(g);
  m.effects.clear();
  std::vector<UserEffect> own;
  Index at = 2;
  for (const Chosen& c : effects) {
    std::vector<Estimate> strength, shape;
    for (std::size_t k = 0; k < c.form->strength.size(); ++k, ++at) strength.push_back({all[at] / g, se[at] / std::fabs(g)});
    for (const double value : c.shape) shape.push_back({value, 0.0});
    const auto equation = std::ranges::find(start.user_effects, c.kind->name, &UserEffect::name);
    if (equation == start.user_effects.end())
      m.effects.push_back(model_effect(*c.kind, *c.form, c.shape, strength));
    else
      own.push_back(with_fit(*equation, *c.form, shape, strength));
  }
  m.user_effects = std::move(own);
  return m;
}

// Every effect of the model that acts on the output, once, as a kind to choose a form of.
Result<std::vector<const EffectKind*>> wanted_kinds(const Model& start, const std::vector<std::unique_ptr<EffectKind>>& own,
                                                    const CampaignInput& input) {
  std::vector<const EffectKind*> out;
  for (const ModelEffect& wanted : start.effects) {
    const EffectKind* kind = EffectRegistry::instance().find(wanted.effect);
    // the forms of one effect that a refit wrote beside each other are one effect of the sensor
    if (kind == nullptr || kind->channel != EffectChannel::output || std::ranges::find(out, kind) != out.end()) continue;
    if (!is_available(*kind, input))
      return fail(ErrorCode::config, "the campaign lacks a channel that " + wanted.effect + " needs", input.name);
    out.push_back(kind);
  }
  for (const auto& kind : own) out.push_back(kind.get());
  return out;
}

// The best variant so far, with what was chosen before it.
struct Trial {
  double left_out_V = 1e300;
  std::vector<Chosen> effects;
  BaseLaw law;
};

// The best one that can be used, none where none can: asked from the best on, since an answer may take a compiler.
Result<Trial> best_usable(Fitter& fitter, const Model& start, std::vector<Trial>& trials, const IsUsable& is_usable) {
  std::ranges::stable_sort(trials, {}, &Trial::left_out_V);
  for (const Trial& t : trials) {
    if (!is_usable) return t;
    FORCEGATE_TRY(const std::vector<Gram> grams, fitter.grams(t.law, t.effects));
    if (is_usable(assembled(start, fitter.input(), t.law, t.effects, grams))) return t;
  }
  return Trial{};
}

// Samples that a fit throws out are thrown out here too, and it is decided from the output which records decay. Every row counts.
struct FittedRows {
  CampaignInput input;
  std::string unit;  ///< of the output
};
Result<FittedRows> rows_as_fitted(Campaign campaign, const Model& start, unsigned threads) {
  constexpr std::size_t kFewest = 3;
  const auto too_few = [name = campaign.name] {
    return fail(ErrorCode::config, "one law for all records needs at least three of them", name, "forcegate record makes a campaign");
  };
  if (campaign.records.size() < kFewest) return too_few();
  EngineOptions options;
  options.law = start.law;
  options.model_name = start.name;
  options.in_model = start.effect_names();
  options.threads = threads;
  options.pictures = options.search = false;
  FORCEGATE_TRY(const std::unique_ptr<Workspace> w, prepare(std::move(campaign), options));
  if (w->input.records.size() < kFewest) return too_few();
  for (RecordInput& r : w->input.records) {
    r.wanted.clear();
    r.recording = w->input.records.front().recording;  // a firmware is switched on where the record begins: what the film kept it cannot know
  }
  return FittedRows{std::move(w->input), w->output.unit};
}

std::string cost_of(const Trial& usable, const Trial& best, const PrintedUnit& unit) {
  const std::string& wanted = best.effects.back().form->name;
  const std::string& taken = usable.effects.back().form->name;
  const std::string costs = fmt::format("and leaves {:.3g} {} of error instead of {:.3g}", unit.factor * usable.left_out_V, unit.name,
                                        unit.factor * best.left_out_V);
  const std::string& effect = best.effects.back().kind->name;
  if (wanted == taken)
    return fmt::format("{}: the form {} predicts best with parameters with which it cannot be undone; with others it can, {}", effect, wanted, costs);
  return fmt::format("{}: the form {} predicts best, but it cannot be undone; {} can, {}", effect, wanted, taken, costs);
}

// Law and effects as they grow, with the sums of the rows for them.
struct Growing {
  BaseLaw law;
  std::vector<Chosen> effects;
  std::vector<Gram> grams;
};

// Every form and shape of one more effect; b and q have soaked up what is missing, so that each is judged with its own.
Result<std::vector<Trial>> trials_of(Fitter& fitter, const EffectKind& kind, const Growing& so_far) {
  std::vector<Trial> out;
  for (Chosen& variant : variants_of(kind, so_far.effects, fitter.input())) {
    std::vector<Chosen> with = so_far.effects;
    with.push_back(variant);
    FORCEGATE_TRY(const BaseLaw own, fitter.refine(so_far.law, with, kFirstRounds));
    FORCEGATE_TRY(const std::vector<Gram> grams, fitter.grams(own, with));
    if (const double left_out_V = Fitter::left_out(grams); std::isfinite(left_out_V)) out.push_back({left_out_V, std::move(with), own});
  }
  return out;
}

// Takes the best form of an effect in that can be used, or the best where none can.
Result<void> take_in(Fitter& fitter, const EffectKind& kind, const Model& start, const IsUsable& is_usable, const std::string& unit,
                     Growing& so_far, std::vector<std::string>& notes) {
  FORCEGATE_TRY(std::vector<Trial> trials, trials_of(fitter, kind, so_far));
  if (trials.empty()) {
    notes.push_back(kind.name + " is left out: with one law for all records no form of it can be fitted");
    return {};
  }
  FORCEGATE_TRY(const Trial usable, best_usable(fitter, start, trials, is_usable));
  const Trial& best = trials.front();
  const bool worse = !usable.effects.empty() && usable.left_out_V > best.left_out_V;
  if (worse) notes.push_back(cost_of(usable, best, printed_unit(unit)));
  const Trial& chosen = usable.effects.empty() ? best : usable;
  so_far.effects = chosen.effects;
  note_unseen(*so_far.effects.back().kind, *so_far.effects.back().form, fitter.input(), notes);
  FORCEGATE_TRY(so_far.law, fitter.refine(chosen.law, so_far.effects));
  FORCEGATE_TRY(so_far.grams, fitter.grams(so_far.law, so_far.effects));
  return {};
}

// Of each record without and with the effects, all records fitted together.
std::vector<OneLawFit::Item> record_errors(const std::vector<RecordInput>& records, const std::vector<Gram>& bare, const std::vector<Gram>& with) {
  const VectorXd bare_beta = Fitter::solve(bare, bare.size()), all = Fitter::solve(with, with.size());
  std::vector<OneLawFit::Item> out;
  for (std::size_t k = 0; k < with.size(); ++k)
    out.push_back({records[k].name,
                   std::sqrt(Fitter::square_error(bare[k], bare_beta)),
                   std::sqrt(Fitter::square_error(with[k], all))});
  return out;
}

// A form that cannot be undone has its cost told already.
void note_replaced_forms(const Model& start, const Model& fitted, std::vector<std::string>& notes) {
  for (const std::string& note : replaced_forms(start, fitted)) {
    const std::string of_effect = note.substr(0, note.find(": ") + 2);
    const auto says_why = [&](const std::string& told) { return told.starts_with(of_effect); };
    if (std::ranges::none_of(notes, says_why)) notes.push_back(note + "; without --fit the model is exported as it stands");
  }
}

}  // namespace

Result<OneLawFit> fit_one_law(Campaign campaign, const Model& start, const IsUsable& is_usable, unsigned threads) {
  FORCEGATE_TRY(FittedRows rows, rows_as_fitted(std::move(campaign), start, threads));
  CampaignInput& input = rows.input;
  const std::string name = input.name;
  OneLawFit out;
  out.notes = std::move(input.notes);
  FORCEGATE_TRY(const auto own_kinds, make_user_kinds(start.user_effects, input));
  BaseLaw first = start.law;
  if (none_decays(input)) first.decays = false;
  Fitter fitter(std::move(input));
  Growing fit;
  FORCEGATE_TRY(fit.law, fitter.refine(first, {}));
  FORCEGATE_TRY(fit.grams, fitter.grams(fit.law, {}));
  const std::vector<Gram> bare = fit.grams;
  FORCEGATE_TRY(const std::vector<const EffectKind*> kinds, wanted_kinds(start, own_kinds, fitter.input()));
  for (const EffectKind* kind : kinds) FORCEGATE_CHECK_OK(take_in(fitter, *kind, start, is_usable, rows.unit, fit, out.notes));
  out.law_left_out_V = Fitter::left_out(bare);
  out.left_out_V = Fitter::left_out(fit.grams);
  if (!fit.effects.empty() && out.left_out_V > kWorth * out.law_left_out_V)
    return fail(ErrorCode::config,
                "with one law for all records the effects do not lower the error of records left out",
                name,
                "they may differ from record to record: forcegate compare shows where the error sits");

  out.model = assembled(start, fitter.input(), fit.law, fit.effects, fit.grams);
  out.records = record_errors(fitter.input().records, bare, fit.grams);
  out.model.output_unit = rows.unit;
  note_replaced_forms(start, out.model, out.notes);
  HistoryStep step;
  step.unit = rows.unit;
  step.campaign = name;
  step.one_law = true;
  step.error_before = step.plain_before = out.law_left_out_V;
  step.error_after = step.plain_after = out.left_out_V;
  out.model.history.push_back(step);
  return out;
}

}  // namespace forcegate::diagnose
