// The reference: zero that warms up and wanders, and noise beyond its data sheet.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "rigs/emulated/hidden/effect.h"
#include "rigs/emulated/hidden/numeric.h"

namespace forcegate::hidden {
namespace {

/// Zero(t) = size (log(1 + t / t0) + wander), t in campaign time, the wander an Ornstein-Uhlenbeck walk.
class WarmUp final : public HiddenEffect {
 public:
  explicit WarmUp(Rng& rng)
      : start_s_(rng.uniform(200.0, 2000.0)),
        tau_s_(rng.uniform(1500.0, 6000.0)),
        sign_(rng.uniform() < 0.5 ? 1.0 : -1.0),
        wander_(rng.uniform(0.1, 0.5)),
        seed_(rng.next()) {}
  std::string form() const override {
    return fmt::format("zero {:+.4f} N log(1 + t / {:.0f} s) and a walk of {:.4f} N over {:.0f} s",
                       sign_ * kSize_N * strength_, start_s_, wander_ * kSize_N * strength_, tau_s_);
  }
  void begin_campaign() override {
    rng_ = Rng(seed_);
    walk_ = 0.0, now_s_ = 0.0;
  }
  void reference(Waves& waves, const RecordContext& context) override {
    if (strength_ == 0.0) return;
    const auto block = std::max<std::size_t>(1, static_cast<std::size_t>(0.25 / waves.step_s));
    double zero_N = zero_at(context.plan.start_s), slope = 0.0;
    for (std::size_t i = 0; i < waves.size(); ++i) {
      if (i % block == 0) {
        const double next = zero_at(context.plan.start_s + static_cast<double>(i + block) * waves.step_s);
        slope = (next - zero_N) / static_cast<double>(block);
      }
      zero_N += slope;
      waves.reference_N[i] += zero_N;
    }
  }

 private:
  static constexpr double kSize_N = 0.05, kStep_s = 5.0;
  /// Advances the walk on a fixed grid, so that its path does not depend on the record's clock.
  double zero_at(double campaign_s) {
    while (now_s_ + kStep_s <= campaign_s) {
      walk_ += -walk_ * kStep_s / tau_s_ + std::sqrt(2.0 * kStep_s / tau_s_) * rng_.normal();
      now_s_ += kStep_s;
    }
    return kSize_N * strength_ * (sign_ * portable::log(1.0 + campaign_s / start_s_) + wander_ * walk_);
  }
  double start_s_, tau_s_, sign_, wander_;
  std::uint64_t seed_;
  Rng rng_{1};
  double walk_ = 0.0, now_s_ = 0.0;
};

/// White or low-passed noise of the amplifier, with bursts.
class LoudCell final : public HiddenEffect {
 public:
  explicit LoudCell(Rng& rng)
      : colour_s_(rng.uniform() < 0.6 ? 0.0 : rng.uniform(0.004, 0.03)),
        burst_(rng.uniform(0.0, 1.0)),
        seed_(rng.next()) {}
  std::string form() const override {
    return fmt::format("additional noise of {:.1f} mN, correlated over {:.1f} ms, bursts {:.2f}",
                       1e3 * kSize_N * strength_, 1e3 * colour_s_, burst_);
  }
  void samples(Samples& samples, const RecordContext& context) override {
    if (strength_ == 0.0) return;
    Rng rng(seed_ ^ context.plan.seed, "cell");
    double state = 0.0, level = 1.0, before = 0.0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const double dt = std::max(1e-5, samples.instant_s[i] - before);
      before = samples.instant_s[i];
      const double keep = colour_s_ > 0.0 ? portable::exp(-dt / colour_s_) : 0.0;
      state = keep * state + std::sqrt(1.0 - keep * keep) * rng.normal();
      if (i % 256 == 0) level = 1.0 + burst_ * (rng.uniform() < 0.15 ? 1.0 : 0.0);
      samples.reference_N[i] += kSize_N * strength_ * level * state;
    }
  }

 private:
  static constexpr double kSize_N = 0.03;
  double colour_s_, burst_;
  std::uint64_t seed_;
};

const HiddenRegistration kDrift{{.name = "reference_drift",
                                 .side = "reference",
                                 .measure = Measure::force,
                                 .rival = Rival::repeatability,
                                 .needs_theta = true,
                                 .needs_kinds = {"ramp", "ramp", "hold"},
                                 .strength_max = 20.0,
                                 .make = [](Rng& rng) { return std::make_unique<WarmUp>(rng); }}};

const HiddenRegistration kNoise{{.name = "reference_noise",
                                 .side = "reference",
                                 .measure = Measure::force,
                                 .rival = Rival::reference_noise,
                                 .reducible = false,
                                 .strength_max = 15.0,
                                 .make = [](Rng& rng) { return std::make_unique<LoudCell>(rng); }}};

}  // namespace
}  // namespace forcegate::hidden
