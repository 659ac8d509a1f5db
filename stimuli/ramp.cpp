// Triangular ramps from low to high and back, `cycles` times, each way in sweep_s: the two slow sweeps of the
// static calibration (Lebosse 2011, III-A: "continuously applying the force range twice").

#include "hil/base/text.h"
#include "stimuli/profile.h"

namespace forcegate::stimuli {
namespace {

class Ramp final : public Profile {
 public:
  Ramp(double low_N, double high_N, double sweep_s, double cycles, double ramp_s)
      : bottom_N_(low_N), span_N_(high_N - low_N), sweep_s_(sweep_s) {
    duration_s_ = ramp_s + 2.0 * sweep_s * cycles;
    set_ramp(ramp_s, low_N);
    facts_.mean_N = 0.5 * (low_N + high_N);
    facts_.amplitude_N = 0.5 * (high_N - low_N);
    facts_.maximum_N = high_N;
  }

 protected:
  double profile_N(double since_s) const override {
    const double ways = since_s / sweep_s_;
    const double way = std::floor(ways);
    const double x = ways - way;
    const bool down = std::fmod(way, 2.0) > 0.5;
    return bottom_N_ + span_N_ * (down ? 1.0 - x : x);
  }

 private:
  double bottom_N_, span_N_, sweep_s_;
};

Result<std::unique_ptr<Stimulus>> make(const StimulusSpec& spec) {
  const auto& p = spec.numbers;
  if (p.at("low_N") > p.at("high_N"))
    return fail(ErrorCode::usage, "stimulus 'ramp': low_N is above high_N", {}, "swap them");
  if (p.at("cycles") != std::floor(p.at("cycles")))
    return fail(ErrorCode::usage, "stimulus 'ramp': cycles = " + shortest(p.at("cycles")) + " is no whole number of triangles", {}, "one triangle goes up and down again; a way alone is a staircase or a step");
  return std::unique_ptr<Stimulus>(std::make_unique<Ramp>(p.at("low_N"), p.at("high_N"), p.at("sweep_s"),
                                                          p.at("cycles"), p.at("ramp_s")));
}

const Registration<StimulusKind> kRegistered{
    {"ramp",
     "Triangular ramps low - high - low at constant speed, as in the static calibration",
     {{"low_N", "N", 0.2, 0.0, kForceLimit_N, "lowest force"},
      {"high_N", "N", 4.0, 0.0, kForceLimit_N, "highest force"},
      {"sweep_s", "s", 50.0, 1e-2, kLongest_s, "time of one way, up or down"},
      {"cycles", "1", 2.0, 1.0, 1e6, "number of triangles, whole"},
      ramp_parameter()},
     make}};

}  // namespace
}  // namespace forcegate::stimuli
