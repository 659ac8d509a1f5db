#include "hil/rig/bench/passed_readings.h"

#include <algorithm>
#include <iterator>
#include <limits>

#include "hil/interface/rig.h"

namespace forcegate {

namespace {

constexpr double kLeastStep_s = 1e-9;

}  // namespace

void PassedForces::begin(double keep_s) {
  readings_.clear();
  keep_s_ = keep_s;
  dropped_ = false;
}

void PassedForces::take(const std::vector<ReferenceReading>& fresh) {
  readings_.insert(readings_.end(), fresh.begin(), fresh.end());
  while (!readings_.empty() && readings_.front().t_s < readings_.back().t_s - keep_s_) {
    readings_.pop_front();
    dropped_ = true;
  }
}

ForceAt PassedForces::at(double t_s, double stale_s) const {
  const auto behind = std::upper_bound(readings_.begin(), readings_.end(), t_s, [](double t, const ReferenceReading& r) { return t < r.t_s; });
  const ReferenceReading* before = behind == readings_.begin() ? nullptr : &*std::prev(behind);
  const ReferenceReading* after = behind == readings_.end() ? nullptr : &*behind;
  if (before != nullptr && t_s - before->t_s > stale_s) before = nullptr;
  if (after != nullptr && after->t_s - t_s > stale_s) after = nullptr;
  if (dropped_ && behind == readings_.begin()) after = nullptr;
  const ReferenceReading* only = before != nullptr ? before : after;
  if (only == nullptr) return {std::numeric_limits<float>::quiet_NaN(), kRigReferenceFault, false};
  if (before == nullptr || after == nullptr) return {only->force_N, only->status, after != nullptr};
  const double share = (t_s - before->t_s) / std::max(kLeastStep_s, after->t_s - before->t_s);
  return {static_cast<float>(static_cast<double>(before->force_N) + share * static_cast<double>(after->force_N - before->force_N)),
          static_cast<std::uint16_t>(before->status | after->status), true};
}

void PassedAngles::take(double t_s, double theta_rad) {
  angles_.emplace_back(t_s, theta_rad);
  while (angles_.front().first < t_s - keep_s_) angles_.pop_front();
}

double PassedAngles::at(double t_s) const {
  for (std::size_t i = angles_.size(); i-- > 1;) {
    const auto& [t1, a1] = angles_[i - 1];
    const auto& [t2, a2] = angles_[i];
    if (t_s < t1 && i > 1) continue;
    if (t2 <= t1) return a2;
    return a1 + (a2 - a1) * std::clamp((t_s - t1) / (t2 - t1), 0.0, 1.0);
  }
  return angles_.front().second;
}

}  // namespace forcegate
