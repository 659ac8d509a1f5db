#include "hil/diagnose/base/own_decay.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>

#include "hil/base/parallel.h"
#include "hil/diagnose/base/base_fit.h"
#include "hil/model/rows.h"

namespace forcegate::diagnose {

namespace {

constexpr std::size_t kRows = 4000;
constexpr double kMostPerDegree = 0.03;  // of the gain, 1/degC

// Recorded temperature over its mean, degC; 0 where nothing is recorded.
std::vector<double> warmth_of(const RecordInput& r) {
  std::vector<double> out(r.rows(), 0.0);
  double sum = 0.0, n = 0.0;
  for (const double T : r.temp_C)
    if (std::isfinite(T)) sum += T, n += 1.0;
  for (std::size_t i = 0; i < r.temp_C.size(); ++i)
    if (std::isfinite(r.temp_C[i])) out[i] = r.temp_C[i] - sum / n;
  return out;
}

OwnDecay decay_about(double F_min_N, const RecordInput& r, const std::vector<std::size_t>& rows, Rates rates = Rates::of_grid) {
  constexpr int kRates = 14, kForce = 1, kCurves = 5, kWarmGain = 6, kDecay = 8, kOutput = 9;  // kForce to kCurves: what the force does at a time
  constexpr double kFinest = 0.005;  // of ln rate
  using Row = Eigen::Matrix<double, kOutput + 1, 1>;
  using Moments = Eigen::Matrix<double, kOutput + 1, kOutput + 1>;
  OwnDecay best;
  best.mean_square = 1e300;
  const double n = std::max<double>(1.0, static_cast<double>(rows.size()));
  const double longest = std::max(1.0, r.duration_s - r.onset_s);
  std::vector<double> warmth = warmth_of(r);
  // of the first `columns`, divided by the diagonal so that their units do not matter; what they leave
  const auto fit = [&](const Moments& M, int columns) {
    const Eigen::VectorXd size = M.diagonal().head(columns).cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    const Eigen::MatrixXd A = size.asDiagonal() * M.topLeftCorner(columns, columns) * size.asDiagonal();
    const Eigen::VectorXd y = size.asDiagonal() * M.col(kOutput).head(columns);
    const Eigen::VectorXd c = A.ldlt().solve(y);
    return std::pair{Eigen::VectorXd(size.asDiagonal() * c), std::max(0.0, M(kOutput, kOutput) - c.dot(y)) / n};
  };
  const auto moments_at = [&](double rate) {
    Moments M = Moments::Zero();
    for (const std::size_t i : rows) {
      const double since = std::max(0.0, r.t_s[i] - r.onset_s);
      // neighbours of a lost row have none
      const auto known = [](double v) { return std::isfinite(v) ? v : 0.0; };
      const double bend = i > 0 && i + 1 < r.rows() ? r.F_N[i - 1] - 2.0 * r.F_N[i] + r.F_N[i + 1] : 0.0;
      Row x;
      x << 1.0, r.F_N[i], known(r.rate_N_per_s[i]), known(bend), r.F_N[i] * r.F_N[i], std::sqrt(std::max(0.0, r.F_N[i])),
          warmth[i] * r.F_N[i], warmth[i], std::expm1(-rate * since) * (r.F_N[i] - F_min_N), r.U_V[i];
      M += x * x.transpose();
    }
    // a column of nothing takes no part
    for (int j = 0; j < kOutput; ++j)
      if (!(M(j, j) > 0.0)) M(j, j) = 1.0;
    return M;
  };
  // Of all that the force does at a time: which column has it is arbitrary where two say the same, as F and F'' of a sine do.
  const auto slope = [&](const Moments& M, const Eigen::VectorXd& c) {
    const auto with_force = [&](int j) { return M(j, kForce) - M(0, j) * M(0, kForce) / n; };
    double sum = 0.0;
    for (int j = kForce; j <= kCurves; ++j) sum += c[j] * with_force(j);
    return sum / std::max(1e-300, with_force(kForce));
  };
  // a decay that the temperature happens to go with would need a sensor that no maker sells
  const Moments timeless = moments_at(0.0);
  const Eigen::VectorXd warm = fit(timeless, kDecay).first;
  if (!(std::abs(warm[kWarmGain]) < kMostPerDegree * std::abs(slope(timeless, warm)))) std::ranges::fill(warmth, 0.0);
  const auto try_rate = [&](double rate) {
    const Moments M = moments_at(rate);
    best.static_mean_square = fit(M, kDecay).second;
    const auto [c, mean_square] = fit(M, kDecay + 1);
    const double whole = slope(M, c), depth = whole != 0.0 ? c[kDecay] / whole : 0.0;
    if (!(depth > 0.0 && depth < 1.1) || mean_square >= best.mean_square) return;
    best.mean_square = mean_square;
    best.rate_per_s = rate;
    best.depth = std::min(depth, 0.99);
  };
  const double fastest = std::log(0.3), slowest = std::log(0.3 / longest), between = (fastest - slowest) / (kRates - 1);
  for (int step = 0; step < kRates; ++step) try_rate(std::exp(slowest + step * between));
  for (double h = 0.5 * between; rates == Rates::between && best.rate_per_s > 0.0 && h > kFinest; h *= 0.5) {
    const double middle = std::log(best.rate_per_s);
    for (const double rate : {middle - h, middle + h})
      if (rate >= slowest && rate <= fastest) try_rate(std::exp(rate));
  }
  // nothing decays: a straight line is a decay of no depth
  best.mean_square = std::min(best.mean_square, best.static_mean_square);
  return best;
}

// Of what the other columns leave; of the swing.
struct Least {
  double share, depth;
};
constexpr Least kAlone{0.6, 0.03}, kBesideOthers{0.1, 0.005}, kPlain{0.95, 0.03};

bool exceeds(const OwnDecay& own, const Least& least) { return own.mean_square < (1.0 - least.share) * own.static_mean_square && own.depth > least.depth; }

}  // namespace

OwnDecay own_decay(const RecordInput& record, const std::vector<std::size_t>& rows, Rates rates) { return decay_about(record.F_min_N, record, rows, rates); }

bool OwnDecay::is_decay(bool others_decay) const { return exceeds(*this, others_decay ? kBesideOthers : kAlone); }

bool some_decay(const std::vector<OwnDecay>& records) {
  return std::ranges::any_of(records, [](const OwnDecay& own) { return own.is_decay(); });
}

bool decays_by_itself(const RecordInput& record) {
  return own_decay(record, choose_rows(record, kRows)).is_decay();
}

bool decays_plainly(const RecordInput& record) { return exceeds(own_decay(record, choose_rows(record, kRows)), kPlain); }

double lowest_force_of_decay(const RecordInput& record) {
  constexpr double kClearly = 0.7;  // of the mean square
  if (record.other_F_min_N.empty()) return record.F_min_N;
  const std::vector<std::size_t> rows = choose_rows(record, kRows);
  double found = record.F_min_N, least = kClearly * own_decay(record, rows).mean_square;
  for (const double other : record.other_F_min_N) {
    const OwnDecay own = decay_about(other, record, rows);
    if (!own.is_decay() || own.mean_square >= least) continue;
    found = other;
    least = own.mean_square;
  }
  return found;
}

void settle_excitations(std::vector<RecordInput>& records, unsigned threads) {
  std::vector<OwnDecay> own(records.size());
  parallel_for(records.size(), threads, [&](std::size_t k) {
    RecordInput& r = records[k];
    if (!r.dynamic) return;
    r.F_min_N = lowest_force_of_decay(r);
    own[k] = own_decay(r, choose_rows(r, kRows));
  });
  const bool others_decay = some_decay(own);
  for (std::size_t k = 0; k < records.size(); ++k) {
    RecordInput& r = records[k];
    if (!r.dynamic || !r.dynamic_assumed || own[k].is_decay(others_decay)) continue;
    r.found_static = true;
    // a change of frequency may show where nothing decays too
    std::vector<double> jumps_s = std::move(r.frequency_jumps_s), ratios = std::move(r.jump_log_ratio);
    const double lowest_N = r.F_min_N;
    set_static(r);
    r.frequency_jumps_s = std::move(jumps_s), r.jump_log_ratio = std::move(ratios);
    r.jumps_F_min_N = lowest_N;
  }
}

double left_by_decay(const RecordInput& record) {
  return own_decay(record, choose_rows(record, kRows), Rates::between).mean_square;
}

bool none_decays(const CampaignInput& campaign) {
  return std::ranges::any_of(campaign.records, &RecordInput::found_static) &&
         std::ranges::none_of(campaign.records, [](const RecordInput& r) { return r.dynamic && !r.found_static; });
}

}  // namespace forcegate::diagnose
