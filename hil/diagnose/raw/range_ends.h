#pragma once
// Where the output has come to the ends of its range, and whether the force took it there.

#include <cstddef>
#include <limits>
#include <span>

namespace forcegate::diagnose {

/// A converter cannot go below zero (or above its full scale): what lies there, or so near that noise was cut off, says nothing about the
/// sensor and is no finding.
struct RangeEnds {
  double low_V = -std::numeric_limits<double>::infinity(), high_V = std::numeric_limits<double>::infinity();
  bool holds(double U_V) const { return U_V <= low_V || U_V >= high_V; }
};

/// Ends that the output has reached several times and never left; high_V may be infinite.
RangeEnds ends_of_range(std::span<const double> U, double low_V, double high_V, double lsb_V, double noise_V);

/// Lowest and highest of the samples that are there; without bounds where nothing is.
struct Spread {
  double low = 0.0, high = 0.0;
};
Spread spread_of_present(std::span<const double> x);

/// Steps of the output against what lies beside them: a swing that the end of the range cuts off was under way before.
class StepsOfOutput {
 public:
  /// quiet_V: what a step must exceed whatever the force does.
  StepsOfOutput(std::span<const double> F, std::span<const double> U, double gain_V_per_N, double quiet_V)
      : F_(F), U_(U), gain_(gain_V_per_N), quiet_(quiet_V) {}

  bool calm_before(std::size_t i) const;
  /// `end`: the first sample behind; from_V: what it came from.
  bool calm_behind(std::size_t end, double from_V) const;
  /// Whether a step is more than a movement of the force by `moved_N` makes.
  bool exceeds(double step_V, double moved_N) const { return step_V > quiet_ + 1.5 * gain_ * moved_N; }
  /// The output falls to sample i, and the force does not explain it: lost samples. Else the instrument's declared range.
  bool falls_at(std::size_t i) const;

 private:
  std::span<const double> F_, U_;
  double gain_, quiet_;
};

}  // namespace forcegate::diagnose
