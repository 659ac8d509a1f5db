// Sine (Lebosse 2011, eq. 2), begun at its minimum so that force and its rate are continuous:
//   F(t) = m - A cos(2 pi f (t - ramp_s)).

#include "stimuli/profile.h"

namespace forcegate::stimuli {
namespace {

class Sine final : public Profile {
 public:
  Sine(double f_Hz, double A_N, double m_N, double duration_s, double ramp_s)
      : f_Hz_(f_Hz), A_N_(A_N), m_N_(m_N) {
    duration_s_ = duration_s;
    set_ramp(ramp_s, m_N - A_N);
    facts_.mean_N = m_N;
    facts_.amplitude_N = A_N;
    facts_.lowest_frequency_Hz = f_Hz;
    facts_.maximum_N = m_N + A_N;
    facts_.dynamic = true;
  }

  void fill(double first_t_s, double step_s, std::size_t n, double* out_N) const override {
    const std::int64_t first = grid_index(first_t_s, step_s);
    if (first < 0 || first_t_s < ramp_s_) return Stimulus::fill(first_t_s, step_s, n, out_N);
    std::fill(out_N, out_N + n, m_N_);
    add_cosine(-A_N_, f_Hz_, -kTwoPi * f_Hz_ * ramp_s_, first, step_s, n, out_N);
  }

 protected:
  double profile_N(double since_s) const override {
    return m_N_ - A_N_ * portable::cos(kTwoPi * f_Hz_ * since_s);
  }

 private:
  double f_Hz_, A_N_, m_N_;
};

Result<std::unique_ptr<Stimulus>> make(const StimulusSpec& spec) {
  const auto& p = spec.numbers;
  FORCEGATE_CHECK_OK(check_contact("sine", p.at("m_N") - p.at("A_N")));
  return std::unique_ptr<Stimulus>(
      std::make_unique<Sine>(p.at("f_Hz"), p.at("A_N"), p.at("m_N"), p.at("duration_s"), p.at("ramp_s")));
}

const Registration<StimulusKind> kRegistered{{"sine",
                                              "One sine, begun at its minimum: F = m - A cos(2 pi f t)",
                                              {{"f_Hz", "Hz", kRequired, 1e-4, 50.0, "frequency f"},
                                               amplitude_parameter(),
                                               mean_parameter(),
                                               duration_parameter(1200.0),
                                               ramp_parameter()},
                                              make}};

}  // namespace
}  // namespace forcegate::stimuli
