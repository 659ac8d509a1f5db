// Outside the catalogue, driven by time: a chaotic gain, a telegraph signal, and a neighbour's machine.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "rigs/emulated/hidden/effect.h"
#include "rigs/emulated/hidden/numeric.h"

namespace forcegate::hidden {
namespace {

/// Gain follows the first coordinate of Lorenz's system on a slow clock.
class ChaoticGain final : public HiddenEffect {
 public:
  explicit ChaoticGain(Rng& rng) : clock_s_(rng.uniform(6.0, 25.0)), start_(rng.uniform(-8.0, 8.0)) {}
  std::string form() const override {
    return fmt::format("gain follows a Lorenz system, {:.1f} s a unit, {:.2f} %", clock_s_,
                       100 * kSize * strength_);
  }
  void begin_record(const RecordContext& context) override {
    x_ = start_ + 0.7 * static_cast<double>(context.index), y_ = 1.0, z_ = 20.0;
  }
  void voltage(Waves& waves, const RecordContext&) override {
    if (strength_ == 0.0) return;
    const auto block = std::max<std::size_t>(1, static_cast<std::size_t>(0.02 / waves.step_s + 0.5));
    for (std::size_t i = 0; i < waves.size(); ++i) {
      if (i % block == 0) {
        const double h = static_cast<double>(block) * waves.step_s / clock_s_;
        const double dx = 10.0 * (y_ - x_), dy = x_ * (28.0 - z_) - y_, dz = x_ * y_ - 8.0 / 3.0 * z_;
        x_ += h * dx, y_ += h * dy, z_ += h * dz;
      }
      waves.voltage_V[i] *= 1.0 + kSize * strength_ * x_ / 8.0;
    }
  }

 private:
  static constexpr double kSize = 0.02;
  double clock_s_, start_, x_ = 1.0, y_ = 1.0, z_ = 20.0;
};

/// Two levels of gain with exponential dwell times.
class TelegraphGain final : public HiddenEffect {
 public:
  explicit TelegraphGain(Rng& rng)
      : low_s_(rng.uniform(4.0, 40.0)), high_s_(rng.uniform(2.0, 25.0)), seed_(rng.next()) {}
  std::string form() const override {
    return fmt::format("gain switches by {:.2f} %, {:.1f} s and {:.1f} s on average", 100 * kSize * strength_,
                       low_s_, high_s_);
  }
  void voltage(Waves& waves, const RecordContext& context) override {
    if (strength_ == 0.0) return;
    Rng rng(seed_ ^ context.plan.seed, "telegraph");
    bool high = rng.uniform() < 0.5;
    double until_s = 0.0;
    for (std::size_t i = 0; i < waves.size(); ++i) {
      while (static_cast<double>(i) * waves.step_s >= until_s) {
        high = !high;
        until_s -= (high ? high_s_ : low_s_) * portable::log(1.0 - rng.uniform());
      }
      if (high) waves.voltage_V[i] *= 1.0 + kSize * strength_;
    }
  }

 private:
  static constexpr double kSize = 0.03;
  double low_s_, high_s_;
  std::uint64_t seed_;
};

/// A machine next door: on for some minutes of each cycle; while on, output sinks and swings.
class NeighbourMachine final : public HiddenEffect {
 public:
  explicit NeighbourMachine(Rng& rng)
      : cycle_s_(rng.uniform(90.0, 400.0)),
        duty_(rng.uniform(0.25, 0.6)),
        swing_Hz_(rng.uniform(0.4, 2.3)),
        sign_(rng.uniform() < 0.5 ? 1.0 : -1.0) {}
  std::string form() const override {
    return fmt::format("every {:.0f} s for a share of {:.2f}: {:+.1f} mV and a swing at {:.2f} Hz", cycle_s_,
                       duty_, 1e3 * sign_ * kSize_V * strength_, swing_Hz_);
  }
  void voltage(Waves& waves, const RecordContext& context) override {
    if (strength_ == 0.0) return;
    for (std::size_t i = 0; i < waves.size(); ++i) {
      const double t = context.plan.start_s + static_cast<double>(i) * waves.step_s;
      const double phase = t / cycle_s_ - std::floor(t / cycle_s_);
      if (phase >= duty_) continue;
      const double turns = swing_Hz_ * t;
      waves.voltage_V[i] +=
          kSize_V * strength_ * (sign_ + 0.7 * portable::sin(2.0 * kPi * (turns - std::floor(turns))));
    }
  }

 private:
  static constexpr double kSize_V = 0.08;
  double cycle_s_, duty_, swing_Hz_, sign_;
};

const HiddenRegistration kChaos{{.name = "foreign_chaotic_gain",
                                 .side = "sensor",
                                 .foreign = true,
                                 .depends_on = {"time"},
                                 .strength_max = 12.0,
                                 .make = [](Rng& rng) { return std::make_unique<ChaoticGain>(rng); }}};

const HiddenRegistration kTelegraph{{.name = "foreign_telegraph",
                                     .side = "sensor",
                                     .foreign = true,
                                     .depends_on = {"time"},
                                     .strength_max = 12.0,
                                     .make = [](Rng& rng) { return std::make_unique<TelegraphGain>(rng); }}};

const HiddenRegistration kNeighbour{
    {.name = "foreign_neighbour_machine",
     .side = "instrument",
     .foreign = true,
     .depends_on = {"time"},
     .strength_max = 12.0,
     .make = [](Rng& rng) { return std::make_unique<NeighbourMachine>(rng); }}};

}  // namespace
}  // namespace forcegate::hidden
