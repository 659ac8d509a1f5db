#include "hil/diagnose/base/left_out.h"

#include <algorithm>
#include <cmath>

namespace forcegate::diagnose {

namespace {

using Eigen::Index;

constexpr int kBlocksOfARecord = 4, kFewestRecords = 3;

struct Parts {
  std::vector<double> before, after, floor;
  std::vector<char> excited;
  int n_excited = 0;
};

bool moves(double before, double after, double floor) {
  return std::abs(before - after) > 0.1 * floor + 0.02 * before;
}

Parts compare(const MixedProblem& problem, const MixedFit& before, const MixedFit& after) {
  Parts out;
  out.before = leave_one_out(problem, before, &before).adapted;
  out.after = leave_one_out(problem, after, &before).adapted;
  for (std::size_t i = 0; i < problem.records.size(); ++i) {
    out.floor.push_back(problem.records[i].allowed_variance);
    out.excited.push_back(moves(before.adapted[i], after.adapted[i], out.floor.back()) ? 1 : 0);
    out.n_excited += out.excited.back();
  }
  return out;
}

// The same campaign with every record cut into contiguous blocks; only the columns that the fits use are carried.
struct Blocks {
  MixedProblem problem;
  MixedFit before, after;
};

MixedFit on_blocks(const MixedFit& fit, const std::vector<int>& columns,
                   const std::vector<std::size_t>& record_of) {
  MixedFit out = fit;
  out.columns.clear();
  for (int j : fit.columns)
    out.columns.push_back(static_cast<int>(std::find(columns.begin(), columns.end(), j) - columns.begin()));
  out.s2.clear();
  for (const std::size_t i : record_of) out.s2.push_back(fit.s2[i]);
  out.use = RecordUse::all_records;
  return out;
}

Blocks cut(const ResidualChannel& channel, const MixedFit& before, const MixedFit& after) {
  const MixedProblem& p = channel.problem;
  std::vector<int> columns = after.columns;
  for (int j : before.columns)
    if (std::find(columns.begin(), columns.end(), j) == columns.end()) columns.push_back(j);
  Blocks out;
  out.problem = MixedProblem{};
  out.problem.nz = p.nz;
  out.problem.n_fixed = p.n_fixed;
  out.problem.ns = static_cast<int>(columns.size());
  out.problem.component_of_z = p.component_of_z;
  out.problem.components = p.components;
  out.problem.fixed_prior_sd = p.fixed_prior_sd;
  out.problem.column_prior_sd.resize(out.problem.ns);
  for (std::size_t a = 0; a < columns.size(); ++a)
    out.problem.column_prior_sd[static_cast<Index>(a)] = p.column_prior_sd[columns[a]];
  if (p.column_prior_mean.size() > 0) out.problem.column_prior_mean = p.column_prior_mean(columns);
  if (!p.grows_with_gain.empty())
    for (const int j : columns) out.problem.grows_with_gain.push_back(p.grows_with_gain[static_cast<std::size_t>(j)]);
  std::vector<std::size_t> record_of;
  for (std::size_t k = 0; k < p.records.size(); ++k) {
    const Eigen::MatrixXd& A = channel.rows[k].matrix;
    const Index n = A.rows();
    for (int b = 0; b < kBlocksOfARecord; ++b) {
      const Index begin = n * b / kBlocksOfARecord, end = n * (b + 1) / kBlocksOfARecord;
      if (end - begin < 20) continue;
      Eigen::MatrixXd part(end - begin, p.nz + out.problem.ns + 1);
      part.leftCols(p.nz) = A.middleRows(begin, end - begin).leftCols(p.nz);
      for (std::size_t a = 0; a < columns.size(); ++a)
        part.col(p.nz + static_cast<Index>(a)) = A.col(p.nz + columns[a]).segment(begin, end - begin);
      part.col(part.cols() - 1) = A.col(p.y_index()).segment(begin, end - begin);
      RecordGram g = p.records[k];
      g.gram = (part.transpose() * part) / static_cast<double>(part.rows());
      g.n_eff = p.records[k].n_eff / kBlocksOfARecord;
      g.heldout = false;
      out.problem.records.push_back(std::move(g));
      record_of.push_back(k);
    }
  }
  out.before = on_blocks(before, columns, record_of);
  out.after = on_blocks(after, columns, record_of);
  return out;
}

}  // namespace

CrossFit cross_fit(const ResidualChannel& channel, const MixedFit& before, const MixedFit& after) {
  Parts parts = compare(channel.problem, before, after);
  CrossFit out;
  out.blocks = parts.n_excited < kFewestRecords;
  if (out.blocks) {
    Blocks blocks = cut(channel, before, after);
    // in-sample errors of the blocks at the fitted strengths tell which of them the effect moves
    blocks.before.adapted = adapted_errors(blocks.problem, blocks.before, blocks.before);
    blocks.after.adapted = adapted_errors(blocks.problem, blocks.after, blocks.before);
    parts = compare(blocks.problem, blocks.before, blocks.after);
  }
  out.parts = static_cast<int>(parts.before.size());
  out.excited = parts.n_excited;
  double squares = 0.0, logs = 0.0, log_squares = 0.0, explainable = 0.0, removed = 0.0;
  const double n = std::max(1, out.parts);
  for (std::size_t i = 0; i < parts.before.size(); ++i) {
    const double d = parts.before[i] - parts.after[i];
    out.before += parts.before[i] / n;
    out.after += parts.after[i] / n;
    // a restless record that the effect does not move must not outweigh those that it does
    if (parts.excited[i] != 0 || out.blocks) {
      out.fall += d / n;
      squares += d * d;
    }
    if (parts.excited[i] == 0) continue;
    const double ratio =
        std::log((parts.before[i] + 0.1 * parts.floor[i]) / (parts.after[i] + 0.1 * parts.floor[i]));
    out.improved += d > 0.0 ? 1 : 0;
    (ratio > 0.0 ? out.fallen : out.risen) += std::abs(ratio);
    if (std::max(parts.before[i], parts.after[i]) > parts.floor[i]) {
      ++out.voting;
      out.in_favour += d > 0.0 ? 1 : 0;
    }
    logs += ratio;
    log_squares += ratio * ratio;
    removed += d;
    explainable += std::max(parts.before[i] - parts.floor[i], 0.0) + 1e-12;
  }
  out.standard_error = std::sqrt(std::max(0.0, squares / n - out.fall * out.fall) / std::max(1.0, n - 1.0));
  if (out.excited > 0) {
    const double m = out.excited;
    out.log_ratio = logs / m;
    out.log_ratio_error =
        m > 1.0 ? std::sqrt(std::max(0.0, log_squares / m - out.log_ratio * out.log_ratio) / (m - 1.0))
                : std::abs(out.log_ratio);
    out.share = explainable > 0.0 ? removed / explainable : 0.0;
  }
  return out;
}

}  // namespace forcegate::diagnose
