// Pseudo-random binary signal between m - A and m + A (Lebosse 2011, IV-A2c: 0 to 5 Hz, A 1.6 N, m 2.6 N).
// The bits are a maximum-length sequence of a 15-stage shift register (x^15 + x^14 + 1) that the seed starts;
// one bit lasts 1 / (2 f_max), so that the fastest alternation is f_max. The first bit is low. A change of
// level takes transition_s as a raised cosine: no motor can jump.

#include "hil/base/rng.h"
#include "stimuli/profile.h"

namespace forcegate::stimuli {
namespace {

class Prbs final : public Profile {
 public:
  Prbs(double f_max_Hz, double A_N, double m_N, double duration_s, double ramp_s, double transition_s,
       std::uint64_t seed)
      : A_N_(A_N), m_N_(m_N), transition_s_(transition_s), bit_s_(0.5 / f_max_Hz) {
    duration_s_ = duration_s;
    set_ramp(ramp_s, m_N - A_N);
    facts_.mean_N = m_N;
    facts_.amplitude_N = A_N;
    facts_.lowest_frequency_Hz = 0.0;
    facts_.maximum_N = m_N + A_N;
    facts_.dynamic = true;
    std::uint32_t state = static_cast<std::uint32_t>(mix_seed(seed, "prbs") % 32767) + 1;
    high_.assign(static_cast<std::size_t>(duration_s / bit_s_) + 2, false);
    for (std::size_t k = 1; k < high_.size(); ++k) {
      const std::uint32_t bit = ((state >> 14) ^ (state >> 13)) & 1U;
      state = ((state << 1) | bit) & 0x7FFFU;
      high_[k] = bit != 0;
    }
  }

 protected:
  double profile_N(double since_s) const override {
    const auto k = std::min(static_cast<std::size_t>(since_s / bit_s_), high_.size() - 1);
    const double now = high_[k] ? A_N_ : -A_N_;
    if (k == 0 || high_[k] == high_[k - 1]) return m_N_ + now;
    const double into_s = since_s - static_cast<double>(k) * bit_s_;
    return m_N_ - now + 2.0 * now * (transition_s_ > 0.0 ? smooth_step(into_s / transition_s_) : 1.0);
  }

 private:
  double A_N_, m_N_, transition_s_, bit_s_;
  std::vector<bool> high_;
};

Result<std::unique_ptr<Stimulus>> make(const StimulusSpec& spec) {
  const auto& p = spec.numbers;
  FORCEGATE_CHECK_OK(check_contact("prbs", p.at("m_N") - p.at("A_N")));
  const double bit_s = 0.5 / p.at("f_max_Hz");
  if (p.at("transition_s") > bit_s)
    return fail(ErrorCode::usage, "stimulus 'prbs': transition_s is longer than one bit", {},
                "a bit lasts 1 / (2 f_max) = " + shortest(bit_s) + " s");
  if (p.at("duration_s") / bit_s > 1e8)
    return fail(ErrorCode::usage, "stimulus 'prbs' would need more than 1e8 bits");
  return std::unique_ptr<Stimulus>(std::make_unique<Prbs>(p.at("f_max_Hz"), p.at("A_N"), p.at("m_N"),
                                                          p.at("duration_s"), p.at("ramp_s"),
                                                          p.at("transition_s"), spec.seed));
}

const Registration<StimulusKind> kRegistered{
    {"prbs",
     "Pseudo-random binary signal between m - A and m + A with frequencies from 0 to f_max; takes a seed",
     {{"f_max_Hz", "Hz", 5.0, 1e-3, 50.0, "fastest alternation; a bit lasts 1 / (2 f_max)"},
      amplitude_parameter(),
      mean_parameter(),
      duration_parameter(1200.0),
      ramp_parameter(),
      {"transition_s", "s", 0.05, 0.0, 1e3, "time of a change of level"}},
     make}};

}  // namespace
}  // namespace forcegate::stimuli
