// What cycling leaves behind: wear by damage at reversals, slow recovery at rest, and the bump after a
// frequency jump.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "rigs/emulated/hidden/effect.h"
#include "rigs/emulated/hidden/numeric.h"

namespace forcegate::hidden {
namespace {

/// Damage by half-cycles, D += (dF / 3 N)^p; the contacts lost reduce the gain as (1 + D / D0)^-m.
class ReversalWear final : public HiddenEffect {
 public:
  explicit ReversalWear(Rng& rng) : power_(rng.uniform(1.0, 2.5)), scale_(rng.uniform(300.0, 3000.0)) {}
  std::string form() const override {
    return fmt::format("damage (dF / 3 N)^{:.2f} at each reversal, gain (1 + D / {:.0f})^-{:.4f}", power_,
                       scale_, kExponent * strength_);
  }
  void begin_campaign() override { damage_ = 0.0; }
  void film(Waves& waves, const RecordContext&) override {
    if (strength_ == 0.0) return;
    double turn = waves.film_N.front(), extreme = turn;
    bool rising = true;
    double gain = gain_now();
    for (double& film_N : waves.film_N) {
      if (rising ? film_N > extreme : film_N < extreme) extreme = film_N;
      if (std::abs(film_N - extreme) > 0.08) {
        damage_ += portable::pow(std::abs(extreme - turn) / 3.0 + 1e-9, power_);
        gain = gain_now();
        turn = extreme;
        extreme = film_N;
        rising = !rising;
      }
      film_N *= gain;
    }
  }

 private:
  static constexpr double kExponent = 0.05;
  double gain_now() const { return portable::pow(1.0 + damage_ / scale_, -kExponent * strength_); }
  double power_, scale_, damage_ = 0.0;
};

/// State r in [0, 1]: builds up in cycling, relaxes as a stretched exponential of the time since; output (1 -
/// k r).
class SlowRecovery final : public HiddenEffect {
 public:
  explicit SlowRecovery(Rng& rng)
      : build_s_(rng.uniform(250.0, 900.0)),
        tau_s_(rng.uniform(1200.0, 4000.0)),
        beta_(rng.uniform(0.45, 0.8)) {}
  std::string form() const override {
    return fmt::format("cycling lowers the output by {:.2f} %, which relaxes as exp(-(t / {:.0f} s)^{:.2f})",
                       100 * kLoss * strength_, tau_s_, beta_);
  }
  void begin_campaign() override { left_ = 0.0, since_s_ = 0.0; }
  void begin_record(const RecordContext& context) override { since_s_ += context.plan.rest_before_s; }
  void film(Waves& waves, const RecordContext& context) override {
    if (strength_ == 0.0) return;
    const double h = waves.step_s;
    if (!context.plan.dynamic) {
      const auto block = static_cast<std::size_t>(0.5 / h) + 1;
      for (std::size_t i = 0; i < waves.size(); ++i) {
        if (i % block == 0) now_ = left_ * stretched(since_s_ + static_cast<double>(i) * h, tau_s_, beta_);
        waves.film_N[i] *= 1.0 - kLoss * strength_ * now_;
      }
      since_s_ += static_cast<double>(waves.size()) * h;
      return;
    }
    now_ = left_ * stretched(since_s_, tau_s_, beta_);
    const double share = std::min(1.0, context.plan.amplitude_N()), follow = h / build_s_;
    for (double& film_N : waves.film_N) {
      now_ += follow * (share - now_);
      film_N *= 1.0 - kLoss * strength_ * now_;
    }
    left_ = now_;
    since_s_ = 0.0;
  }

 private:
  static constexpr double kLoss = 0.06;
  double build_s_, tau_s_, beta_, left_ = 0.0, since_s_ = 0.0, now_ = 0.0;
};

/// After each jump the swing above the minimum grows and returns as a power of time.
class FrequencyBump final : public HiddenEffect {
 public:
  explicit FrequencyBump(Rng& rng) : fade_s_(rng.uniform(8.0, 30.0)), power_(rng.uniform(1.2, 2.2)) {}
  std::string form() const override {
    return fmt::format("swing grows by {:.2f} % at a jump and fades as (1 + t / {:.1f} s)^-{:.2f}",
                       100 * kSize * strength_, fade_s_, power_);
  }
  void voltage(Waves& waves, const RecordContext& context) override {
    const RecordPlan& plan = context.plan;
    if (strength_ == 0.0 || plan.event_s.empty()) return;
    for (std::size_t i = 0; i < waves.size(); ++i) {
      const double t = static_cast<double>(i) * waves.step_s;
      double bump = 0.0;
      for (std::size_t k = 0; k < plan.event_s.size(); ++k) {
        const double age = t - plan.event_s[k];
        if (age <= 0.0 || age > 40.0 * fade_s_) continue;
        const double jump = std::abs(portable::log(plan.frequencies_Hz[k + 1] / plan.frequencies_Hz[k]));
        bump += jump * (1.0 - portable::exp(-age / 0.8)) * portable::pow(1.0 + age / fade_s_, -power_);
      }
      if (bump == 0.0) continue;
      const double swing = std::max(0.0, waves.film_N[i] - plan.low_N) / context.truth.gain_N_per_V;
      waves.voltage_V[i] += kSize * strength_ * bump * swing;
    }
  }

 private:
  static constexpr double kSize = 0.05;
  double fade_s_, power_;
};

const HiddenRegistration kWear{{.name = "wear",
                                .side = "sensor",
                                .rival = Rival::repeatability,
                                .needs_kinds = {"ramp", "ramp", "sine", "sine", "sine"},
                                .strength_max = 20.0,
                                .make = [](Rng& rng) { return std::make_unique<ReversalWear>(rng); }}};

const HiddenRegistration kRecovery{{.name = "slow_recovery",
                                    .side = "sensor",
                                    .rival = Rival::repeatability,
                                    .needs_kinds = {"ramp", "ramp", "ramp", "sine", "sine", "hold"},
                                    .strength_max = 8.0,
                                    .make = [](Rng& rng) { return std::make_unique<SlowRecovery>(rng); }}};

const HiddenRegistration kBump{{.name = "frequency_bump",
                                .side = "sensor",
                                .needs_kinds = {"switch", "switch", "switch"},
                                .strength_max = 20.0,
                                .make = [](Rng& rng) { return std::make_unique<FrequencyBump>(rng); }}};

}  // namespace
}  // namespace forcegate::hidden
