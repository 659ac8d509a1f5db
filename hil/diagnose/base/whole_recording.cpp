#include "hil/diagnose/base/whole_recording.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "hil/diagnose/base/judge.h"

namespace forcegate::diagnose {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

double mean(const std::vector<double>& v) {
  double sum = 0.0;
  for (const double x : v) sum += x;
  return v.empty() ? 0.0 : sum / static_cast<double>(v.size());
}

// Mean square that the fixed columns and `waves` half waves over the recording leave.
double left_by_course(const CampaignInput& input, const ResidualChannel& channel, int waves) {
  const MixedProblem& p = channel.problem;
  double first_s = 1e300, last_s = -1e300;
  for (const RecordInput& r : input.records)
    if (!r.t_s.empty()) {
      first_s = std::min(first_s, r.t_s.front());
      last_s = std::max(last_s, r.t_s.back());
    }
  const Index n = p.n_fixed + waves + 1;
  MatrixXd gram = MatrixXd::Zero(n, n);
  double rows = 0.0;
  for (std::size_t k = 0; k < channel.rows.size(); ++k) {
    const RecordRows& part = channel.rows[k];
    const RecordInput& r = input.records[channel.record_of[k]];
    MatrixXd A(part.matrix.rows(), n);
    A.leftCols(p.n_fixed) = part.matrix.leftCols(p.n_fixed);
    for (Index i = 0; i < A.rows(); ++i) {
      const double phase = std::numbers::pi * (r.t_s[part.row[static_cast<std::size_t>(i)]] - first_s) / (last_s - first_s);
      for (int w = 0; w < waves; ++w) A(i, p.n_fixed + w) = std::cos((w + 1) * phase);
    }
    A.col(n - 1) = part.matrix.col(part.matrix.cols() - 1);
    gram += A.transpose() * A;
    rows += static_cast<double>(A.rows());
  }
  MatrixXd M = gram.topLeftCorner(n - 1, n - 1);
  M.diagonal().array() += 1e-12 * (1.0 + M.diagonal().maxCoeff());
  const VectorXd y = gram.col(n - 1).head(n - 1);
  return std::max(0.0, gram(n - 1, n - 1) - y.dot(M.ldlt().solve(y))) / std::max(1.0, rows);
}

}  // namespace

bool is_down_to_noise(const ResidualChannel& channel, const MixedFit& fit) {
  for (std::size_t k = 0; k < fit.plain.size(); ++k) {
    const RecordGram& part = channel.problem.records[k];
    if (fit.plain[k] > kToItsNoise * kToItsNoise * (part.allowed_variance + part.smoothed_variance)) return false;
  }
  return fit.valid;
}

bool describes_whole(const CampaignInput& input, const ResidualChannel& channel, const MixedFit& base, const MixedFit& fit) {
  constexpr double kFarAbove = 4.0, kFarBetterThanCourse = 2.0;  // RMS
  constexpr int kFewestWaves = 6;
  if (!base.valid || !is_down_to_noise(channel, fit)) return false;
  const double left = mean(fit.plain);
  if (mean(base.plain) < kFarAbove * kFarAbove * left) return false;
  const int waves = std::max(kFewestWaves, static_cast<int>(fit.columns.size()) - static_cast<int>(base.columns.size()));
  return left_by_course(input, channel, waves) > kFarBetterThanCourse * kFarBetterThanCourse * left;
}

bool whole_must_judge(const Workspace& w, const MixedFit& base, const MixedFit& fit) {
  if (!w.input.single || w.zero_wanders || !describes_whole(w.input, w.output, base, fit)) return false;
  const double left_out = judged(w.output, judge(w.output, fit, base, JudgedBy::left_out).plain, JudgedBy::left_out);
  return std::sqrt(left_out) > kToItsNoise * allowed_rms(w.output);
}

}  // namespace forcegate::diagnose
