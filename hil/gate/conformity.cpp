#include "hil/gate/conformity.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "hil/gate/statistics.h"

namespace forcegate {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kReach = 9.0;  // standard deviations; beyond lies less than 1e-18

// Composite 5-point Gauss-Legendre, abscissas and weights of DLMF 3.5.
template <class F>
double integrate(double low, double high, F f) {
  if (!(high > low)) return 0.0;
  constexpr double kX[3] = {0.0, 0.538469310105683, 0.906179845938664};
  constexpr double kW[3] = {0.568888888888889, 0.478628670499366, 0.236926885056189};
  constexpr int kPanels = 200;
  const double half = 0.5 * (high - low) / kPanels;
  double sum = 0.0;
  for (int p = 0; p < kPanels; ++p) {
    const double middle = low + (2 * p + 1) * half;
    sum += kW[0] * f(middle);
    for (int k = 1; k < 3; ++k) sum += kW[k] * (f(middle - kX[k] * half) + f(middle + kX[k] * half));
  }
  return sum * half;
}

}  // namespace

double conformance_probability(double y, double u, const ToleranceInterval& t) {
  if (std::isnan(y) || !(u >= 0.0)) return std::numeric_limits<double>::quiet_NaN();
  if (u == 0.0) return y >= t.low && y <= t.high ? 1.0 : 0.0;
  const double above = std::isinf(t.high) ? 1.0 : normal_cdf((t.high - y) / u);
  const double below = std::isinf(t.low) ? 0.0 : normal_cdf((t.low - y) / u);
  return above - below;
}

double normal_quantile(double p) {
  double low = -40.0, high = 40.0;
  for (int i = 0; i < 200; ++i) {
    const double middle = 0.5 * (low + high);
    (normal_cdf(middle) < p ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

double guard_band(double u, double risk) { return -normal_quantile(risk) * u; }

double guarded_rejection_limit(double limit, double u_rel, double risk) {
  return limit / (1.0 + normal_quantile(risk) * u_rel);
}

GlobalRisks global_risks(double mean, double sd, double u, const ToleranceInterval& t,
                         const ToleranceInterval& a) {
  const auto density = [&](double x) {
    const double z = (x - mean) / sd;
    return std::exp(-0.5 * z * z) / (sd * std::sqrt(2.0 * kPi));
  };
  const auto accepted = [&](double x) { return conformance_probability(x, u, a); };
  const double from = mean - kReach * sd, to = mean + kReach * sd;
  const auto part = [&](double low, double high, auto f) {
    return integrate(std::clamp(low, from, to), std::clamp(high, from, to), f);
  };
  GlobalRisks risks;
  const auto consumer = [&](double x) { return density(x) * accepted(x); };
  risks.consumer = part(from, t.low, consumer) + part(t.high, to, consumer);
  risks.producer = part(t.low, t.high, [&](double x) { return density(x) * (1.0 - accepted(x)); });
  return risks;
}

}  // namespace forcegate
