// A constant force: rest load, or nothing at all (level_N = 0).

#include "stimuli/profile.h"

namespace forcegate::stimuli {
namespace {

class Rest final : public Profile {
 public:
  Rest(double level_N, double duration_s, double ramp_s) : level_N_(level_N) {
    duration_s_ = duration_s;
    set_ramp(ramp_s, level_N);
    facts_.mean_N = facts_.maximum_N = level_N;
  }

  void fill(double first_t_s, double step_s, std::size_t n, double* out_N) const override {
    if (first_t_s < ramp_s_) return Stimulus::fill(first_t_s, step_s, n, out_N);
    std::fill(out_N, out_N + n, level_N_);
  }

 protected:
  double profile_N(double) const override { return level_N_; }

 private:
  double level_N_;
};

Result<std::unique_ptr<Stimulus>> make(const StimulusSpec& spec) {
  const auto& p = spec.numbers;
  return std::unique_ptr<Stimulus>(
      std::make_unique<Rest>(p.at("level_N"), p.at("duration_s"), p.at("ramp_s")));
}

const Registration<StimulusKind> kRegistered{
    {"rest",
     "A constant force: F = level_N",
     {{"level_N", "N", 0.0, 0.0, kForceLimit_N, "the force"}, duration_parameter(1200.0), ramp_parameter()},
     make}};

}  // namespace
}  // namespace forcegate::stimuli
