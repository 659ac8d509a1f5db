#include "hil/diagnose/base/base_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "hil/base/parallel.h"
#include "hil/diagnose/base/own_decay.h"
#include "hil/diagnose/base/repeatability.h"
#include "hil/diagnose/raw/sample_noise.h"
#include "hil/diagnose/workspace.h"
#include "hil/model/rows.h"
#include "hil/trace/static_line.h"

namespace forcegate::diagnose {

namespace {

constexpr double kLargestShift = 12.0;

std::uint64_t mixed(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15ull;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
  return x ^ (x >> 31);
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
    const double undithered = h != nullptr ? std::hypot(w.gain_V_per_N * decay * left_of(step_F, h->noise_F_N), left_of(step_U, h->noise_U_V)) / std::sqrt(12.0) : 0.0;
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
    const double u = static_cast<double>(mixed(j) >> 11) * 0x1.0p-53;
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

}  // namespace

void fit_base(Workspace& w, unsigned threads, const std::vector<Candidate>& beside) {
  const std::size_t n = w.input.records.size();
  w.shifts.assign(n, {});
  w.gain_V_per_N = w.scales.gain_V_per_N;
  std::vector<std::vector<std::size_t>> rows;
  for (const RecordInput& r : w.input.records) rows.push_back(choose_rows(r, 800));
  if (w.law.decays && w.input.single)
    start_blocks(w, rows);
  else if (w.law.decays)
    choose_excitation(w, rows);
  if (const double slope = slope_at_rest(w.input); slope != 0.0) w.gain_V_per_N = slope;

  constexpr double kOpen = 1.0;                 // of the span: whatever they need
  constexpr double kAbout = 0.3, kLeast = 0.02; // of what is written, of the span
  std::vector<Eigen::MatrixXd> S(n);
  const auto set_decays = [&] { parallel_for(n, threads, [&](std::size_t k) { set_decay(w.input.records[k], w.law, w.shifts[k].log_b, w.shifts[k].log_q); }); };
  // the first block of a recording has its rows and its force at full rate for all of them
  const auto whole = [&](std::size_t k) { return std::ranges::find(w.input.records, w.input.records[k].recording, &RecordInput::recording); };
  // what is late decays as the rest does: a lag that did not would take a share of the decay
  const auto fill_beside = [&] {
    set_decays();
    parallel_for(n, threads, [&](std::size_t k) { S[k] = columns_beside(w, *whole(k), beside, rows[k]); });
  };
  int ns = 0;
  for (const Candidate& c : beside) ns += c.count;
  std::vector<int> columns(static_cast<std::size_t>(ns));
  std::iota(columns.begin(), columns.end(), 0);

  const auto run = [&](int rounds) {
    MixedFit fit;
    for (int round = 0; round < rounds; ++round) {
      if (round == 0 || ns > 0) fill_beside();
      MixedProblem problem;
      set_repeatability(problem, w.input.single, w.zero_wanders, w.tells_swing);
      problem.ns = ns;
      problem.column_prior_sd = Eigen::VectorXd::Constant(ns, kOpen);
      problem.column_prior_mean = Eigen::VectorXd::Zero(ns);
      Eigen::Index first = 0;
      for (const Candidate& c : beside) {
        for (std::size_t j = 0; j < c.written.size(); ++j) {
          const auto at = first + static_cast<Eigen::Index>(j);
          problem.column_prior_mean[at] = c.written[j] * w.gain_V_per_N * w.input.range_N / w.input.U_range_V;
          problem.column_prior_sd[at] = std::max(kLeast, kAbout * std::abs(problem.column_prior_mean[at]));
        }
        first += c.count;
      }
      problem.records.resize(n);
      parallel_for(n, threads, [&](std::size_t k) {
        const Eigen::MatrixXd Z = repeatability_columns(w, k, rows[k]);
        Eigen::MatrixXd A(Z.rows(), Z.cols() + ns + 1);
        A.leftCols(Z.cols()) = Z;
        A.middleCols(Z.cols(), ns) = S[k];
        for (Eigen::Index j = 0; j < Z.rows(); ++j)
          A(j, Z.cols() + ns) = w.input.records[k].U_V[rows[k][static_cast<std::size_t>(j)]] / w.input.U_range_V +
                           Z(j, 2) * w.shifts[k].log_b + Z(j, 3) * w.shifts[k].log_q;
        RecordGram& gram = problem.records[k];
        gram.gram = (A.transpose() * A) / std::max<double>(1.0, static_cast<double>(A.rows()));
        gram.n_eff = effective_samples(rows[k].size());
        gram.noise_variance = 1e-6;
        gram.heldout = w.input.records[k].heldout && w.judges == JudgedBy::heldout;
      });
      fit = fit_mixed(problem, columns, nullptr, 15);
      if (!fit.valid) return fit;
      if (w.law.decays && w.tells_swing && !tells_swing(fit)) {
        w.tells_swing = false;
        continue;
      }
      for (std::size_t k = 0; k < n; ++k) {
        const double b = fit.coefficient[2] + fit.zeta[k][2], q = fit.coefficient[3] + fit.zeta[k][3];
        w.shifts[k].log_b += std::clamp(b - w.shifts[k].log_b, -0.5, 0.5);
        w.shifts[k].log_q += std::clamp(q - w.shifts[k].log_q, -0.5, 0.5);
        w.shifts[k].log_b = std::clamp(w.shifts[k].log_b, -kLargestShift, kLargestShift);
        w.shifts[k].log_q = std::clamp(w.shifts[k].log_q, -kLargestShift, kLargestShift);
      }
      w.gain_V_per_N *= std::clamp(fit.coefficient[0], 0.3, 3.0);
    }
    return fit;
  };

  MixedFit chosen;
  bool any_dynamic = false;
  for (const RecordInput& r : w.input.records) any_dynamic |= r.dynamic;
  if (any_dynamic && w.law.decays) {
    const BaseLaw decaying = w.law;
    const double start_gain = w.gain_V_per_N;
    MixedFit with = run(6);
    const auto shifts = w.shifts;
    const double gain = w.gain_V_per_N;
    // a sensor that does not decay is better off without the law
    w.law.decays = false;
    w.shifts.assign(n, {});
    w.gain_V_per_N = start_gain;
    MixedFit without = run(2);
    if (with.valid && (!without.valid || with.log_evidence >= without.log_evidence - 3.0)) {
      w.law = decaying;
      w.shifts = shifts;
      w.gain_V_per_N = gain;
      chosen = std::move(with);
    } else {
      w.decays_otherwise = without.valid && own_courses_decay(w.input, without);
      w.tells_swing = true;
      chosen = std::move(without);
      w.input.notes.emplace_back(w.decays_otherwise ? "the maxima decay, and not along the law of the model: each record's own course is taken for its decay"
                                                    : "no decay of the maxima is seen: the static law alone is the starting model");
    }
  } else {
    chosen = run(2);
  }
  set_decays();
  if (chosen.valid) parallel_for(n, threads, [&](std::size_t k) { follow_course(chosen, k, w.input.records[k]); });
  set_noise(w, threads);
}

}  // namespace forcegate::diagnose
