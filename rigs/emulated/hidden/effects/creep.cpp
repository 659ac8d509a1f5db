// Growth of the output under constant load. Two forms: fractional (power-law) compliance as a continuous
// spectrum of relaxation times, and flow whose rate goes with a power of the stress that is left (Norton 1929).

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "rigs/emulated/hidden/effect.h"
#include "rigs/emulated/hidden/numeric.h"

namespace forcegate::hidden {
namespace {

constexpr double kBlock_s = 0.02;  // slow states advance on this clock

/// Calls advance(mean force, length) for each block and adds its answer to the samples of the block.
template <class Advance>
void add_in_blocks(Waves& waves, Advance advance) {
  const auto length = std::max<std::size_t>(1, static_cast<std::size_t>(kBlock_s / waves.step_s + 0.5));
  for (std::size_t first = 0; first < waves.size(); first += length) {
    const std::size_t last = std::min(first + length, waves.size());
    double sum = 0.0;
    for (std::size_t i = first; i < last; ++i) sum += waves.film_N[i];
    const double n = static_cast<double>(last - first), add = advance(sum / n, n * waves.step_s);
    for (std::size_t i = first; i < last; ++i) waves.film_N[i] += add;
  }
}

class FractionalCreep final : public HiddenEffect {
 public:
  explicit FractionalCreep(Rng& rng) : order_(rng.uniform(0.04, 0.22)) {
    double total = 0.0;
    for (std::size_t k = 0; k < kModes; ++k) {
      tau_s_[k] = 0.3 * portable::pow(2.0e4, static_cast<double>(k) / (kModes - 1));
      total += weight_[k] = portable::pow(tau_s_[k], order_);
    }
    for (double& w : weight_) w /= total;
  }

  std::string form() const override {
    return fmt::format("fractional compliance t^{:.3f}, {:.2f} % of the load in two hours", order_,
                       100 * kShare * strength_);
  }
  void begin_campaign() override { state_.fill(0.0); }
  void begin_record(const RecordContext& context) override {
    for (std::size_t k = 0; k < kModes; ++k)
      state_[k] *= portable::exp(-context.plan.rest_before_s / tau_s_[k]);
    length_s_ = 0.0;
  }
  void film(Waves& waves, const RecordContext&) override {
    if (strength_ == 0.0) return;
    add_in_blocks(waves, [&](double force_N, double length_s) {
      if (length_s != length_s_) {
        length_s_ = length_s;
        for (std::size_t k = 0; k < kModes; ++k) keep_[k] = portable::exp(-length_s / tau_s_[k]);
      }
      double sum = 0.0;
      for (std::size_t k = 0; k < kModes; ++k) {
        state_[k] = force_N + keep_[k] * (state_[k] - force_N);
        sum += weight_[k] * state_[k];
      }
      return kShare * strength_ * sum;
    });
  }

 private:
  static constexpr std::size_t kModes = 26;
  static constexpr double kShare = 0.06;
  double order_, length_s_ = 0.0;
  std::array<double, kModes> tau_s_{}, weight_{}, state_{}, keep_{};
};

class NortonCreep final : public HiddenEffect {
 public:
  explicit NortonCreep(Rng& rng)
      : tau_s_(portable::exp(rng.uniform(portable::log(15.0), portable::log(150.0)))), exponent_(rng.uniform(2.0, 4.0)) {}

  std::string form() const override {
    return fmt::format("flow at a rate ~ (F - z)^{:.1f}, {:.0f} s at {:.0f} N, {:.2f} % of the load", exponent_, tau_s_, kScale_N, 100 * kShare * strength_);
  }
  void begin_campaign() override { z_N_ = 0.0; }
  void begin_record(const RecordContext& context) override { flow(0.0, context.plan.rest_before_s); }
  void film(Waves& waves, const RecordContext&) override {
    if (strength_ == 0.0) return;
    add_in_blocks(waves, [&](double force_N, double length_s) {
      flow(force_N, length_s);
      return kShare * strength_ * z_N_;
    });
  }

 private:
  /// Exact for a constant load: |x|^(1 - n) grows with the time, x = (F - z) / scale.
  void flow(double force_N, double length_s) {
    const double x = (force_N - z_N_) / kScale_N, size = std::abs(x);
    if (size < 1e-12) return;
    const double left = portable::pow(portable::pow(size, 1.0 - exponent_) + (exponent_ - 1.0) * length_s / tau_s_, 1.0 / (1.0 - exponent_));
    z_N_ = force_N - std::copysign(kScale_N * left, x);
  }
  static constexpr double kShare = 0.06, kScale_N = 5.0;
  double tau_s_, exponent_, z_N_ = 0.0;
};

const HiddenRegistration kRegistered{{.name = "creep",
                                      .side = "sensor",
                                      .needs_kinds = {"hold", "hold", "staircase"},
                                      .strength_max = 12.0,
                                      .make = [](Rng& rng) -> std::unique_ptr<HiddenEffect> {
                                        if (rng.uniform() < 0.6)
                                          return std::make_unique<FractionalCreep>(rng);
                                        return std::make_unique<NortonCreep>(rng);
                                      }}};

}  // namespace
}  // namespace forcegate::hidden
