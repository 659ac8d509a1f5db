// A sine whose frequency changes at once while amplitude and mean stay (Lebosse 2011, IV-A3 and Fig. 8: 0.5,
// 2, 3 Hz). The phase is continuous: F = m - A cos(2 pi phi(t)), phi' = f_i in the i-th stretch. A frequency
// of 0 is a pause at the force where the wheel happens to be.

#include "stimuli/profile.h"

namespace forcegate::stimuli {
namespace {

class Jump final : public Profile {
 public:
  Jump(std::vector<double> f_Hz, const std::vector<double>& stretch_s, double A_N, double m_N, double ramp_s)
      : f_Hz_(std::move(f_Hz)), A_N_(A_N), m_N_(m_N) {
    start_s_.push_back(0.0);
    turns_.push_back(0.0);
    for (std::size_t i = 0; i < f_Hz_.size(); ++i) {
      start_s_.push_back(start_s_.back() + stretch_s[i]);
      turns_.push_back(turns_.back() + f_Hz_[i] * stretch_s[i]);
    }
    duration_s_ = ramp_s + start_s_.back();
    set_ramp(ramp_s, m_N - A_N);
    facts_.mean_N = m_N;
    facts_.amplitude_N = A_N;
    facts_.lowest_frequency_Hz = f_Hz_.front();
    facts_.maximum_N = m_N + A_N;
    facts_.dynamic = true;
  }

 protected:
  double profile_N(double since_s) const override {
    std::size_t i = f_Hz_.size() - 1;
    while (i > 0 && since_s < start_s_[i]) --i;
    const double turns = turns_[i] + f_Hz_[i] * (since_s - start_s_[i]);
    return m_N_ - A_N_ * portable::cos(kTwoPi * (turns - std::floor(turns)));
  }

 private:
  std::vector<double> f_Hz_, start_s_, turns_;
  double A_N_, m_N_;
};

Result<std::unique_ptr<Stimulus>> make(const StimulusSpec& spec) {
  const auto& p = spec.numbers;
  const auto& f = spec.lists.at("f_Hz");
  std::vector<double> stretch = spec.lists.at("stretch_s");
  if (stretch.size() == 1) stretch.resize(f.size(), stretch.front());
  if (f.empty() || stretch.size() != f.size())
    return fail(ErrorCode::usage, "stimulus 'jump' needs one duration for each frequency", {},
                "give stretch_s as many values as f_Hz, or one for all");
  FORCEGATE_CHECK_OK(check_contact("jump", p.at("m_N") - p.at("A_N")));
  return std::unique_ptr<Stimulus>(
      std::make_unique<Jump>(f, stretch, p.at("A_N"), p.at("m_N"), p.at("ramp_s")));
}

const Registration<StimulusKind> kRegistered{
    {"jump",
     "A sine whose frequency changes at once, phase continuous, amplitude and mean the same",
     {{"f_Hz", "Hz", kRequired, 0.0, 50.0, "frequencies in order; 0 = a pause", true},
      {"stretch_s", "s", kRequired, 1e-2, kLongest_s, "how long each of them lasts", true},
      amplitude_parameter(),
      mean_parameter(),
      ramp_parameter()},
     make}};

}  // namespace
}  // namespace forcegate::stimuli
