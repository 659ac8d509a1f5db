#include "hil/diagnose/between/record_scatter.h"

#include <algorithm>
#include <utility>

namespace forcegate::diagnose {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr int kScatters = 24;
constexpr double kFactor = 3.0;  // one standard deviation of the prior of s

using Choices = std::vector<std::pair<double, double>>;  // ratio, prior
const Choices kNone = {{0.0, 1.0}};

Choices session_ratios(const RecordSeries& series) {
  std::vector<int> distinct = series.session;
  std::sort(distinct.begin(), distinct.end());
  distinct.erase(std::unique(distinct.begin(), distinct.end()), distinct.end());
  if (distinct.size() < 2 || distinct.size() == series.session.size()) return kNone;
  return {{0.0, 0.4}, {1.0, 0.2}, {10.0, 0.2}, {100.0, 0.2}};
}

// A few records that are not cyclic are needed to tell that the cyclic ones scatter more.
Choices cyclic_ratios(const RecordSeries& series) {
  constexpr std::ptrdiff_t kFewestStatic = 3;
  const auto cyclic = std::count(series.cyclic.begin(), series.cyclic.end(), 1);
  const auto n = static_cast<std::ptrdiff_t>(series.cyclic.size());
  if (cyclic == 0 || n - cyclic < kFewestStatic) return kNone;
  return {{0.0, 0.4}, {10.0, 0.2}, {100.0, 0.2}, {1000.0, 0.2}};
}

// From the first record to the last; 0: no course is a rival.
double whole_time_s(const RecordSeries& series) {
  if (series.start_s.empty()) return 0.0;
  const auto [first, last] = std::ranges::minmax(series.start_s);
  return last - first;
}

}  // namespace

std::vector<RecordStructure> structures(const RecordSeries& series) {
  constexpr double kOfCourses = 0.5;  // of the prior, where a course is a rival
  std::vector<RecordStructure> courses;
  if (const double all_s = whole_time_s(series); all_s > 0.0)
    for (const double ratio : {10.0, 100.0, 1000.0}) {
      courses.push_back({.course = ratio, .course_s = all_s, .smooth = false});
      for (const double part : {0.2, 0.6}) courses.push_back({.course = ratio, .course_s = part * all_s, .smooth = true});
    }
  const double rest = courses.empty() ? 1.0 : 1.0 - kOfCourses, each = courses.empty() ? 0.0 : kOfCourses / static_cast<double>(courses.size());
  std::vector<RecordStructure> out;
  for (const auto& [cyclic, of_cyclic] : cyclic_ratios(series)) {
    for (const auto& [session, of_session] : session_ratios(series)) out.push_back({.session = session, .cyclic = cyclic, .prior = rest * of_session * of_cyclic});
    for (RecordStructure course : courses) {
      course.cyclic = cyclic;
      course.prior = each * of_cyclic;
      out.push_back(course);
    }
  }
  return out;
}

MatrixXd covariance(const RecordSeries& series, double scatter, const RecordStructure& more) {
  const double session = more.session, cyclic = more.cyclic;
  const Index n = series.value.size();
  const double s2 = scatter * scatter;
  MatrixXd out = MatrixXd::Zero(n, n);
  out.diagonal() = series.variance.array() + s2;
  if (cyclic > 0.0)
    for (Index a = 0; a < n; ++a)
      if (series.cyclic[static_cast<std::size_t>(a)] != 0) out(a, a) += cyclic * s2;
  constexpr double kAlike = 1000.0;
  for (std::size_t a = 0; a < series.alike.size(); ++a)
    for (std::size_t b = 0; b < series.alike.size(); ++b)
      if (series.alike[a] != 0 && series.alike[b] != 0) out(static_cast<Index>(a), static_cast<Index>(b)) += kAlike * s2;
  if (session > 0.0)
    for (Index a = 0; a < n; ++a)
      for (Index b = 0; b < n; ++b)
        if (series.session[static_cast<std::size_t>(a)] == series.session[static_cast<std::size_t>(b)]) out(a, b) += session * s2;
  if (more.course > 0.0)
    for (Index a = 0; a < n; ++a)
      for (Index b = 0; b < n; ++b) {
        const double apart = std::abs(series.start_s[static_cast<std::size_t>(a)] - series.start_s[static_cast<std::size_t>(b)]) / more.course_s;
        out(a, b) += more.course * s2 * std::exp(more.smooth ? -0.5 * apart * apart : -apart);
      }
  return out;
}

std::vector<Scatter> scatters(const RecordSeries& series) {
  const VectorXd d = series.value.array() - series.value.mean();
  const double spread = std::sqrt(d.squaredNorm() / static_cast<double>(std::max<Index>(1, d.size() - 1)));
  const double low = std::max(series.typical_scatter / 12.0, spread / 40.0), high = std::max(2.0 * low, 2.0 * spread);
  std::vector<Scatter> out;
  for (int k = 0; k < kScatters; ++k) {
    const double s = low * std::pow(high / low, k / (kScatters - 1.0)), away = std::log(s / series.typical_scatter) / std::log(kFactor);
    out.push_back({s, -0.5 * away * away});
  }
  return out;
}

double log_variance(double scatter, const RecordStructure& more) { return std::log(scatter * scatter * (1.0 + more.session + more.course)); }

Whitened whiten(const RecordSeries& series, const MatrixXd& C, const MatrixXd& columns) {
  const Index n = series.value.size();
  const Eigen::LLT<MatrixXd> llt(C);
  MatrixXd B(n, columns.cols() + 2);
  B.col(0).setOnes();
  B.col(1) = series.value;
  B.rightCols(columns.cols()) = columns;
  llt.matrixL().solveInPlace(B);
  const double square = B.col(0).squaredNorm();
  const VectorXd one = B.col(0) / std::sqrt(square);
  B.rightCols(B.cols() - 1) -= one * (one.transpose() * B.rightCols(B.cols() - 1));
  Whitened out;
  out.y = B.col(1);
  out.columns = B.rightCols(columns.cols());
  out.log_null = -half_log_det(MatrixXd(llt.matrixL())) - 0.5 * std::log(square) - 0.5 * out.y.squaredNorm();
  return out;
}

}  // namespace forcegate::diagnose
