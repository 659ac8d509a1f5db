#include "hil/diagnose/base/base_fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "hil/base/mixed_bits.h"
#include "hil/base/parallel.h"
#include "hil/base/text.h"
#include "hil/diagnose/base/own_decay.h"
#include "hil/diagnose/base/repeatability.h"
#include "hil/diagnose/raw/record_scales.h"
#include "hil/diagnose/raw/sample_noise.h"
#include "hil/diagnose/workspace.h"
#include "hil/model/decay_clock.h"
#include "hil/model/rows.h"
#include "hil/trace/static_line.h"

namespace forcegate::diagnose {

namespace {

constexpr double kLargestShift = 12.0;

// A file of means shows no step, and its means keep what the noise before the converter did not dither: of that the declared noise tells, for
// what the means scatter by is less.
double left_of_hidden_step(double declared, double visible, double noise) {
  constexpr double kHidden = 2.0;
  return declared > kHidden * visible ? left_of_dithered_step(declared, noise) : 0.0;
}

// Errors in variables: what the instruments' steps leave in a row although they do as declared.
void set_noise(Workspace& w, unsigned threads) {
  constexpr double kMostOfSamples = 10.0;
  w.noise_V.assign(w.input.records.size(), 0.0);
  w.white_V.assign(w.input.records.size(), 0.0);
  w.smoothed_V.assign(w.input.records.size(), 0.0);
  parallel_for(w.input.records.size(), threads, [&](std::size_t k) {
    const RecordInput& r = w.input.records[k];
    std::vector<double> e(r.rows());
    // a row that is not used holds no value; what it leaves is not finite and counts nowhere
    for (std::size_t i = 0; i < r.rows(); ++i) e[i] = r.ok[i] != 0 ? r.U_V[i] - w.gain_V_per_N * r.base_force_N(i) : kMissing;
    double decay = 0.0;
    for (double D : r.decay) decay += D;
    decay /= static_cast<double>(std::max<std::size_t>(1, r.decay.size()));
    const RecordHealth* h = k < w.health.size() ? &w.health[k] : nullptr;
    const double step_F = h != nullptr ? h->lsb_F_N : 0.0, step_U = h != nullptr ? h->lsb_U_V : 0.0;
    const double quantised = std::hypot(w.gain_V_per_N * decay * step_F, step_U) / std::sqrt(12.0);
    // in a force about as fast as the rows their differences are of the movement: the samples bound them, with room for coloured noise
    const double of_samples =
        h != nullptr ? std::hypot(h->noise_U_V, w.gain_V_per_N * decay * h->noise_F_N, quantised) : std::numeric_limits<double>::infinity();
    const double white = std::min(white_noise(e, e.size()), kMostOfSamples * of_samples);
    // steps are only averaged away when noise dithers them
    const auto left_of = [](double step, double noise) { return step > 0.0 ? step * std::clamp(1.2 - 2.0 * noise / step, 0.3, 1.0) : 0.0; };
    double undithered = 0.0;
    if (h != nullptr) {
      const BenchFacts& bench = w.input.bench;
      const double noise_F = std::isfinite(bench.reference_noise_N) ? bench.reference_noise_N : h->noise_F_N;
      const double hidden_F = left_of_hidden_step(declared_step_N(bench), step_F, noise_F), hidden_U = left_of_hidden_step(declared_step_V(w.input), step_U, h->noise_U_V);
      const double of_F = std::max(left_of(step_F, h->noise_F_N) / std::sqrt(12.0), hidden_F), of_U = std::max(left_of(step_U, h->noise_U_V) / std::sqrt(12.0), hidden_U);
      undithered = std::hypot(w.gain_V_per_N * decay * of_F, of_U);
    }
    w.smoothed_V[k] = h != nullptr ? w.gain_V_per_N * decay * h->smoothed_F_N : 0.0;
    w.white_V[k] = white + 1e-4 * w.input.U_range_V;
    w.noise_V[k] = std::hypot(white, undithered) + 1e-4 * w.input.U_range_V;
  });
}

}  // namespace

std::vector<std::size_t> choose_rows(const RecordInput& record, std::size_t limit) {
  std::vector<std::size_t> good;
  for (std::size_t i = 0; i < record.rows(); ++i)
    if (record.ok[i] != 0) good.push_back(i);
  if (good.size() <= limit) return good;
  std::vector<std::size_t> out;
  const double stride = static_cast<double>(good.size()) / static_cast<double>(limit);
  for (std::size_t j = 0; j < limit; ++j) {
    const double u = static_cast<double>(mixed_bits(j + kMixStep) >> 11) * 0x1.0p-53;
    out.push_back(
        good[std::min(good.size() - 1, static_cast<std::size_t>((static_cast<double>(j) + u) * stride))]);
  }
  return out;
}

namespace {

// Where the law's constants are far off (a sensor of another range), the search starts from the record's own.
RecordShift start_of(const Workspace& w, const RecordInput& r, const OwnDecay& own) {
  constexpr double kFar = 1.2;
  const double log_b = std::log(own.rate_per_s / w.law.decay_rate_per_s(r.f_Hz));
  const double log_q = std::log((1.0 / own.depth - 1.0) / w.law.depth_ratio(r.A_N));
  if (std::abs(log_b) <= kFar && std::abs(log_q) <= kFar) return {};
  return {std::clamp(log_b, -kLargestShift, kLargestShift), std::clamp(log_q, -kLargestShift, kLargestShift)};
}

// Records that nobody declared are cyclic where their own decay explains most of what a straight line leaves.
void choose_excitation(Workspace& w, const std::vector<std::vector<std::size_t>>& rows) {
  std::vector<OwnDecay> own(w.input.records.size());
  for (std::size_t k = 0; k < own.size(); ++k)
    if (w.input.records[k].dynamic) own[k] = own_decay(w.input.records[k], rows[k]);
  const bool others_decay = some_decay(own);
  for (std::size_t k = 0; k < own.size(); ++k) {
    RecordInput& r = w.input.records[k];
    if (!r.dynamic) continue;
    if (own[k].is_decay(others_decay)) {
      w.shifts[k] = start_of(w, r, own[k]);
    } else if (r.dynamic_assumed) {
      // a change of frequency is looked for where nothing decays too: D stays at 1
      r.found_static = true;
      if (r.frequency_jumps_s.empty())
        set_static(r);
      else
        w.shifts[k].log_q = 8.0;
    }
  }
}

// Whether the courses that the records have of their own take swing away.
bool own_courses_decay(const CampaignInput& input, const MixedFit& fit) {
  constexpr double kLoses = 0.03;  // of the swing, by the end of a record
  for (std::size_t k = 0; k < input.records.size(); ++k) {
    const RecordInput& r = input.records[k];
    if (!r.dynamic || r.t_s.empty()) continue;
    if (bend_of(fit, k, r.t_s.back() - r.onset_s) < -kLoses * std::max(0.1, fit.coefficient[0] + fit.zeta[k][0])) return true;
  }
  return false;
}

// Blocks of one recording have one decay: a late block alone has hardly any of it left.
void start_blocks(Workspace& w, const std::vector<std::vector<std::size_t>>& rows) {
  const RecordInput& whole = w.input.records.front();
  if (!whole.dynamic) return;
  std::vector<std::size_t> all;
  for (const auto& block : rows) all.insert(all.end(), block.begin(), block.end());
  if (const OwnDecay own = own_decay(whole, all); own.is_decay())
    w.shifts.assign(w.shifts.size(), start_of(w, whole, own));
}

// Slope of U on F over the static records, since the decay flattens the dynamic ones; 0 where their force hardly moves: what is at rest
// knows no slope.
double slope_at_rest(const CampaignInput& input) {
  constexpr double kMoves = 0.02;  // of the span, RMS
  double FF = 0.0, FU = 0.0, all = 0.0;
  for (const RecordInput& r : input.records) {
    if (r.dynamic) continue;
    StaticLine line;
    for (std::size_t i = 0; i < r.rows(); ++i)
      if (r.ok[i] != 0) line.push(r.U_V[i], r.F_N[i]);
    if (!(line.n() > 0.0)) continue;
    all += line.n();
    FF += line.n() * line.variance_N2();
    FU += line.n() * line.covariance_VN();
  }
  const double least_N = kMoves * input.range_N;
  return FF > all * least_N * least_N ? FU / FF : 0.0;
}

Eigen::MatrixXd columns_beside(const Workspace& w, const RecordInput& of, const std::vector<Candidate>& beside, const std::vector<std::size_t>& rows) {
  int count = 0;
  for (const Candidate& c : beside) count += c.count;
  Eigen::MatrixXd out(static_cast<Eigen::Index>(rows.size()), count);
  if (count == 0) return out;
  RecordInput record = of;
  record.wanted.clear();
  Eigen::Index at = 0;
  for (const Candidate& c : beside) {
    Eigen::MatrixXd full = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(record.rows()), c.count);
    c.form->columns(w.input, record, c.shape, full);
    for (std::size_t j = 0; j < rows.size(); ++j)
      out.row(static_cast<Eigen::Index>(j)).segment(at, c.count) = full.row(static_cast<Eigen::Index>(rows[j])) / w.input.range_N;
    at += c.count;
  }
  return out;
}

std::string clock_in_words(double loading_share) {
  if (loading_share == 0.0) return "the decay goes with the time: by the loading done, as the model has it, it fits worse";
  return fmt::format("the decay goes {} the loading done, not with the time alone: where the load pauses it pauses too (loading_share = {} in a model file)",
                     loading_share < 1.0 ? "partly with" : "with", shortest(loading_share));
}

// Gain, zero and decay of every record, and the columns of what the model has beside its law. The decay is not linear in its rate and depth:
// each round goes a step towards what the one before found.
class BaseSearch {
 public:
  BaseSearch(Workspace& w, unsigned threads, const std::vector<Candidate>& beside) : w_(w), threads_(threads), beside_(beside), S_(w.input.records.size()) {
    constexpr std::size_t kMostRows = 800;
    for (const RecordInput& r : w.input.records) rows_.push_back(choose_rows(r, kMostRows));
    for (const Candidate& c : beside) width_ += c.count;
  }

  void start() {
    w_.shifts.assign(records(), {});
    w_.gain_V_per_N = w_.scales.gain_V_per_N;
    if (w_.law.decays && w_.input.single)
      start_blocks(w_, rows_);
    else if (w_.law.decays)
      choose_excitation(w_, rows_);
    if (const double slope = slope_at_rest(w_.input); slope != 0.0) w_.gain_V_per_N = slope;
    start_ = place();
  }

  MixedFit with_law_that_fits() {
    const bool may_decay = w_.law.decays && std::ranges::any_of(w_.input.records, &RecordInput::dynamic);
    return may_decay ? with_or_without_decay() : run(kRoundsAtRest);
  }

  void set_decays() {
    parallel_for(records(), threads_, [&](std::size_t k) { set_decay(w_.input.records[k], w_.law, w_.shifts[k].log_b, w_.shifts[k].log_q); });
  }

 private:
  struct Place {
    std::vector<RecordShift> shifts;
    double gain_V_per_N = 0.0, loading_share = 0.0;
  };
  struct Step {
    double longest = 0.5;
    Eigen::Vector2d last = Eigen::Vector2d::Zero();  // of ln b and ln q
  };

  static constexpr int kRounds = 24, kRoundsAtRest = 2, kIterations = 15;
  static constexpr double kSettled = 0.01;  // of ln b, ln q and ln gain

  std::size_t records() const { return w_.input.records.size(); }

  static double left_by(const MixedFit& fit) { return std::reduce(fit.adapted.begin(), fit.adapted.end()); }

  // A sensor that does not decay is better off without the law. One whose records lose swing by courses of their own decays, and keeps a law that leaves as little.
  MixedFit with_or_without_decay() {
    constexpr double kNats = 3.0, kAsLittle = 1.1;
    const BaseLaw decaying = w_.law;
    MixedFit with = along_its_clock();
    const Place found = place();
    w_.law.decays = false;
    go_to({std::vector<RecordShift>(records()), start_.gain_V_per_N, 0.0});
    MixedFit without = run(kRoundsAtRest);
    const bool is_behind = with.valid && without.valid && with.log_evidence < without.log_evidence - kNats;
    w_.decays_otherwise = (is_behind || !with.valid) && without.valid && own_courses_decay(w_.input, without);
    const bool as_good = w_.decays_otherwise && left_by(with) <= kAsLittle * left_by(without);
    if (with.valid && (!is_behind || as_good)) {
      w_.law = decaying;
      go_to(found);
      if (found.loading_share != start_.loading_share) w_.input.notes.push_back(clock_in_words(found.loading_share));
      return with;
    }
    w_.tells_swing = true;
    w_.input.notes.emplace_back(w_.decays_otherwise ? "the maxima decay, and not along the law of the model: each record's own course is taken for its decay"
                                                    : "no decay of the maxima is seen: the static law alone is the starting model");
    return without;
  }

  Place place() const { return {w_.shifts, w_.gain_V_per_N, w_.law.loading_share}; }
  void go_to(const Place& place) {
    w_.shifts = place.shifts;
    w_.gain_V_per_N = place.gain_V_per_N;
    w_.law.loading_share = place.loading_share;
  }

  // Under even cycling there is one clock; of a load that pauses the records tell which one their decay keeps to. What another one leaves most of is
  // no matter of the clock: a swing that comes back after a change of frequency fits each of them a little.
  MixedFit along_its_clock() {
    constexpr double kUneven = 0.1, kNats = 10.0, kOfError = 0.5;
    MixedFit best = run(kRounds);
    const double least = best.valid ? kOfError * left_by(best) : std::numeric_limits<double>::infinity();
    if (std::ranges::none_of(w_.input.records, [](const RecordInput& r) { return r.dynamic && unevenness_of_loading(r) > kUneven; })) return best;
    Place found = place();
    for (const double share : {0.0, 0.5, 1.0}) {
      if (share == start_.loading_share) continue;
      go_to({start_.shifts, start_.gain_V_per_N, share});
      const MixedFit fit = run(kRounds);
      if (!fit.valid || !(left_by(fit) < least) || (best.valid && fit.log_evidence < best.log_evidence + kNats)) continue;
      best = fit;
      found = place();
    }
    go_to(found);
    return best;
  }

  MixedFit run(int rounds) {
    std::vector<int> columns(static_cast<std::size_t>(width_));
    std::iota(columns.begin(), columns.end(), 0);
    steps_.assign(records(), {});
    MixedFit fit;
    for (int round = 0; round < rounds; ++round) {
      if (round == 0 || width_ > 0) fill_beside();
      fit = fit_mixed(problem(), columns, nullptr, kIterations);
      if (!fit.valid) return fit;
      if (w_.law.decays && w_.tells_swing && !tells_swing(fit))
        w_.tells_swing = false;
      else if (step_towards(fit) < kSettled)
        break;
    }
    return fit;
  }

  // What is late decays as the rest does: a lag that did not would take a share of the decay.
  void fill_beside() {
    set_decays();
    // the first block of a recording has its rows and its force at full rate for all of them
    const auto whole = [&](std::size_t k) { return std::ranges::find(w_.input.records, w_.input.records[k].recording, &RecordInput::recording); };
    parallel_for(records(), threads_, [&](std::size_t k) { S_[k] = columns_beside(w_, *whole(k), beside_, rows_[k]); });
  }

  MixedProblem problem() const {
    MixedProblem out;
    set_repeatability(out, w_.input.single, w_.zero_wanders, w_.tells_swing);
    out.ns = width_;
    set_priors(out);
    out.records.resize(records());
    parallel_for(records(), threads_, [&](std::size_t k) { out.records[k] = gram_of(k); });
    return out;
  }

  // Strengths that a model file has written stay near it, others are open.
  void set_priors(MixedProblem& out) const {
    constexpr double kOpen = 1.0;                  // of the span: whatever they need
    constexpr double kAbout = 0.3, kLeast = 0.02;  // of what is written, of the span
    out.column_prior_sd = Eigen::VectorXd::Constant(width_, kOpen);
    out.column_prior_mean = Eigen::VectorXd::Zero(width_);
    Eigen::Index first = 0;
    for (const Candidate& c : beside_) {
      for (std::size_t j = 0; j < c.written.size(); ++j) {
        const auto at = first + static_cast<Eigen::Index>(j);
        out.column_prior_mean[at] = c.written[j] * w_.gain_V_per_N * w_.input.range_N / w_.input.U_range_V;
        out.column_prior_sd[at] = std::max(kLeast, kAbout * std::abs(out.column_prior_mean[at]));
      }
      first += c.count;
    }
  }

  RecordGram gram_of(std::size_t k) const {
    constexpr double kNoiseVariance = 1e-6;
    const Eigen::MatrixXd Z = repeatability_columns(w_, k, rows_[k]);
    Eigen::MatrixXd A(Z.rows(), Z.cols() + width_ + 1);
    A.leftCols(Z.cols()) = Z;
    A.middleCols(Z.cols(), width_) = S_[k];
    for (Eigen::Index j = 0; j < Z.rows(); ++j)
      A(j, Z.cols() + width_) = w_.input.records[k].U_V[rows_[k][static_cast<std::size_t>(j)]] / w_.input.U_range_V + Z(j, 2) * w_.shifts[k].log_b +
                                Z(j, 3) * w_.shifts[k].log_q;
    RecordGram out;
    out.gram = (A.transpose() * A) / std::max<double>(1.0, static_cast<double>(A.rows()));
    out.n_eff = effective_samples(rows_[k].size());
    out.noise_variance = kNoiseVariance;
    out.heldout = w_.input.records[k].heldout && w_.judges == JudgedBy::heldout;
    return out;
  }

  // The longest step that is wanted, of ln b, ln q and ln gain. One is shortened as a whole: of a slow decay only rate by depth is seen, and each
  // shortened by itself would leave that. A record that steps back steps half as far, one that goes on twice as far again.
  double step_towards(const MixedFit& fit) {
    constexpr double kLongestStep = 0.5, kLeastGain = 0.3, kMostGain = 3.0;
    const auto within = [](double shift) { return std::clamp(shift, -kLargestShift, kLargestShift); };
    double longest = 0.0;
    for (std::size_t k = 0; k < records(); ++k) {
      RecordShift& shift = w_.shifts[k];
      const Eigen::Vector2d wanted(fit.coefficient[2] + fit.zeta[k][2] - shift.log_b, fit.coefficient[3] + fit.zeta[k][3] - shift.log_q);
      steps_[k].longest = std::min(kLongestStep, steps_[k].longest * (wanted.dot(steps_[k].last) < 0.0 ? 0.5 : 2.0));
      const double far = wanted.lpNorm<Eigen::Infinity>();
      steps_[k].last = wanted * std::min(1.0, steps_[k].longest / std::max(far, 1e-300));
      longest = std::max(longest, far);
      shift.log_b = within(shift.log_b + steps_[k].last[0]);
      shift.log_q = within(shift.log_q + steps_[k].last[1]);
    }
    const double gain = std::clamp(fit.coefficient[0], kLeastGain, kMostGain);
    w_.gain_V_per_N *= gain;
    return std::max(longest, std::abs(std::log(gain)));
  }

  Workspace& w_;
  unsigned threads_;
  const std::vector<Candidate>& beside_;
  std::vector<std::vector<std::size_t>> rows_;  // that are fitted, of each record
  Place start_;                                 // of every search
  std::vector<Step> steps_;                     // of each record
  std::vector<Eigen::MatrixXd> S_;              // of `beside`
  int width_ = 0;                               // columns of S
};

}  // namespace

void fit_base(Workspace& w, unsigned threads, const std::vector<Candidate>& beside) {
  BaseSearch search(w, threads, beside);
  search.start();
  const MixedFit chosen = search.with_law_that_fits();
  search.set_decays();
  if (chosen.valid) parallel_for(w.input.records.size(), threads, [&](std::size_t k) { follow_course(chosen, k, w.law.loading_share, w.input.records[k]); });
  set_noise(w, threads);
}

}  // namespace forcegate::diagnose
