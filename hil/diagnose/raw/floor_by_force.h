#pragma once
// Where the low end of the output belongs: a film without load, behind a divider or a threshold, is there.

#include <cstddef>
#include <span>
#include <vector>

namespace forcegate::diagnose {

class FloorByForce {
 public:
  /// `floor_V`: what is at the low end; `near_N`: forces that are nearer are one.
  FloorByForce(std::span<const double> F, std::span<const double> U, double floor_V, double near_N);

  /// Whether three in ten and more of the samples at that force are at the low end, and half and more of those at less. Others at the force of a
  /// lost sample are not, or, where it is lost in step with the force, those at less are not.
  bool belongs_there(double F_N) const;

 private:
  double near_N_;
  std::vector<double> F_;            // in rising order
  std::vector<std::size_t> at_low_;  // how many of those before are at the low end
};

}  // namespace forcegate::diagnose
