#pragma once

#include <cstddef>
#include <cstdint>

#include "hil/rig/rig_observation.h"

namespace forcegate::witness {

/// Time base of the rows: steps back, gaps, and how far a step is from the period.
class TimeWatch {
 public:
  explicit TimeWatch(double period_s = 1e-3) : period_s_(period_s) {}
  /// n > 0 stamps in seconds.
  void push(const double* t_s, std::size_t n);
  void finish(RigObservation& o) const;

 private:
  void count_strange(const double* t_s, std::size_t n);

  double period_s_;
  std::uint64_t samples_ = 0, not_monotone_ = 0, gaps_ = 0;
  double first_t_s_ = 0.0, previous_t_s_ = 0.0;
  double worst_step_s_ = 0.0, worst_gap_s_ = 0.0;
};

}  // namespace forcegate::witness
