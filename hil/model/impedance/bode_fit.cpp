#include "hil/model/impedance/bode_fit.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <map>

namespace forcegate::impedance {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kDeparture = 0.2;  // tan by eq. (9) over tan measured, minus 1
constexpr double kNear = 0.6;       // in ln f: readings about the crossing that its cubic is fitted to

struct LineFit {
  Eigen::VectorXd beta;
  Eigen::MatrixXd covariance;
  double chi2 = 0;
};

LineFit weighted(const Eigen::MatrixXd& X, const Eigen::VectorXd& y, const Eigen::VectorXd& u) {
  const Eigen::MatrixXd W = u.cwiseInverse().asDiagonal() * X;
  const Eigen::VectorXd z = y.cwiseQuotient(u);
  LineFit out;
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(W);
  out.beta = qr.solve(z);
  out.covariance = (W.transpose() * W).inverse();
  out.chi2 = (z - W * out.beta).squaredNorm();
  return out;
}

struct Departure {
  double log_f, value, u;
};

// First upward crossing of kDeparture, by a cubic through the readings near it.
void find_divergence(const std::vector<Departure>& d, BodeFit& fit) {
  fit.divergence_Hz = fit.u_divergence_Hz = std::nan("");
  for (std::size_t i = 1; i < d.size(); ++i) {
    if (!(d[i - 1].value < kDeparture && d[i].value >= kDeparture)) continue;
    if (std::any_of(d.begin() + static_cast<std::ptrdiff_t>(i), d.end(),
                    [](const Departure& x) { return x.value < 0.5 * kDeparture; }))
      continue;  // scatter
    const double centre = 0.5 * (d[i - 1].log_f + d[i].log_f);
    std::vector<const Departure*> near;
    for (const Departure& x : d)
      if (std::abs(x.log_f - centre) < kNear) near.push_back(&x);
    if (near.size() < 6) return;
    Eigen::MatrixXd X(static_cast<Eigen::Index>(near.size()), 4);
    Eigen::VectorXd y(X.rows()), u(X.rows());
    for (Eigen::Index k = 0; k < X.rows(); ++k) {
      const Departure& x = *near[static_cast<std::size_t>(k)];
      const double t = x.log_f - centre;
      X.row(k) << 1.0, t, t * t, t * t * t;
      y[k] = x.value;
      u[k] = x.u;
    }
    const LineFit cubic = weighted(X, y, u);
    const auto& c = cubic.beta;
    double t = 0.0, slope = c[1];
    for (int step = 0; step < 20; ++step) {
      slope = c[1] + t * (2.0 * c[2] + 3.0 * c[3] * t);
      if (!(slope > 0.0)) return;
      t -= (c[0] - kDeparture + t * (c[1] + t * (c[2] + c[3] * t))) / slope;
      if (!(std::abs(t) < kNear)) return;
    }
    const Eigen::Vector4d at(1.0, t, t * t, t * t * t);
    const double u_relative =
        std::hypot(fit.u_conductance_S / fit.conductance_S, fit.u_capacitance_F / fit.capacitance_F) *
        (1.0 + kDeparture);
    fit.divergence_Hz = std::exp(centre + t);
    fit.u_divergence_Hz =
        fit.divergence_Hz * std::hypot(std::sqrt(at.dot(cubic.covariance * at)), u_relative) / slope;
    return;
  }
}

}  // namespace

double BodeFit::phase_rad(double f_Hz) const {
  return std::atan(2.0 * kPi * f_Hz * capacitance_F / conductance_S);
}

bool BodeFit::departs(const RcReading& r) const {
  const auto off = [](double value, double u, double fitted, double u_fitted) {
    return std::abs(value - fitted) > 3.0 * std::hypot(u, u_fitted) &&
           std::abs(value - fitted) > 0.05 * std::abs(fitted);
  };
  return r.saturated || off(r.conductance_S, r.u_conductance_S, conductance_S, u_conductance_S) ||
         off(r.capacitance_F, r.u_capacitance_F, capacitance_F, u_capacitance_F);
}

Result<BodeFit> fit_bode(std::span<const RcReading> sweep, double common_u_rel, double top_Hz) {
  std::vector<const RcReading*> used;
  for (const RcReading& r : sweep)
    if (r.f_Hz > 0.0 && r.f_Hz <= top_Hz && !r.saturated && r.u_conductance_S > 0.0 &&
        r.u_capacitance_F > 0.0)
      used.push_back(&r);
  if (used.size() < kFewestOfBodeFit)
    return fail(ErrorCode::parse,
                fmt::format("a Bode fit needs {} sound readings up to {} Hz, there are {}", kFewestOfBodeFit, top_Hz,
                            used.size()),
                {}, "sweep more frequencies, or lower the amplitude so that the amplifier does not saturate");
  const auto n = static_cast<Eigen::Index>(used.size());
  Eigen::MatrixXd X(n, 3);
  Eigen::VectorXd g(n), u_g(n), c(n), u_c(n);
  BodeFit fit;
  for (Eigen::Index i = 0; i < n; ++i) {
    const RcReading& r = *used[static_cast<std::size_t>(i)];
    const double x = r.f_Hz / top_Hz;
    X.row(i) << 1.0, x * x, x * x * x * x;
    g[i] = 1e6 * r.conductance_S, u_g[i] = 1e6 * r.u_conductance_S;
    c[i] = 1e12 * r.capacitance_F, u_c[i] = 1e12 * r.u_capacitance_F;
    fit.top_Hz = std::max(fit.top_Hz, r.f_Hz);
  }
  const LineFit of_g = weighted(X, g, u_g), of_c = weighted(X, c, u_c);
  fit.conductance_S = 1e-6 * of_g.beta[0];
  fit.u_conductance_S = std::hypot(1e-6 * std::sqrt(of_g.covariance(0, 0)), common_u_rel * fit.conductance_S);
  fit.capacitance_F = 1e-12 * of_c.beta[0];
  fit.u_capacitance_F =
      std::hypot(1e-12 * std::sqrt(of_c.covariance(0, 0)), common_u_rel * fit.capacitance_F);
  fit.chi2_per_dof = (of_g.chi2 + of_c.chi2) / static_cast<double>(2 * (n - 3));
  if (!(fit.conductance_S > 0.0) || !(fit.capacitance_F > 0.0))
    return fail(ErrorCode::parse, "the sweep gives no positive R_s and C_s", {},
                "check the sense of the phase: the output of an inverting amplifier leads -V_s by phi");
  std::vector<Departure> departures;
  for (const RcReading& r : sweep) {
    if (r.saturated || r.f_Hz <= 0.0 || !(r.capacitance_F > 0.0)) continue;
    const double tangent = std::tan(fit.phase_rad(r.f_Hz)),
                 ratio = tangent * r.conductance_S / (2.0 * kPi * r.f_Hz * r.capacitance_F);
    departures.push_back({std::log(r.f_Hz), ratio - 1.0,
                          std::abs(ratio) * std::hypot(r.u_conductance_S / r.conductance_S,
                                                       r.u_capacitance_F / r.capacitance_F)});
  }
  std::sort(departures.begin(), departures.end(),
            [](const Departure& a, const Departure& b) { return a.log_f < b.log_f; });
  find_divergence(departures, fit);
  return fit;
}

double operating_frequency_Hz(std::span<const BodeFit> fits, std::span<const std::vector<RcReading>> sweeps,
                              double share) {
  if (fits.empty()) return std::nan("");  // nothing says from where on the readings diverge
  double limit_Hz = INFINITY;
  for (const BodeFit& f : fits) {
    if (std::isnan(f.divergence_Hz)) return std::nan("");
    limit_Hz = std::min(limit_Hz, share * (f.divergence_Hz - 2.0 * f.u_divergence_Hz));
  }
  std::map<double, double> relative;
  for (const auto& sweep : sweeps)
    for (const RcReading& r : sweep)
      if (r.f_Hz > 0.0 && r.f_Hz <= limit_Hz)
        relative[r.f_Hz] += r.saturated ? INFINITY : r.u_capacitance_F / std::abs(r.capacitance_F);
  const auto best = std::min_element(relative.begin(), relative.end(),
                                     [](const auto& a, const auto& b) { return a.second < b.second; });
  return best == relative.end() ? std::nan("") : best->first;
}

}  // namespace forcegate::impedance
