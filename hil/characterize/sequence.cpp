#include "hil/characterize/sequence.h"

#include <algorithm>

namespace forcegate::characterize {

void Sequence::add(std::unique_ptr<Stimulus> part, double length_s) {
  const StimulusFacts f = part->facts();
  if (parts_.empty()) {
    facts_ = f;
  } else {
    facts_.minimum_N = std::min(facts_.minimum_N, f.minimum_N);
    facts_.maximum_N = std::max(facts_.maximum_N, f.maximum_N);
    facts_.dynamic = facts_.dynamic || f.dynamic;
  }
  start_s_.push_back(duration_s_);
  duration_s_ += length_s;
  parts_.push_back(std::move(part));
}

double Sequence::force_N(double t_s) const {
  std::size_t i = parts_.size() - 1;
  while (i > 0 && t_s < start_s_[i]) --i;
  return parts_[i]->force_N(t_s - start_s_[i]);
}

}  // namespace forcegate::characterize
