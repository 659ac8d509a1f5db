#pragma once
// A profile made of stretches of other profiles, for procedures that no single stimulus has: cycling, a rest, the
// same cycling again.

#include <memory>
#include <vector>

#include "hil/interface/stimulus.h"

namespace forcegate::characterize {

class Sequence final : public Stimulus {
 public:
  /// Plays `part` from its start for length_s. The forces at a joint should meet; the rig goes there in one
  /// controller period.
  void add(std::unique_ptr<Stimulus> part, double length_s);

  double force_N(double t_s) const override;
  double duration_s() const override { return duration_s_; }
  StimulusFacts facts() const override { return facts_; }

  /// Instant at which stretch k begins, s.
  double start_s(std::size_t k) const { return start_s_[k]; }

 private:
  std::vector<std::unique_ptr<Stimulus>> parts_;
  std::vector<double> start_s_;
  double duration_s_ = 0.0;
  StimulusFacts facts_;
};

}  // namespace forcegate::characterize
