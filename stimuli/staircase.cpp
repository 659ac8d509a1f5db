// Levels one after the other, each held for dwell_s, joined by raised cosines of transition_s; with up_down =
// 1 back through the same levels. levels_N = 0, 1, 2 with up_down gives 0 1 2 1 0. The transition is part of
// the dwell.

#include "stimuli/profile.h"

namespace forcegate::stimuli {
namespace {

class Staircase final : public Profile {
 public:
  Staircase(std::vector<double> levels_N, double dwell_s, double transition_s, double ramp_s)
      : levels_N_(std::move(levels_N)), dwell_s_(dwell_s), transition_s_(transition_s) {
    duration_s_ = ramp_s + dwell_s * static_cast<double>(levels_N_.size());
    const auto [low, high] = std::minmax_element(levels_N_.begin(), levels_N_.end());
    set_ramp(ramp_s, levels_N_.front());
    facts_.mean_N = 0.5 * (*low + *high);
    facts_.amplitude_N = 0.5 * (*high - *low);
    facts_.minimum_N = std::min(facts_.minimum_N, *low);
    facts_.maximum_N = *high;
  }

 protected:
  double profile_N(double since_s) const override {
    const auto k = std::min(static_cast<std::size_t>(since_s / dwell_s_), levels_N_.size() - 1);
    if (k == 0 || transition_s_ <= 0.0) return levels_N_[k];
    const double into_s = since_s - static_cast<double>(k) * dwell_s_;
    const double w = smooth_step(into_s / transition_s_);
    return (1.0 - w) * levels_N_[k - 1] + w * levels_N_[k];
  }

 private:
  std::vector<double> levels_N_;
  double dwell_s_, transition_s_;
};

Result<std::unique_ptr<Stimulus>> make(const StimulusSpec& spec) {
  const auto& p = spec.numbers;
  std::vector<double> levels = spec.lists.at("levels_N");
  if (levels.empty())
    return fail(ErrorCode::usage, "stimulus 'staircase' needs at least one level", {},
                "levels_N = 0, 1, 2, 3, 4");
  if (p.at("transition_s") > p.at("dwell_s"))
    return fail(ErrorCode::usage, "stimulus 'staircase': transition_s is longer than dwell_s", {},
                "the transition is a part of the dwell");
  if (p.at("up_down") > 0.5)
    for (std::size_t i = levels.size() - 1; i-- > 0;) levels.push_back(levels[i]);
  return std::unique_ptr<Stimulus>(
      std::make_unique<Staircase>(std::move(levels), p.at("dwell_s"), p.at("transition_s"), p.at("ramp_s")));
}

const Registration<StimulusKind> kRegistered{
    {"staircase",
     "Levels held for dwell_s each, up and back down",
     {{"levels_N", "N", kRequired, 0.0, kForceLimit_N, "levels in order", true},
      {"dwell_s", "s", 10.0, 1e-3, kLongest_s, "time on one level, transition included"},
      {"transition_s", "s", 0.2, 0.0, kLongest_s, "time of the way to the next level"},
      {"up_down", "1", 1.0, 0.0, 1.0, "1 = back through the same levels, 0 = only in the given order"},
      ramp_parameter()},
     make}};

}  // namespace
}  // namespace forcegate::stimuli
