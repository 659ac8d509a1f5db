#pragma once

#include <string>
#include <utility>

#include "hil/diagnose/workspace.h"

namespace forcegate::diagnose {

// Two columns of Z, gain and offset, and `ns` of S; no records yet.
inline ResidualChannel channel_of_lines(int ns, double column_sd) {
  ResidualChannel channel;
  MixedProblem& p = channel.problem;
  p.nz = p.n_fixed = 2;
  p.ns = ns;
  p.component_of_z = {0, 1};
  p.components = {{"gain", 0.02, 0.002, 0.5}, {"offset", 0.01, 0.001, 0.5}};
  p.fixed_prior_sd = Eigen::Vector2d(10.0, 10.0);
  p.column_prior_sd = Eigen::VectorXd::Constant(ns, column_sd);
  return channel;
}

// Rows of [Z, S, y].
inline void add_record(ResidualChannel& channel, Eigen::MatrixXd rows, double n_eff, double noise_variance, double allowed_variance) {
  RecordRows kept;
  for (Eigen::Index i = 0; i < rows.rows(); ++i) kept.row.push_back(static_cast<std::size_t>(i));
  RecordGram g;
  g.name = "r" + std::to_string(channel.rows.size());
  g.gram = (rows.transpose() * rows) / static_cast<double>(rows.rows());
  g.n_eff = n_eff;
  g.noise_variance = noise_variance;
  g.allowed_variance = allowed_variance;
  kept.matrix = std::move(rows);
  channel.record_of.push_back(channel.rows.size());
  channel.problem.records.push_back(std::move(g));
  channel.rows.push_back(std::move(kept));
}

}  // namespace forcegate::diagnose
