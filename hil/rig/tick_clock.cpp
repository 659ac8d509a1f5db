#include "hil/rig/tick_clock.h"

#include <fmt/format.h>
#include <sched.h>
#include <sys/mman.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

namespace forcegate {
namespace {

constexpr int kPriority = 40;  // below the kernel's own threads for interrupts

}  // namespace

void TickHistogram::add(double late_s) {
  const double late_ms = 1e3 * std::max(0.0, late_s);
  const auto at = std::upper_bound(kEdge_ms.begin(), kEdge_ms.end(), late_ms) - kEdge_ms.begin();
  ++count_[static_cast<std::size_t>(at)];
  ++ticks_;
  worst_s_ = std::max(worst_s_, late_s);
}

double TickHistogram::share_over_1ms() const {
  std::uint64_t late = 0;
  for (std::size_t i = 3; i < count_.size(); ++i) late += count_[i];
  return ticks_ > 0 ? static_cast<double>(late) / static_cast<double>(ticks_) : 0.0;
}

std::string TickHistogram::to_text() const {
  std::string out = fmt::format("{} ticks", ticks_);
  for (std::size_t i = 0; i < count_.size(); ++i) {
    if (count_[i] == 0) continue;
    const double share = 100.0 * static_cast<double>(count_[i]) / static_cast<double>(ticks_);
    out += i < kEdge_ms.size() ? fmt::format(", {:.2f} % below {:g} ms", share, kEdge_ms[i])
                               : fmt::format(", {:.2f} % later", share);
  }
  return out + fmt::format("; latest {:.2f} ms", 1e3 * worst_s_);
}

void RealTime::request() noexcept {
  release();
  locked_ = mlockall(MCL_CURRENT | MCL_FUTURE) == 0;
  const int lock_error = locked_ ? 0 : errno;
  sched_param wish{};
  wish.sched_priority = kPriority;
  granted_ = sched_setscheduler(0, SCHED_FIFO | SCHED_RESET_ON_FORK, &wish) == 0;
  const int error = granted_ ? lock_error : errno;
  text_ =
      granted_ && locked_
          ? fmt::format("SCHED_FIFO {}, memory locked", kPriority)
          : fmt::format(
                "warning: {}{}{} ({}); let the user have rtprio {} and memlock unlimited in /etc/security/limits.d",
                granted_ ? "" : "no SCHED_FIFO", !granted_ && !locked_ ? ", " : "",
                locked_ ? "" : "memory not locked", std::strerror(error), kPriority);
}

void RealTime::release() noexcept {
  if (granted_) {
    const sched_param ordinary{};
    (void)sched_setscheduler(0, SCHED_OTHER, &ordinary);
  }
  if (locked_) (void)munlockall();
  granted_ = locked_ = false;
}

}  // namespace forcegate
