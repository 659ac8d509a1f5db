// One step of the force and, when hold_s is given, the step back:
//   F = low before at_s, high from at_s to at_s + hold_s, low afterwards.

#include "stimuli/profile.h"

namespace forcegate::stimuli {
namespace {

class Step final : public Profile {
 public:
  Step(double low_N, double high_N, double at_s, double hold_s, double duration_s, double ramp_s)
      : before_N_(low_N), after_N_(high_N), at_s_(at_s), hold_s_(hold_s) {
    duration_s_ = duration_s;
    set_ramp(ramp_s, low_N);
    facts_.mean_N = 0.5 * (low_N + high_N);
    facts_.amplitude_N = 0.5 * std::abs(high_N - low_N);
    facts_.minimum_N = std::min(facts_.minimum_N, high_N);
    facts_.maximum_N = std::max(low_N, high_N);
  }

 protected:
  double profile_N(double since_s) const override {
    const bool stepped = since_s >= at_s_ && (hold_s_ <= 0.0 || since_s < at_s_ + hold_s_);
    return stepped ? after_N_ : before_N_;
  }

 private:
  double before_N_, after_N_, at_s_, hold_s_;
};

Result<std::unique_ptr<Stimulus>> make(const StimulusSpec& spec) {
  const auto& p = spec.numbers;
  if (const double steps_s = p.at("ramp_s") + p.at("at_s"); steps_s >= p.at("duration_s"))
    return fail(ErrorCode::usage, "stimulus 'step' would step at " + shortest(steps_s) + " s, its loading ramp included, and ends at " + shortest(p.at("duration_s")) + " s", {},
                "raise duration_s or lower at_s; a force that stays is a rest");
  return std::unique_ptr<Stimulus>(std::make_unique<Step>(
      p.at("low_N"), p.at("high_N"), p.at("at_s"), p.at("hold_s"), p.at("duration_s"), p.at("ramp_s")));
}

const Registration<StimulusKind> kRegistered{
    {"step",
     "A step from low_N to high_N at at_s, and back after hold_s",
     {{"low_N", "N", 1.0, 0.0, kForceLimit_N, "force before the step"},
      {"high_N", "N", 4.0, 0.0, kForceLimit_N, "force after the step"},
      {"at_s", "s", 1.0, 0.0, kLongest_s, "instant of the step after the loading ramp"},
      {"hold_s", "s", 0.0, 0.0, kLongest_s, "time until the step back; 0 = it stays"},
      duration_parameter(10.0),
      ramp_parameter()},
     make}};

}  // namespace
}  // namespace forcegate::stimuli
