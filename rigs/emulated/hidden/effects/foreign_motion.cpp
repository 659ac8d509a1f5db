// Outside the catalogue, driven by motion and history: gain that turns with the wheel, a hardening resonance,
// the memory of earlier maxima, alternating cycles, and gain that switches with the loading rate.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "rigs/emulated/hidden/effect.h"
#include "rigs/emulated/hidden/numeric.h"

namespace forcegate::hidden {
namespace {

/// Gain varies with the wheel's angle in a high harmonic and so not as a function of force.
class AngleGain final : public HiddenEffect {
 public:
  explicit AngleGain(Rng& rng)
      : order_(static_cast<double>(3 + rng.below(4))), phase_rad_(rng.uniform(0.0, 2.0 * kPi)) {}
  std::string form() const override {
    return fmt::format("gain swings by {:.2f} % with {:.0f} theta", 100 * kSize * strength_, order_);
  }
  void voltage(Waves& waves, const RecordContext&) override {
    if (strength_ == 0.0) return;
    for (std::size_t i = 0; i < waves.size(); ++i)
      waves.voltage_V[i] *= 1.0 + kSize * strength_ * portable::sin(order_ * waves.theta_rad[i] + phase_rad_);
  }

 private:
  static constexpr double kSize = 0.02;
  double order_, phase_rad_;
};

/// A mass on a hardening spring rides on the film (Duffing), driven by the force; its motion adds to the
/// output.
class HardeningResonance final : public HiddenEffect {
 public:
  explicit HardeningResonance(Rng& rng)
      : natural_Hz_(rng.uniform(1.2, 4.0)),
        damping_(rng.uniform(0.02, 0.06)),
        hardening_(rng.uniform(0.3, 1.5)) {}
  std::string form() const override {
    return fmt::format("Duffing oscillator, {:.2f} Hz, damping {:.3f}, hardening {:.2f}", natural_Hz_,
                       damping_, hardening_);
  }
  void film(Waves& waves, const RecordContext&) override {
    if (strength_ == 0.0) return;
    const double w = 2.0 * kPi * natural_Hz_, h = waves.step_s;
    double x = 0.0, v = 0.0, before = waves.film_N.front();
    for (double& film_N : waves.film_N) {
      const double kick = film_N - before;  // base motion: acceleration is the second difference of the force
      before = film_N;
      v += kick * w - h * (2.0 * damping_ * w * v + w * w * x * (1.0 + hardening_ * x * x));
      x += h * v;
      x = std::clamp(x, -4.0, 4.0);
      film_N += kSize * strength_ * x;
    }
  }

 private:
  static constexpr double kSize = 0.05;
  double natural_Hz_, damping_, hardening_;
};

/// Softening below the largest force of the recent past, as in filled rubber (Mullins), with a memory that
/// fades.
class MaximumMemory final : public HiddenEffect {
 public:
  explicit MaximumMemory(Rng& rng) : reach_N_(rng.uniform(0.3, 1.0)) {}
  std::string form() const override {
    return fmt::format(
        "below the largest force of the last 25 s the output sinks by {:.2f} % within {:.2f} N",
        100 * kSize * strength_, reach_N_);
  }
  void film(Waves& waves, const RecordContext&) override {
    if (strength_ == 0.0) return;
    double largest = 0.0;
    const double forget = waves.step_s / 25.0;
    for (double& film_N : waves.film_N) {
      largest = std::max(film_N, largest - forget * largest);
      const double below = (largest - film_N) / reach_N_;
      film_N *= 1.0 - kSize * strength_ * below * below / (1.0 + below * below) * largest / 5.0;
    }
  }

 private:
  static constexpr double kSize = 0.04;
  double reach_N_;
};

/// Every second cycle answers otherwise.
class AlternatingCycles final : public HiddenEffect {
 public:
  explicit AlternatingCycles(Rng& rng) : size_(rng.uniform(0.7, 1.3)) {}
  std::string form() const override {
    return fmt::format("every second loading answers {:.2f} % more", 100 * kSize * size_ * strength_);
  }
  void film(Waves& waves, const RecordContext& context) override {
    if (strength_ == 0.0) return;
    const double low = context.plan.low_N + 0.3 * (context.plan.high_N - context.plan.low_N);
    const double high = context.plan.low_N + 0.7 * (context.plan.high_N - context.plan.low_N);
    bool above = false, odd = false;
    double gain = 0.0;
    for (double& film_N : waves.film_N) {
      if (!above && film_N > high) above = true;
      if (above && film_N < low) above = false, odd = !odd;
      gain += waves.step_s / 0.05 * ((odd ? 1.0 : 0.0) - gain);
      film_N *= 1.0 + kSize * size_ * strength_ * gain;
    }
  }

 private:
  static constexpr double kSize = 0.03;
  double size_;
};

/// Above one loading rate the film answers stiffer, until the rate falls below another.
class RateSwitch final : public HiddenEffect {
 public:
  explicit RateSwitch(Rng& rng)
      : on_N_per_s_(rng.uniform(1.0, 3.0)),
        off_share_(rng.uniform(0.3, 0.7)),
        stay_s_(rng.uniform(0.5, 4.0)) {}
  std::string form() const override {
    return fmt::format("gain {:+.2f} % once the rate exceeds {:.2f} N/s, back {:.1f} s after it fell",
                       -100 * kSize * strength_, on_N_per_s_, stay_s_);
  }
  void film(Waves& waves, const RecordContext&) override {
    if (strength_ == 0.0) return;
    double rate = 0.0, before = waves.film_N.front(), left_s = 0.0, gain = 0.0;
    for (double& film_N : waves.film_N) {
      const double now = std::abs(film_N - before) / waves.step_s;
      before = film_N;
      rate += waves.step_s / 0.03 * (now - rate);
      if (rate > on_N_per_s_)
        left_s = stay_s_;
      else if (rate < off_share_ * on_N_per_s_)
        left_s = std::max(0.0, left_s - waves.step_s);
      gain += waves.step_s / 0.05 * ((left_s > 0.0 ? 1.0 : 0.0) - gain);
      film_N *= 1.0 - kSize * strength_ * gain;
    }
  }

 private:
  static constexpr double kSize = 0.03;
  double on_N_per_s_, off_share_, stay_s_;
};

const HiddenRegistration kAngle{{.name = "foreign_angle_gain",
                                 .side = "rig",
                                 .foreign = true,
                                 .needs_theta = true,
                                 .depends_on = {"angle"},
                                 .strength_max = 12.0,
                                 .make = [](Rng& rng) { return std::make_unique<AngleGain>(rng); }}};

const HiddenRegistration kResonance{
    {.name = "foreign_resonance",
     .side = "sensor",
     .foreign = true,
     .needs_kinds = {"prbs", "steps"},
     .depends_on = {"rate", "frequency", "history"},
     .strength_max = 12.0,
     .make = [](Rng& rng) { return std::make_unique<HardeningResonance>(rng); }}};

const HiddenRegistration kMemory{{.name = "foreign_maximum_memory",
                                  .side = "sensor",
                                  .foreign = true,
                                  .needs_kinds = {"staircase", "steps"},
                                  .depends_on = {"history", "force"},
                                  .strength_max = 12.0,
                                  .make = [](Rng& rng) { return std::make_unique<MaximumMemory>(rng); }}};

const HiddenRegistration kAlternating{
    {.name = "foreign_alternating_cycles",
     .side = "sensor",
     .foreign = true,
     .depends_on = {"history", "time"},
     .strength_max = 12.0,
     .make = [](Rng& rng) { return std::make_unique<AlternatingCycles>(rng); }}};

const HiddenRegistration kRate{{.name = "foreign_rate_switch",
                                .side = "sensor",
                                .foreign = true,
                                .needs_kinds = {"prbs", "steps", "sweep"},
                                .depends_on = {"rate", "history", "frequency"},
                                .strength_max = 12.0,
                                .make = [](Rng& rng) { return std::make_unique<RateSwitch>(rng); }}};

}  // namespace
}  // namespace forcegate::hidden
