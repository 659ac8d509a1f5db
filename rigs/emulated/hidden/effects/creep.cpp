// Growth of the output under constant load. Two forms: fractional (power-law) compliance as a continuous
// spectrum of relaxation times, and thermally activated closing of gaps with Eyring's hyperbolic-sine rate.

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

class EyringCreep final : public HiddenEffect {
 public:
  explicit EyringCreep(Rng& rng)
      : tau_s_(portable::exp(rng.uniform(portable::log(800.0), portable::log(6000.0)))),
        activation_(rng.uniform(0.12, 0.3)) {}

  std::string form() const override {
    return fmt::format(
        "gaps close at a rate ~ sinh((F - z) / {:.2f} N), time constant {:.0f} s, {:.2f} % of the load",
        activation_ * 5.0, tau_s_, 100 * kShare * strength_);
  }
  void begin_campaign() override { z_N_ = 0.0; }
  void begin_record(const RecordContext& context) override { relax(0.0, context.plan.rest_before_s); }
  void film(Waves& waves, const RecordContext&) override {
    if (strength_ == 0.0) return;
    add_in_blocks(waves, [&](double force_N, double length_s) {
      relax(force_N, length_s);
      return kShare * strength_ * z_N_;
    });
  }

 private:
  /// Exact for a constant load: tanh(x / 2) decays exponentially, x = (F - z) / activation force.
  void relax(double force_N, double length_s) {
    const double scale_N = activation_ * 5.0;
    const double x = std::clamp((force_N - z_N_) / scale_N, -30.0, 30.0);
    const double h = hyperbolic_tangent(0.5 * x) * portable::exp(-length_s / tau_s_);
    z_N_ = force_N - scale_N * portable::log((1.0 + h) / (1.0 - h));
  }
  static constexpr double kShare = 0.06;
  double tau_s_, activation_, z_N_ = 0.0;
};

const HiddenRegistration kRegistered{{.name = "creep",
                                      .side = "sensor",
                                      .needs_kinds = {"hold", "hold", "staircase"},
                                      .strength_max = 12.0,
                                      .make = [](Rng& rng) -> std::unique_ptr<HiddenEffect> {
                                        if (rng.uniform() < 0.6)
                                          return std::make_unique<FractionalCreep>(rng);
                                        return std::make_unique<EyringCreep>(rng);
                                      }}};

}  // namespace
}  // namespace forcegate::hidden
