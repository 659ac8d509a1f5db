#pragma once
// Play operators, of which loops of films and rigs are made, and what they find at the start of a record.

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <vector>

#include "hil/model/effect.h"

namespace forcegate {

/// Play (backlash) operator: p follows x only when |x - p| would exceed the radius.
class Play {
 public:
  Play(double radius, double state) : radius_(radius), state_(state) {}
  double step(double x) {
    state_ = std::clamp(state_, x - radius_, x + radius_);
    return state_;
  }
  double state() const { return state_; }

 private:
  double radius_, state_;
};

/// Radii of the library's play banks, of the force span. Wider ones keep still after the first swing: what they add is a drift.
inline constexpr std::array kPlayRadii = {0.0125, 0.025, 0.05, 0.1, 0.2, 0.35};
/// Those that a curved bank also applies to F^2: first and last index.
inline constexpr std::size_t kFirstCurved = 1, kLastCurved = 4;

/// Whether a film or a rig kept its state from one recording to the next, nobody writes down: a shape of two values.
inline const ParameterSpec kPlayKept{"kept", "1", 0.0, 1.0, 1.0, "1: a recording begins as the one before ended; 0: it begins anew", true};

inline std::vector<std::vector<double>> kept_or_not(const CampaignInput& campaign) {
  const auto& records = campaign.records;
  const bool several = std::ranges::any_of(records, [&](const RecordInput& r) { return r.recording != records.front().recording; });
  return several ? std::vector<std::vector<double>>{{1.0}, {0.0}} : std::vector<std::vector<double>>{{1.0}};
}

/// The play at the start of a recording, N: as those before it left it, or (`kept` false, or none before) come from below, never from
/// under `lowest`.
inline Play play_at_start(const CampaignInput& campaign, const RecordInput& record, std::vector<double> RecordInput::*force, double radius,
                          double lowest, bool kept) {
  const auto force_of = [&](std::size_t k) -> const std::vector<double>& { return campaign.records[k].*force; };
  const auto own = std::ranges::find(campaign.records, record.recording, &RecordInput::recording);
  const std::size_t end = kept ? static_cast<std::size_t>(own - campaign.records.begin()) : 0;
  // back to where the state does not depend on any earlier one: from there on the force has moved by both widths
  double low = std::numeric_limits<double>::infinity(), high = -low, first = (record.*force).front();
  std::size_t from = end, row = 0;
  for (std::size_t k = end; k-- > 0 && high - low <= 2.0 * radius;)
    for (std::size_t i = force_of(k).size(); i-- > 0 && high - low <= 2.0 * radius;) {
      first = force_of(k)[i];
      low = std::min(low, first);
      high = std::max(high, first);
      from = k;
      row = i;
    }
  Play out(radius, std::max(lowest, first - radius));
  for (std::size_t k = from; k < end; ++k, row = 0)
    for (std::size_t i = row; i < force_of(k).size(); ++i) out.step(force_of(k)[i]);
  return out;
}

}  // namespace forcegate
