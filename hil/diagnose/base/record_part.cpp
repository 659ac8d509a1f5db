#include "hil/diagnose/base/record_part.h"

#include <algorithm>
#include <cmath>

namespace forcegate::diagnose {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Rows are padded to whole lanes, which stay in registers while earlier rows are taken off.
constexpr Index kLane = 8;
using Lane = Eigen::Array<double, kLane, 1>;

Index padded(Index n) { return (n + kLane - 1) / kLane * kLane; }
Eigen::Map<const Lane> lane(const double* at) { return Eigen::Map<const Lane>(at); }
Eigen::Map<Lane> lane(double* at) { return Eigen::Map<Lane>(at); }
std::size_t at(Index i) { return static_cast<std::size_t>(i); }
// What is no number stays none.
double not_below_zero(double square) { return square < 0.0 ? 0.0 : square; }

// Of a column of S that is a gain: by how much of one in this record, by regression on Z_0 and one; 0 of another, and where the force
// stands still.
double gain_of_column(const MixedProblem& problem, const MatrixXd& gram, int column) {
  constexpr double kSingular = 1e-9;
  if (problem.grows_with_gain.empty() || problem.grows_with_gain[at(column)] != GrowsWithGain::is_gain) return 0.0;
  const double WW = gram(0, 0), W1 = gram(0, 1), one = gram(1, 1), determinant = WW * one - W1 * W1;
  const int j = problem.nz + column;
  return determinant > kSingular * WW * one ? (one * gram(0, j) - W1 * gram(1, j)) / determinant : 0.0;
}

}  // namespace

RecordPart::RecordPart(const MixedProblem& problem, std::size_t record, const std::vector<int>& columns)
    : n_fixed_(problem.n_fixed), n_z_(problem.nz) {
  const MatrixXd& gram = problem.records[record].gram;
  for (int j = 0; j < problem.nz; ++j)
    if (gram(j, j) != 0.0) excited_.push_back(j);
  std::vector<Index> c;
  for (int j = 0; j < problem.n_fixed; ++j) c.push_back(j);
  for (int j : columns) c.push_back(problem.nz + j);
  c.push_back(problem.y_index());
  const auto n = static_cast<Index>(excited_.size());
  n_columns_ = static_cast<Index>(c.size());
  stride_ = padded(n_columns_);
  const Index first = padded(n);
  identity_ = first + stride_;
  width_ = identity_ + first;
  source_.assign(at(n * width_), 0.0);
  rows_.assign(at(n * width_), 0.0);
  gram_.assign(at(n_columns_ * stride_), 0.0);
  for (Index a = 0; a < n_columns_; ++a) {
    const double* column = gram.data() + c[at(a)] * gram.rows();
    for (Index i = 0; i < n; ++i) source_[at(i * width_ + first + a)] = column[excited_[at(i)]];
    for (Index b = 0; b < n_columns_; ++b) gram_[at(a * stride_ + b)] = column[c[at(b)]];
  }
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < n; ++j) source_[at(i * width_ + j)] = gram(excited_[at(j)], excited_[at(i)]);
  if (!problem.other_y.empty()) {
    const VectorXd& y = problem.other_y[record];
    const Index last = n_columns_ - 1;
    for (Index i = 0; i < n; ++i) source_[at(i * width_ + first + last)] = y[excited_[at(i)]];
    for (Index b = 0; b < n_columns_; ++b)
      gram_[at(b * stride_ + last)] = gram_[at(last * stride_ + b)] = y[c[at(b)]];
  }
  find_gains(problem, gram, columns);
}

void RecordPart::find_gains(const MixedProblem& problem, const MatrixXd& gram, const std::vector<int>& columns) {
  grows_ = !problem.grows_with_gain.empty() && !excited_.empty();
  if (!grows_) return;
  gain_ = VectorXd::Zero(n_columns_);
  for (std::size_t b = 0; b < columns.size(); ++b) gain_[n_fixed_ + static_cast<Index>(b)] = gain_of_column(problem, gram, columns[b]);
  has_gains_ = !gain_.isZero(0.0);
  // without columns that are gains, zeta_0's row alone will change
  as_given_.source.assign(source_.begin(), has_gains_ ? source_.end() : source_.begin() + width_);
  if (has_gains_) as_given_.gram = gram_;
  h_C_.resize(n_columns_);
  h_Z_.resize(static_cast<Index>(excited_.size()));
}

void RecordPart::set_own_gain(const VectorXd& per_gain) {
  if (!grows_) return;
  const auto n = static_cast<Index>(excited_.size()), first = padded(n), n_s = per_gain.size();
  std::copy(as_given_.source.begin(), as_given_.source.end(), source_.begin());
  if (has_gains_) gram_ = as_given_.gram;
  for (Index i = 1; i < n; ++i) source_[at(i * width_)] = source_[at(i)];
  if (n_s == 0) return;
  // h = C per_gain and its products; every column that is a gain g of the record goes with g h more
  for (Index a = 0; a < n_columns_; ++a) h_C_[a] = per_gain.dot(VectorXd::Map(gram_.data() + a * stride_, n_s));
  for (Index i = 0; i < n; ++i) h_Z_[i] = per_gain.dot(VectorXd::Map(source_.data() + i * width_ + first, n_s));
  const double hh = per_gain.dot(h_C_.head(n_s));
  if (has_gains_) {
    for (Index a = 0; a < n_columns_; ++a)
      for (Index b = 0; b < n_columns_; ++b) gram_[at(a * stride_ + b)] += gain_[a] * h_C_[b] + gain_[b] * h_C_[a] + gain_[a] * gain_[b] * hh;
    for (Index i = 0; i < n; ++i)
      for (Index a = 0; a < n_columns_; ++a) source_[at(i * width_ + first + a)] += gain_[a] * h_Z_[i];
  }
  if (excited_.front() != 0) return;
  for (Index a = 0; a < n_columns_; ++a) source_[at(first + a)] += h_C_[a] + gain_[a] * hh;
  for (Index j = 0; j < n; ++j) {
    source_[at(j)] += h_Z_[j];
    source_[at(j * width_)] += h_Z_[j];
  }
  source_[0] += hh;
}

double RecordPart::gain(const VectorXd& coefficient, double zeta_0) const {
  return grows_ ? zeta_0 + gain_.head(coefficient.size()).dot(coefficient) : 0.0;
}

MatrixXd RecordPart::own_with_own() const {
  MatrixXd out = MatrixXd::Zero(n_z_, n_z_);
  for (std::size_t i = 0; i < excited_.size(); ++i)
    for (std::size_t j = 0; j < excited_.size(); ++j) out(excited_[i], excited_[j]) = source_[i * at(width_) + j];
  return out;
}

MatrixXd RecordPart::own_with_columns() const {
  const Index first = identity_ - stride_;
  MatrixXd out = MatrixXd::Zero(n_z_, n_columns_);
  for (std::size_t i = 0; i < excited_.size(); ++i)
    out.row(excited_[i]) = VectorXd::Map(source_.data() + static_cast<Index>(i) * width_ + first, n_columns_).transpose();
  return out;
}

void RecordPart::eliminate(const VectorXd& sigma2, double weight) {
  weight_ = weight;
  const auto n = static_cast<Index>(excited_.size());
  sigma2_.resize(n);
  for (Index i = 0; i < n; ++i) sigma2_[i] = sigma2[excited_[at(i)]];
  for (Index i = 0; i < n; ++i) {
    double* row = rows_.data() + i * width_;
    const double* source = source_.data() + i * width_;
    const Index from = i / kLane * kLane;
    for (Index k = from; k < width_; k += kLane) lane(row + k) = weight * lane(source + k);
    row[i] += 1.0 / sigma2_[i];
    row[identity_ + i] = 1.0;
    const Index end = identity_ + from + kLane;  // L^-1 is lower triangular
    for (Index k = from; k < end; k += kLane) {
      Lane rest = lane(row + k);
      const double* above = rows_.data();
      for (Index j = std::max<Index>(0, k - identity_); j < i; ++j)
        rest -= above[j * width_ + i] * lane(above + j * width_ + k);
      lane(row + k) = rest;
    }
    const double per_pivot = 1.0 / std::sqrt(row[i]);
    for (Index k = from; k < end; k += kLane) lane(row + k) *= per_pivot;
  }
}

void RecordPart::add_marginal(MatrixXd& total) const {
  const auto n = static_cast<Index>(excited_.size());
  const double* X = rows_.data() + identity_ - stride_;
  for (Index a = 0; a < n_columns_; ++a) {
    double* column = total.data() + a * total.rows();
    for (Index k = a / kLane * kLane; k < stride_; k += kLane) {
      Lane sum = lane(column + k) + weight_ * lane(gram_.data() + a * stride_ + k);
      for (Index i = 0; i < n; ++i) sum -= X[i * width_ + a] * lane(X + i * width_ + k);
      lane(column + k) = sum;
    }
  }
}

MatrixXd RecordPart::marginal() const {
  MatrixXd out = MatrixXd::Zero(stride_, n_columns_);
  add_marginal(out);
  return out;
}

void RecordPart::condition(const VectorXd& v, Conditional& out) const {
  const auto n = static_cast<Index>(excited_.size());
  VectorXd zeta = VectorXd::Zero(padded(n)), variance = zeta;
  double followed = 0.0;
  for (Index i = 0; i < n; ++i) {
    const double* row = rows_.data() + i * width_;
    const double u = VectorXd::Map(row + identity_ - stride_, n_columns_).dot(v);
    followed += u * u;
    const double* inverse = row + identity_;
    for (Index k = 0; k <= i; k += kLane) {
      lane(zeta.data() + k) += u * lane(inverse + k);
      lane(variance.data() + k) += lane(inverse + k).square();
    }
  }
  out.zeta = VectorXd::Zero(n_z_);
  out.zeta_variance = VectorXd::Zero(n_z_);
  out.penalty = 0.0;
  double certain = 0.0;
  for (Index i = 0; i < n; ++i) {
    out.zeta[excited_[at(i)]] = zeta[i];
    out.zeta_variance[excited_[at(i)]] = variance[i];
    out.penalty += zeta[i] * zeta[i] / sigma2_[i];
    certain += variance[i] / sigma2_[i];
  }
  out.trace = (static_cast<double>(n) - certain) / weight_;
  out.mean_square = not_below_zero(plain(v) - (followed + out.penalty) / weight_);
}

double RecordPart::log_determinant() const {
  double out = 0.0;
  for (Index i = 0; i < sigma2_.size(); ++i)
    out += 2.0 * std::log(rows_[at(i * width_ + i)]) + std::log(sigma2_[i]);
  return out;
}

double RecordPart::plain(const VectorXd& v) const {
  double out = 0.0;
  for (Index a = 0; a < n_columns_; ++a)
    out += v[a] * VectorXd::Map(gram_.data() + a * stride_, n_columns_).dot(v);
  return not_below_zero(out);
}

}  // namespace forcegate::diagnose
