#include "hil/diagnose/laws/movement.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <map>

#include "hil/base/quantile.h"
#include "hil/model/record_input.h"
#include "hil/trace/trace.h"

namespace forcegate::diagnose {

namespace {

using Series = std::vector<double>;

Series finite_of(const Series& x) {
  Series out;
  out.reserve(x.size());
  for (const double v : x)
    if (std::isfinite(v)) out.push_back(v);
  return out;
}

double mean_of(const Series& x) {
  double sum = 0.0;
  for (const double v : x) sum += v - x.front();
  return x.front() + sum / static_cast<double>(x.size());
}

void halve(Series& x) {
  const std::size_t n = x.size() / 2;
  for (std::size_t k = 0; k < n; ++k) x[k] = 0.5 * (x[2 * k] + x[2 * k + 1]);
  x.resize(n);
}

struct Noise {
  double typical = 0.0, rms = 0.0;
};

// From second differences, in which a ramp vanishes.
Noise noise_between_neighbours(const Series& x) {
  Series d;
  double square = 0.0;
  d.reserve(x.size());
  for (std::size_t i = 1; i + 1 < x.size(); ++i) {
    const double v = x[i - 1] - 2.0 * x[i] + x[i + 1];
    d.push_back(std::abs(v)), square += v * v;
  }
  const double rms = std::sqrt(square / std::max<double>(1.0, static_cast<double>(d.size())) / 6.0);
  const double typical = deviation_of_magnitudes(std::move(d)) / std::sqrt(6.0);
  return {typical > 1e-9 * rms ? typical : 0.0, rms};
}

// Two or three codes, the rarer ones again and again and mostly for a few samples: what noise makes of a coarse resolution.
bool flickers(const Series& x) {
  constexpr std::size_t kMostCodes = 3, kBrief = 3, kAgain = 8;
  std::map<double, std::size_t> count;
  for (const double v : x)
    if (++count[v]; count.size() > kMostCodes) return false;
  const auto usual = std::ranges::max_element(count, {}, [](const auto& c) { return c.second; })->first;
  std::size_t visits = 0, brief = 0, length = 0;
  for (std::size_t i = 0; i <= x.size(); ++i) {
    if (i < x.size() && x[i] != usual) {
      ++length;
      continue;
    }
    if (length > 0) ++visits, brief += length <= kBrief;
    length = 0;
  }
  return visits >= kAgain && 2 * brief > visits;
}

// Differences of neighbouring means, less their mean, which a steady drift has.
Series steps_of(const Series& x) {
  Series out(x.size() / 2);
  for (std::size_t k = 0; k < out.size(); ++k) out[k] = x[2 * k + 1] - x[2 * k];
  const double mean = mean_of(out);
  for (double& v : out) v -= mean;
  return out;
}

double product_at(const Series& u, const Series& v, std::size_t lag) {
  double sum = 0.0;
  for (std::size_t k = lag; k < u.size(); ++k) sum += u[k] * v[k - lag];
  return sum;
}

// Fisher's z; what hangs together over time counts for fewer (Bartlett), its correlations at far lags taken along a geometric ladder.
bool is_no_chance(const Series& u, const Series& v, double uu, double vv, double uv) {
  constexpr double kSure = 5.0;  // standard errors
  constexpr std::size_t kEveryLag = 16, kLadder = 4;
  const double n = static_cast<double>(u.size()), z = std::atanh(std::min(std::abs(uv) / std::sqrt(uu * vv), 1.0 - 1e-12));
  if (z * std::sqrt(std::max(0.0, n - 3.0)) <= kSure) return false;
  double together = 0.0;
  for (std::size_t lag = 1, next = 0; lag < u.size(); lag = next) {
    next = lag < kEveryLag ? lag + 1 : lag + lag / kLadder;
    const double lags = static_cast<double>(std::min(next, u.size()) - lag);
    together += 2.0 * lags * product_at(u, u, lag) / uu * (product_at(v, v, lag) / vv);
  }
  return z * std::sqrt(std::max(0.0, n / (1.0 + std::max(0.0, together)) - 3.0)) > kSure;
}

// A cycle that comes again and again hangs together over all lags. It goes the same way in every stretch of the record.
bool lasts(const Series& u, const Series& v) {
  constexpr std::size_t kStretches = 16;
  constexpr double kSure = 8.0;
  double sum = 0.0, square = 0.0;
  for (std::size_t s = 0; s < kStretches; ++s) {
    double product = 0.0;
    for (std::size_t k = s * u.size() / kStretches; k < (s + 1) * u.size() / kStretches; ++k) product += u[k] * v[k];
    sum += product, square += product * product;
  }
  constexpr double n = kStretches;
  const double variance = (square - sum * sum / n) / (n - 1.0);
  return std::abs(sum) > kSure * std::sqrt(n * std::max(0.0, variance));
}

Response response_of(double xx, double xy, double yy) { return {true, std::abs(xy) / xx, yy / std::abs(xy)}; }

// x less its least squares on powers of time up to `degree`.
Eigen::VectorXd without_trend(const Series& x, int degree) {
  const auto n = static_cast<Eigen::Index>(x.size());
  Eigen::MatrixXd basis(n, degree + 1);
  const Eigen::VectorXd t = Eigen::VectorXd::LinSpaced(n, -1.0, 1.0);
  basis.col(0).setOnes();
  for (int k = 1; k <= degree; ++k) basis.col(k) = basis.col(k - 1).cwiseProduct(t);
  const Eigen::Map<const Eigen::VectorXd> y(x.data(), n);
  return y - basis * basis.colPivHouseholderQr().solve(y);
}

Pairs finite_pairs(const Series& x, const Series& y) {
  Pairs out;
  for (std::size_t i = 0; i < std::min(x.size(), y.size()); ++i)
    if (std::isfinite(x[i]) && std::isfinite(y[i])) out.x.push_back(x[i]), out.y.push_back(y[i]);
  return out;
}

Series block_means(const Series& x, std::size_t blocks) {
  Series out;
  const std::size_t n = std::min(blocks, x.size());
  for (std::size_t b = 0; b < n; ++b) {
    const std::size_t from = b * x.size() / n, to = (b + 1) * x.size() / n;
    double sum = 0.0;
    for (std::size_t i = from; i < to; ++i) sum += x[i] - x.front();
    out.push_back(x.front() + sum / static_cast<double>(to - from));
  }
  return out;
}

constexpr std::size_t kBlocks = 128, kFewest = 16;  // of the course of a record
constexpr int kTrend = 3;                           // degree in time

}  // namespace

Movement movement_of(const std::vector<double>& samples) {
  constexpr double kBeyondTheLargest = 2.0;  // of white noise: the largest of n stands near sqrt(2 ln n)
  constexpr std::size_t kFewestMeans = 4;
  Movement out;
  Series x = finite_of(samples);
  if (x.empty()) return out;
  out.level = mean_of(x);
  const auto [low, high] = std::ranges::minmax(x);
  if (!(high > low)) return out;
  const Noise noise = noise_between_neighbours(x);
  out.noise = noise.typical;
  if (flickers(x)) {
    out.noise = std::max(noise.typical, noise.rms);
    return out;
  }
  const double n = static_cast<double>(x.size()), far = std::sqrt(2.0 * std::log(n)) + kBeyondTheLargest;
  double samples_of_mean = 1.0;
  for (; x.size() >= kFewestMeans; halve(x), samples_of_mean *= 2.0) {
    const double noise_of_mean = out.noise / std::sqrt(samples_of_mean), limit = far * noise_of_mean;
    const double largest = std::sqrt(2.0 * std::log(static_cast<double>(x.size()))) * noise_of_mean;
    double above = 0.0, below = 0.0;
    for (const double v : x) {
      const double off = v - out.level;
      if (off > limit) above = std::max(above, off - largest);
      if (off < -limit) below = std::max(below, -off - largest);
    }
    out.excursion = std::max(out.excursion, above + below);
  }
  return out;
}

bool is_noise_that_hangs_together(const std::vector<double>& samples) {
  constexpr std::size_t kBlocks = 256;
  constexpr double kOfBell = 3.0, kNear = 0.4, kAboutZero = 0.125;
  const Series x = finite_of(samples);
  if (x.size() < 2 * kBlocks) return false;
  const double mean = mean_of(x);
  double second = 0.0, fourth = 0.0, furthest = 0.0;
  for (const double v : x) {
    const double square = (v - mean) * (v - mean);
    second += square, fourth += square * square, furthest = std::max(furthest, square);
  }
  const double n = static_cast<double>(x.size());
  if (!(second > 0.0) || std::abs(fourth * n / (second * second) - kOfBell) > kNear) return false;
  return std::abs(mean) < kAboutZero * std::sqrt(furthest) && !movement_of(block_means(x, kBlocks)).stands_out();
}

std::vector<double> at_times(const std::vector<double>& from_s, const std::vector<double>& y, const std::vector<double>& to_s) {
  Series t, v;
  for (std::size_t i = 0; i < y.size(); ++i)
    if (std::isfinite(y[i])) t.push_back(from_s[i]), v.push_back(y[i]);
  Series out(to_s.size(), kMissing);
  std::size_t j = 0;
  for (std::size_t i = 0; i < to_s.size() && t.size() > 1; ++i) {
    while (j + 2 < t.size() && t[j + 1] <= to_s[i]) ++j;
    if (to_s[i] < t[j] || to_s[i] > t[j + 1] || !(t[j + 1] > t[j])) continue;
    out[i] = v[j] + (v[j + 1] - v[j]) * (to_s[i] - t[j]) / (t[j + 1] - t[j]);
  }
  return out;
}

Pairs means_of_pairs(const std::vector<double>& x, const std::vector<double>& y, std::size_t blocks) {
  const auto [a, b] = finite_pairs(x, y);
  return {block_means(a, blocks), block_means(b, blocks)};
}

Response response_by_scale(const std::vector<double>& x, const std::vector<double>& y) {
  constexpr std::size_t kFewest = 16;
  auto [a, b] = finite_pairs(x, y);
  Response best;
  double most = 0.0;
  for (; a.size() >= 2 * kFewest; halve(a), halve(b)) {
    const Series u = steps_of(a), v = steps_of(b);
    const double uu = product_at(u, u, 0), vv = product_at(v, v, 0), uv = product_at(u, v, 0);
    if (!(uu > 0.0 && vv > 0.0) || uv == 0.0) continue;
    const double alike = std::abs(uv) / std::sqrt(uu * vv);
    if (alike > most && (is_no_chance(u, v, uu, vv, uv) || lasts(u, v))) most = alike, best = response_of(uu, uv, vv);
  }
  return best;
}

Response response_as_a_whole(const std::vector<double>& x, const std::vector<double>& y) {
  constexpr double kOfVariance = 0.9;
  const auto [u, v] = means_of_pairs(x, y, kBlocks);
  if (u.size() < kFewest) return {};
  for (const int degree : {0, kTrend}) {
    const Eigen::VectorXd p = without_trend(u, degree), q = without_trend(v, degree);
    const double xx = p.squaredNorm(), yy = q.squaredNorm(), xy = p.dot(q);
    if (xx > 0.0 && yy > 0.0 && xy * xy > kOfVariance * xx * yy) return response_of(xx, xy, yy);
  }
  return {};
}

bool is_one_course(const std::vector<double>& x, const std::vector<double>& y) {
  constexpr double kOfVariance = 0.99;
  constexpr int kFewestCrossings = 10;  // what is left of an exponential crosses zero five times
  const auto [u, v] = means_of_pairs(x, y, kBlocks);
  if (u.size() < kFewest) return false;
  const Eigen::VectorXd p = without_trend(u, kTrend), q = without_trend(v, kTrend);
  int crossings = 0;
  for (Eigen::Index i = 1; i < p.size(); ++i) crossings += (p[i] > 0.0) != (p[i - 1] > 0.0) ? 1 : 0;
  return crossings >= kFewestCrossings && std::pow(p.dot(q), 2) > kOfVariance * p.squaredNorm() * q.squaredNorm();
}

}  // namespace forcegate::diagnose
