// Air on the film: temperature through two thermal lags, humidity by sorption, and heat of the film's own
// current.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "rigs/emulated/hidden/effect.h"
#include "rigs/emulated/hidden/numeric.h"

namespace forcegate::hidden {
namespace {

/// Walks campaign time in steps of a few seconds; the state is that at `now_s`.
class Walker {
 public:
  void restart() { now_s_ = 0.0, started_ = false; }
  template <class Start, class Step>
  void walk(double until_s, Start start, Step step) {
    if (!started_) start();
    started_ = true;
    while (now_s_ < until_s) {
      const double length_s = std::min(4.0, until_s - now_s_);
      step(now_s_, length_s);
      now_s_ += length_s;
    }
  }

 private:
  double now_s_ = 0.0;
  bool started_ = false;
};

/// Applies gain and offset of a slowly varying state to the voltage, block by block.
template <class State>
void modulate(Waves& waves, const RecordContext& context, State state) {
  const auto block = std::max<std::size_t>(1, static_cast<std::size_t>(1.0 / waves.step_s));
  double gain = 1.0, offset_V = 0.0;
  for (std::size_t i = 0; i < waves.size(); ++i) {
    if (i % block == 0) {
      const auto [g, o] = state(context.plan.start_s + static_cast<double>(i) * waves.step_s);
      gain = g, offset_V = o;
    }
    waves.voltage_V[i] = waves.voltage_V[i] * gain + offset_V;
  }
}

class ThermalFilm final : public HiddenEffect {
 public:
  explicit ThermalFilm(Rng& rng)
      : body_s_(rng.uniform(60.0, 700.0)),
        film_s_(rng.uniform(10.0, 80.0)),
        sign_(rng.uniform() < 0.8 ? 1.0 : -1.0),
        offset_V_per_C_(rng.uniform(-0.008, 0.012)),
        bend_(rng.uniform(-0.05, 0.05)) {}
  std::string form() const override {
    return fmt::format("gain {:+.3f} %/C (1 {:+.3f} dT), offset {:+.2f} mV/C, lags {:.0f} s and {:.0f} s",
                       100 * kGain * sign_ * strength_, bend_, 1e3 * offset_V_per_C_ * strength_, body_s_,
                       film_s_);
  }
  void begin_campaign() override { walker_.restart(); }
  void voltage(Waves& waves, const RecordContext& context) override {
    if (strength_ == 0.0) return;
    modulate(waves, context, [&](double at_s) {
      const Climate& air = context.climate;
      walker_.walk(
          at_s, [&] { body_C_ = film_C_ = air.temperature_C(0.0); },
          [&](double now_s, double length_s) {
            body_C_ += (1.0 - portable::exp(-length_s / body_s_)) * (air.temperature_C(now_s) - body_C_);
            film_C_ += (1.0 - portable::exp(-length_s / film_s_)) * (body_C_ - film_C_);
          });
      const double dT = film_C_ - air.mean_temperature_C();
      const double gain = 1.0 + kGain * sign_ * strength_ * dT * (1.0 + bend_ * dT);
      return std::pair(gain, offset_V_per_C_ * strength_ * dT);
    });
  }

 private:
  static constexpr double kGain = 0.0036;
  double body_s_, film_s_, sign_, offset_V_per_C_, bend_, body_C_ = 0.0, film_C_ = 0.0;
  Walker walker_;
};

/// Water taken up by the ink: dw/dt = (w_eq - w) / tau, faster in than out; resistance grows as w^1.4.
class HumidFilm final : public HiddenEffect {
 public:
  explicit HumidFilm(Rng& rng) : in_s_(rng.uniform(400.0, 2500.0)), out_s_(rng.uniform(1500.0, 6000.0)) {}
  std::string form() const override {
    return fmt::format("water uptake {:.0f} s in, {:.0f} s out, output / (1 + {:.3f} w^1.4)", in_s_, out_s_,
                       kLoss * strength_);
  }
  void begin_campaign() override { walker_.restart(); }
  void voltage(Waves& waves, const RecordContext& context) override {
    if (strength_ == 0.0) return;
    modulate(waves, context, [&](double at_s) {
      const Climate& air = context.climate;
      walker_.walk(
          at_s, [&] { water_ = air.humidity_pct(0.0) / 50.0; },
          [&](double now_s, double length_s) {
            const double target = std::max(0.0, air.humidity_pct(now_s)) / 50.0;
            water_ +=
                (1.0 - portable::exp(-length_s / (target > water_ ? in_s_ : out_s_))) * (target - water_);
          });
      const double dry = portable::pow(air.mean_humidity_pct() / 50.0, 1.4), wet = portable::pow(water_, 1.4);
      return std::pair((1.0 + kLoss * strength_ * dry) / (1.0 + kLoss * strength_ * wet), 0.0);
    });
  }

 private:
  static constexpr double kLoss = 0.1;
  double in_s_, out_s_, water_ = 0.0;
  Walker walker_;
};

/// Power drive^2 * conductance heats film and backing; the hot film conducts better.
class SelfHeating final : public HiddenEffect {
 public:
  explicit SelfHeating(Rng& rng)
      : film_s_(rng.uniform(4.0, 20.0)),
        backing_s_(rng.uniform(60.0, 240.0)),
        share_(rng.uniform(0.3, 0.7)) {}
  std::string form() const override {
    return fmt::format(
        "own power warms film ({:.1f} s) and backing ({:.0f} s): {:+.2f} % at full load and 5 V", film_s_,
        backing_s_, 100 * kGain * strength_);
  }
  void begin_campaign() override { film_ = backing_ = 0.0; }
  void begin_record(const RecordContext& context) override {
    film_ *= portable::exp(-context.plan.rest_before_s / film_s_);
    backing_ *= portable::exp(-context.plan.rest_before_s / backing_s_);
  }
  void voltage(Waves& waves, const RecordContext& context) override {
    if (strength_ == 0.0) return;
    const double drive = context.plan.drive_V / 5.0, per_range = drive * drive / context.voltage_range_V;
    const double to_film = waves.step_s / film_s_, to_backing = waves.step_s / backing_s_;
    for (double& voltage_V : waves.voltage_V) {
      const double power = std::max(0.0, voltage_V) * per_range;
      film_ += to_film * (power - film_);
      backing_ += to_backing * (power - backing_);
      voltage_V *= 1.0 + kGain * strength_ * (share_ * film_ + (1.0 - share_) * backing_);
    }
  }

 private:
  static constexpr double kGain = 0.04;
  double film_s_, backing_s_, share_, film_ = 0.0, backing_ = 0.0;
};

const HiddenRegistration kThermal{{.name = "thermal",
                                   .side = "sensor",
                                   .rival = Rival::repeatability,
                                   .needs_climate = true,
                                   .needs_kinds = {"ramp", "ramp", "hold"},
                                   .cause = Cause::temperature,
                                   .strength_max = 12.0,
                                   .make = [](Rng& rng) { return std::make_unique<ThermalFilm>(rng); }}};

const HiddenRegistration kHumidity{{.name = "humidity",
                                    .side = "sensor",
                                    .rival = Rival::repeatability,
                                    .needs_climate = true,
                                    .needs_kinds = {"ramp", "ramp", "hold"},
                                    .cause = Cause::humidity,
                                    .strength_max = 15.0,
                                    .make = [](Rng& rng) { return std::make_unique<HumidFilm>(rng); }}};

const HiddenRegistration kSelfHeating{{.name = "self_heating",
                                       .side = "sensor",
                                       .needs_drive = true,
                                       .needs_kinds = {"hold", "hold", "staircase", "ramp"},
                                       .strength_max = 8.0,
                                       .make = [](Rng& rng) { return std::make_unique<SelfHeating>(rng); }}};

}  // namespace
}  // namespace forcegate::hidden
