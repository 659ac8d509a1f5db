// Linear sweep of the frequency from f_start to f_end over the record, up or down (Lebosse 2011, IV-A2a):
//   F = m - A cos(2 pi (f_start t + (f_end - f_start) t^2 / (2 T))).

#include "stimuli/profile.h"

namespace forcegate::stimuli {
namespace {

class Chirp final : public Profile {
 public:
  Chirp(double f_start_Hz, double f_end_Hz, double A_N, double m_N, double duration_s, double ramp_s)
      : f_start_Hz_(f_start_Hz), A_N_(A_N), m_N_(m_N) {
    duration_s_ = duration_s;
    half_slope_Hz_per_s_ = 0.5 * (f_end_Hz - f_start_Hz) / (duration_s - ramp_s);
    set_ramp(ramp_s, m_N - A_N);
    facts_.mean_N = m_N;
    facts_.amplitude_N = A_N;
    facts_.lowest_frequency_Hz = f_start_Hz;
    facts_.maximum_N = m_N + A_N;
    facts_.dynamic = true;
  }

 protected:
  double profile_N(double since_s) const override {
    const double turns = since_s * (f_start_Hz_ + half_slope_Hz_per_s_ * since_s);
    return m_N_ - A_N_ * portable::cos(kTwoPi * (turns - std::floor(turns)));
  }

 private:
  double f_start_Hz_, A_N_, m_N_, half_slope_Hz_per_s_;
};

Result<std::unique_ptr<Stimulus>> make(const StimulusSpec& spec) {
  const auto& p = spec.numbers;
  FORCEGATE_CHECK_OK(check_contact("chirp", p.at("m_N") - p.at("A_N")));
  if (p.at("ramp_s") >= p.at("duration_s"))
    return fail(ErrorCode::usage, "stimulus 'chirp' has no time left after its loading ramp", {},
                "raise duration_s or lower ramp_s");
  return std::unique_ptr<Stimulus>(std::make_unique<Chirp>(p.at("f_start_Hz"), p.at("f_end_Hz"), p.at("A_N"),
                                                           p.at("m_N"), p.at("duration_s"), p.at("ramp_s")));
}

const Registration<StimulusKind> kRegistered{
    {"chirp",
     "Linear frequency sweep, up or down: F = m - A cos(2 pi (f_start t + (f_end - f_start) t^2 / 2T))",
     {{"f_start_Hz", "Hz", kRequired, 0.0, 50.0, "frequency at the start"},
      {"f_end_Hz", "Hz", kRequired, 0.0, 50.0, "frequency at the end"},
      amplitude_parameter(),
      mean_parameter(),
      duration_parameter(1200.0),
      ramp_parameter()},
     make}};

}  // namespace
}  // namespace forcegate::stimuli
