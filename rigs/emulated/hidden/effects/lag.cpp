// The film seats late. Two forms: diffusion through a slab (modes 1 / (2n + 1)^2) and a chain of three
// layers.

#include <fmt/format.h>

#include <array>

#include "rigs/emulated/hidden/effect.h"
#include "rigs/emulated/hidden/numeric.h"

namespace forcegate::hidden {
namespace {

/// tau y' + y = u, exact for u linear between samples.
class Relaxation {
 public:
  Relaxation() = default;
  Relaxation(double tau_s, double step_s, double start)
      : keep_(portable::exp(-step_s / tau_s)),
        lead_(1.0 - tau_s / step_s * (1.0 - keep_)),
        y_(start),
        before_(start) {}
  double next(double u) {
    y_ = keep_ * y_ + (1.0 - keep_) * before_ + lead_ * (u - before_);
    before_ = u;
    return y_;
  }

 private:
  double keep_ = 0.0, lead_ = 1.0, y_ = 0.0, before_ = 0.0;
};

class SlabLag final : public HiddenEffect {
 public:
  explicit SlabLag(Rng& rng) : tau_s_(rng.uniform(0.015, 0.035)) {}
  std::string form() const override {
    return fmt::format("diffusion through a slab, slowest mode {:.2f} ms", 1e3 * tau_s_ * strength_);
  }
  void film(Waves& waves, const RecordContext&) override {
    if (strength_ == 0.0) return;
    std::array<Relaxation, kModes> modes;
    std::array<double, kModes> weight{};
    double total = 0.0;
    for (std::size_t k = 0; k < kModes; ++k) {
      const double odd = 2.0 * static_cast<double>(k) + 1.0;
      modes[k] = Relaxation(tau_s_ * strength_ / (odd * odd), waves.step_s, waves.film_N.front());
      total += weight[k] = 1.0 / (odd * odd);
    }
    for (double& film_N : waves.film_N) {
      double sum = 0.0;
      for (std::size_t k = 0; k < kModes; ++k) sum += weight[k] * modes[k].next(film_N);
      film_N = sum / total;
    }
  }

 private:
  static constexpr std::size_t kModes = 7;
  double tau_s_;
};

class LayeredLag final : public HiddenEffect {
 public:
  explicit LayeredLag(Rng& rng) : tau_s_(rng.uniform(0.012, 0.03)), split_(rng.uniform(0.4, 0.7)) {}
  std::string form() const override {
    return fmt::format("three layers in a chain, {:.2f} ms in all", 1e3 * tau_s_ * strength_);
  }
  void film(Waves& waves, const RecordContext&) override {
    if (strength_ == 0.0) return;
    const std::array<double, 3> share{split_, 0.65 * (1.0 - split_), 0.35 * (1.0 - split_)};
    std::array<Relaxation, 3> layers;
    for (std::size_t k = 0; k < 3; ++k)
      layers[k] = Relaxation(tau_s_ * strength_ * share[k], waves.step_s, waves.film_N.front());
    for (double& film_N : waves.film_N)
      for (Relaxation& layer : layers) film_N = layer.next(film_N);
  }

 private:
  double tau_s_, split_;
};

const HiddenRegistration kRegistered{{.name = "lag",
                                      .side = "sensor",
                                      .needs_fast_reference = true,
                                      .needs_kinds = {"prbs", "steps", "sweep"},
                                      .strength_max = 10.0,
                                      .make = [](Rng& rng) -> std::unique_ptr<HiddenEffect> {
                                        if (rng.uniform() < 0.5) return std::make_unique<SlabLag>(rng);
                                        return std::make_unique<LayeredLag>(rng);
                                      }}};

}  // namespace
}  // namespace forcegate::hidden
