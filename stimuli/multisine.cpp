// Sum of sines (Lebosse 2011, eq. 6 and IV-A2c), faded in from its lowest force so that nothing jumps:
//   s(t) = sum A_i sin(2 pi f_i t + phase_i),  F = low + w(t) (m + s(t) - low),  low = m + min s,
// where w rises from 0 to 1 in fade_s as a raised cosine. min s and max s are found on a grid of 64 points a
// period of the highest component over the whole record; the bounds allow for what the grid can miss.

#include "stimuli/profile.h"

namespace forcegate::stimuli {
namespace {

struct Component {
  double f_Hz, A_N, phase_rad;
};

class Multisine final : public Profile {
 public:
  Multisine(std::vector<Component> components, double m_N, double duration_s, double ramp_s, double fade_s)
      : components_(std::move(components)), m_N_(m_N), fade_s_(fade_s) {
    duration_s_ = duration_s;
    double sum_A = 0.0, f_low = components_.front().f_Hz, f_high = f_low;
    for (const Component& c : components_) {
      sum_A += c.A_N;
      f_low = std::min(f_low, c.f_Hz);
      f_high = std::max(f_high, c.f_Hz);
    }
    const auto [s_min, s_max] = scan(duration_s - ramp_s, f_high);
    constexpr double kGridMiss = 0.0013;  // (pi/64)^2 / 2 of a sine's amplitude
    low_ = std::max(m_N - sum_A, m_N + s_min - kGridMiss * sum_A);
    set_ramp(ramp_s, low_);
    facts_.excitation_start_s = ramp_s + fade_s;
    facts_.mean_N = m_N + 0.5 * (s_min + s_max);
    facts_.amplitude_N = 0.5 * (s_max - s_min);
    facts_.lowest_frequency_Hz = f_low;
    facts_.maximum_N = std::min(m_N + sum_A, m_N + s_max + kGridMiss * sum_A);
    facts_.dynamic = true;
  }

  void fill(double first_t_s, double step_s, std::size_t n, double* out_N) const override {
    const std::int64_t first = grid_index(first_t_s, step_s);
    if (first < 0 || first_t_s < ramp_s_ + fade_s_) return Stimulus::fill(first_t_s, step_s, n, out_N);
    std::fill(out_N, out_N + n, m_N_);
    for (const Component& c : components_)
      add_cosine(c.A_N, c.f_Hz, c.phase_rad - 0.5 * kPi - kTwoPi * c.f_Hz * ramp_s_, first, step_s, n, out_N);
  }

 protected:
  double profile_N(double since_s) const override {
    double s = 0.0;
    for (const Component& c : components_)
      s += c.A_N * portable::sin(kTwoPi * c.f_Hz * since_s + c.phase_rad);
    if (fade_s_ > 0.0 && since_s < fade_s_) return low_ + smooth_step(since_s / fade_s_) * (m_N_ + s - low_);
    return m_N_ + s;
  }

 private:
  std::pair<double, double> scan(double length_s, double f_high) const {
    constexpr std::size_t kMost = 2'000'000;
    const double step_s = 1.0 / (64.0 * f_high);
    const auto wanted = static_cast<std::size_t>(std::max(length_s, 0.0) / step_s) + 2;
    if (wanted > kMost) {  // too long to look at whole: the bound that needs no scan
      double sum_A = 0.0;
      for (const Component& c : components_) sum_A += c.A_N;
      return {-sum_A, sum_A};
    }
    const std::size_t n = wanted;
    std::vector<double> s(n, 0.0);
    for (const Component& c : components_)
      add_cosine(c.A_N, c.f_Hz, c.phase_rad - 0.5 * kPi, 0, step_s, n, s.data());
    const auto [low, high] = std::minmax_element(s.begin(), s.end());
    return {*low, *high};
  }

  std::vector<Component> components_;
  double m_N_, fade_s_, low_ = 0.0;
};

Result<std::unique_ptr<Stimulus>> make(const StimulusSpec& spec) {
  const auto& p = spec.numbers;
  const auto& f = spec.lists.at("f_Hz");
  const auto& A = spec.lists.at("A_N");
  auto phase = spec.lists.at("phase_rad");
  if (f.empty() || f.size() != A.size() || (!phase.empty() && phase.size() != f.size()))
    return fail(ErrorCode::usage, "stimulus 'multisine' needs as many amplitudes as frequencies", {},
                "give f_Hz and A_N (and phase_rad, if any) lists of one length");
  phase.resize(f.size(), 0.0);
  std::vector<Component> components;
  double sum_A = 0.0;
  for (std::size_t i = 0; i < f.size(); ++i) {
    components.push_back({f[i], A[i], phase[i]});
    sum_A += A[i];
  }
  FORCEGATE_CHECK_OK(check_contact("multisine", p.at("m_N") - sum_A));
  if (const double whole_s = p.at("ramp_s") + p.at("fade_s"); whole_s >= p.at("duration_s"))
    return fail(ErrorCode::usage, "stimulus 'multisine' has its full size at " + shortest(whole_s) + " s, loading ramp and fade included, and ends at " + shortest(p.at("duration_s")) + " s", {},
                "raise duration_s or lower fade_s");
  return std::unique_ptr<Stimulus>(std::make_unique<Multisine>(
      std::move(components), p.at("m_N"), p.at("duration_s"), p.at("ramp_s"), p.at("fade_s")));
}

const Registration<StimulusKind> kRegistered{
    {"multisine",
     "Sum of sines: F = m + sum A_i sin(2 pi f_i t + phase_i), faded in from its lowest force",
     {{"f_Hz", "Hz", kRequired, 1e-4, 50.0, "frequencies", true},
      {"A_N", "N", kRequired, 0.0, kForceLimit_N, "amplitudes", true},
      {"phase_rad", "rad", 0.0, -100.0, 100.0, "phases; left out = 0", true},
      mean_parameter(),
      duration_parameter(1200.0),
      ramp_parameter(),
      {"fade_s", "s", 2.0, 0.0, 1e4, "time in which the sum grows to its full size"}},
     make}};

}  // namespace
}  // namespace forcegate::stimuli
