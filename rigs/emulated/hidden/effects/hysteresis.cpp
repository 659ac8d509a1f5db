// Rate-independent loop of the film. Two forms: a Preisach plane with a distributed density, integrated to an
// Everett table (Mayergoyz 1991), and a Duhem operator whose branches have unequal curvature.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "rigs/emulated/hidden/effect.h"
#include "rigs/emulated/hidden/numeric.h"
#include "rigs/emulated/preisach_plane.h"

namespace forcegate::hidden {
namespace {

using emulated::Everett;
using emulated::PreisachPlane;

class PreisachFilm final : public HiddenEffect {
 public:
  explicit PreisachFilm(Rng& rng)
      : width_N_(rng.uniform(0.08, 0.5)),
        shape_(rng.uniform(0.0, 1.0)),
        everett_(width_N_, shape_, rng.uniform(1.0, 4.0)) {}

  std::string form() const override {
    return fmt::format(
        "Preisach plane, density ~ w^{:.2f} exp(-w / {:.3f} N) over the half-width w, weight {:.3f}", shape_,
        width_N_, kWeight * strength_);
  }

  void film(Waves& waves, const RecordContext&) override {
    if (strength_ == 0.0) return;
    PreisachPlane plane(everett_);
    for (double& film_N : waves.film_N) film_N += kWeight * strength_ * plane.next(film_N);
  }

 private:
  static constexpr double kWeight = 0.4;
  double width_N_, shape_;
  Everett everett_;
};

class DuhemFilm final : public HiddenEffect {
 public:
  explicit DuhemFilm(Rng& rng)
      : reach_N_(rng.uniform(0.15, 0.8)), up_(rng.uniform(0.8, 1.4)), down_(rng.uniform(1.4, 2.4)) {}

  std::string form() const override {
    return fmt::format("Duhem operator, reach {:.2f} N, exponents {:.2f} up and {:.2f} down, size {:.3f} N",
                       reach_N_, up_, down_, kSize_N * strength_);
  }

  void film(Waves& waves, const RecordContext& context) override {
    if (strength_ == 0.0) return;
    double z = 0.0, before = waves.film_N.front();
    for (double& film_N : waves.film_N) {
      const double dF = film_N - before;
      before = film_N;
      if (dF > 0.0)
        z += dF / reach_N_ * portable::pow(std::max(1e-9, 1.0 - z), up_);
      else if (dF < 0.0)
        z += dF / reach_N_ * portable::pow(std::max(1e-9, 1.0 + z), down_);
      z = std::clamp(z, -1.0, 1.0);
      film_N -= kSize_N * strength_ * z * std::sqrt(std::max(0.0, film_N) / context.force_range_N);
    }
  }

 private:
  static constexpr double kSize_N = 0.06;
  double reach_N_, up_, down_;
};

const HiddenRegistration kRegistered{{.name = "hysteresis",
                                      .side = "sensor",
                                      .needs_kinds = {"ramp", "ramp", "staircase"},
                                      .strength_max = 20.0,
                                      .make = [](Rng& rng) -> std::unique_ptr<HiddenEffect> {
                                        if (rng.uniform() < 0.65) return std::make_unique<PreisachFilm>(rng);
                                        return std::make_unique<DuhemFilm>(rng);
                                      }}};

}  // namespace
}  // namespace forcegate::hidden
