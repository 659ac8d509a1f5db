#include "hil/diagnose/base/some_columns.h"

#include <numeric>

namespace forcegate::diagnose {

using Eigen::Index;
using Eigen::VectorXd;

MixedProblem with_columns(const MixedProblem& p, const std::vector<int>& columns) {
  MixedProblem out;
  out.nz = p.nz;
  out.n_fixed = p.n_fixed;
  out.ns = static_cast<int>(columns.size());
  out.component_of_z = p.component_of_z;
  out.components = p.components;
  out.fixed_prior_sd = p.fixed_prior_sd;
  out.column_prior_sd.resize(out.ns);
  if (p.column_prior_mean.size() > 0) out.column_prior_mean.resize(out.ns);
  if (!p.grows_with_gain.empty())
    for (const int j : columns) out.grows_with_gain.push_back(p.grows_with_gain[static_cast<std::size_t>(j)]);
  std::vector<int> at;
  for (int j = 0; j < p.nz; ++j) at.push_back(j);
  for (std::size_t a = 0; a < columns.size(); ++a) {
    out.column_prior_sd[static_cast<Index>(a)] = p.column_prior_sd[columns[a]];
    if (out.column_prior_mean.size() > 0) out.column_prior_mean[static_cast<Index>(a)] = p.column_prior_mean[columns[a]];
    at.push_back(p.nz + columns[a]);
  }
  at.push_back(p.y_index());
  for (const RecordGram& from : p.records)
    out.records.push_back({from.name, from.gram(at, at), from.n_eff, from.noise_variance, from.allowed_variance, from.smoothed_variance, from.heldout});
  return out;
}

MixedFit with_columns(MixedFit fit, const std::vector<int>& columns) {
  const Index fixed = fit.coefficient.size() - std::ssize(fit.columns);
  fit.coefficient = (VectorXd(fixed + std::ssize(columns)) << fit.coefficient.head(fixed), fit.strengths_of(columns)).finished();
  fit.columns.resize(columns.size());
  std::iota(fit.columns.begin(), fit.columns.end(), 0);
  return fit;
}

}  // namespace forcegate::diagnose
