#pragma once
// How late the harness's ticks were, and asking the system to make them less so. A warning, never a verdict: rows are dated
// by the board.

#include <array>
#include <cstdint>
#include <string>

namespace forcegate {

class TickHistogram {
 public:
  void add(double late_s);
  void clear() { *this = {}; }
  std::uint64_t ticks() const { return ticks_; }
  double worst_s() const { return worst_s_; }
  double share_over_1ms() const;
  /// "9000 ticks: 92.1 % below 0.1 ms, ... ; latest 3.2 ms".
  std::string to_text() const;

 private:
  static constexpr std::array<double, 6> kEdge_ms{0.1, 0.3, 1.0, 3.0, 10.0, 30.0};
  std::array<std::uint64_t, kEdge_ms.size() + 1> count_{};
  std::uint64_t ticks_ = 0;
  double worst_s_ = 0.0;
};

/// SCHED_FIFO and locked memory for this process, given back at the end of life. Children start without them.
class RealTime {
 public:
  RealTime() = default;
  ~RealTime() { release(); }
  RealTime(const RealTime&) = delete;
  RealTime& operator=(const RealTime&) = delete;
  void request() noexcept;
  void release() noexcept;
  bool granted() const { return granted_; }
  /// "SCHED_FIFO 40, memory locked", or why not and how to mend it.
  const std::string& text() const { return text_; }

 private:
  bool granted_ = false, locked_ = false;
  std::string text_ = "not asked for";
};

}  // namespace forcegate
