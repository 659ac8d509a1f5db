#pragma once
// When the records of a free-running stream were measured. They carry no time stamp and arrive in clumps; but no
// record can arrive before it was measured, so the earliest arrivals of the last seconds carry the device's clock:
//   t_k = k / r + min over the window of (arrival_j - j / r)

#include <cstdint>
#include <deque>

namespace forcegate {

class ArrivalClock {
 public:
  void begin(double rate_Hz, double window_s) {
    period_s_ = 1.0 / rate_Hz;
    window_s_ = window_s;
    restart();
  }
  void restart() {
    count_ = 0;
    lowest_.clear();
    settled_s_ = -1e300;
  }
  /// Instant at which the next record was complete; `arrival_s` is when it was read.
  double next(double arrival_s) {
    const double lag = arrival_s - static_cast<double>(count_++) * period_s_;
    // Records were lost, or they come late: which of both, only the next ones tell.
    if (!lowest_.empty() && lag - lowest_.front().lag_s > kLost_s) {
      lowest_.clear();
      ++restarts_;
      settled_s_ = arrival_s + kSettle_s;
    }
    while (!lowest_.empty() && lowest_.back().lag_s >= lag) lowest_.pop_back();
    lowest_.push_back({arrival_s, lag});
    while (lowest_.front().arrival_s < arrival_s - window_s_) lowest_.pop_front();
    return static_cast<double>(count_ - 1) * period_s_ + lowest_.front().lag_s;
  }
  /// False while a gap in the arrivals leaves open when the records were measured.
  bool settled(double arrival_s) const { return arrival_s >= settled_s_; }
  std::uint64_t restarts() const { return restarts_; }

 private:
  static constexpr double kLost_s = 0.025, kSettle_s = 0.05;
  struct Entry {
    double arrival_s, lag_s;
  };
  double period_s_ = 0.001, window_s_ = 0.5, settled_s_ = -1e300;
  std::uint64_t count_ = 0, restarts_ = 0;
  std::deque<Entry> lowest_;  // rising lags: the front is the minimum of the window
};

}  // namespace forcegate
