#pragma once
// What every ATI stream passes before it counts: range, change from one record to the next, and the soundness of the
// records behind it, in which a slipped byte shows.

#include <cmath>
#include <cstdint>
#include <deque>
#include <limits>
#include <vector>

#include "hil/interface/device.h"

namespace forcegate::ati {

class ReadingFilter {
 public:
  /// `hold`: how many sound records must follow before one counts.
  ReadingFilter(double force_max_N, double jump_max_N, std::size_t hold)
      : force_max_N_(force_max_N), jump_max_N_(jump_max_N), hold_(hold) {}

  /// Before a stream, and behind a gap in it: the next record has none before it to be held against.
  void begin() {
    held_.clear();
    last_N_ = std::numeric_limits<double>::quiet_NaN();
  }
  bool plausible(double force_N) const {
    return std::fabs(force_N) <= 1.05 * force_max_N_ && !(std::fabs(force_N - last_N_) > jump_max_N_);
  }
  /// A sound record, its force NaN when its status is not 0.
  void take(const ReferenceReading& reading, std::vector<ReferenceReading>& out) {
    last_N_ = static_cast<double>(reading.force_N);
    held_.push_back(reading);
    while (held_.size() > hold_) {
      out.push_back(held_.front());
      held_.pop_front();
    }
  }
  /// A sound record whose time is in doubt.
  void pass(double force_N) { last_N_ = force_N; }
  /// An unsound record: those before it are in doubt too.
  void drop() { held_.clear(); }

 private:
  double force_max_N_, jump_max_N_;
  std::size_t hold_;
  std::deque<ReferenceReading> held_;
  double last_N_ = std::numeric_limits<double>::quiet_NaN();
};

}  // namespace forcegate::ati
