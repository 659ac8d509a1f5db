#pragma once
// Conformity assessment after JCGM 106:2012 for a normal measurement: what a guard band buys.

namespace forcegate {

/// Tolerance or acceptance interval; infinities where there is no limit.
struct ToleranceInterval {
  double low, high;
};

/// Probability that the measurand conforms, given the best estimate y and its standard uncertainty u (JCGM 106, 7.2 to
/// 7.4, eq. (14)): Phi((high - y)/u) - Phi((low - y)/u). u = 0: 1 inside (limits included), else 0. NaN in, NaN out.
double conformance_probability(double y, double u, const ToleranceInterval& tolerance);

/// Length w = z(1 - risk) u of the guard band that limits the specific consumer's risk at the acceptance limit to `risk`
/// (8.3.2): risk in (0, 0.5], 0.5 gives 0 (simple acceptance), 2.275 % gives 2 u.
double guard_band(double u, double risk);

/// Largest value that a gauge with relative standard uncertainty u_rel may read while the probability that the limit is
/// truly exceeded stays below 1 - risk: limit / (1 - z(1 - risk) u_rel) (8.3.3.3, the rejection of a good item guarded).
double guarded_rejection_limit(double limit, double u_rel, double risk);

/// Global risks (9.5): the measurand is drawn from N(mean, sd), measured with u, accepted inside `acceptance`.
/// consumer: accepted although outside the tolerance; producer: refused although inside. Gauss-Legendre over the prior,
/// absolute error below 1e-8.
struct GlobalRisks {
  double consumer = 0.0, producer = 0.0;
};
GlobalRisks global_risks(double mean, double sd, double u, const ToleranceInterval& tolerance,
                         const ToleranceInterval& acceptance);

/// z with Phi(z) = p, p in (0, 1).
double normal_quantile(double p);

}  // namespace forcegate
