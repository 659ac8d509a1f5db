// Rate-independent loop of the film. Two forms: a Preisach plane with a distributed density, integrated to an Everett
// table (Mayergoyz 1991), and a Duhem operator whose branches have unequal curvature.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "rigs/emulated/hidden/effect.h"
#include "rigs/emulated/hidden/numeric.h"

namespace forcegate::hidden {
namespace {

constexpr double kTop_N = 6.0;
constexpr std::size_t kGrid = 121;
constexpr double kCell_N = kTop_N / (kGrid - 1);

/// E(alpha, beta): integral of the density over the triangle beta <= b <= a <= alpha, bilinear between nodes.
class Everett {
 public:
  Everett(double width_N, double shape, double crest_N) : table_(kGrid * kGrid, 0.0) {
    const auto density = [&](double a, double b) {
      const double width = (a - b) / 2.0 / width_N, middle = ((a + b) / 2.0 - crest_N) / 3.0;
      return portable::pow(width + 0.02, shape) * portable::exp(-width) * portable::exp(-middle * middle);
    };
    for (std::size_t i = 1; i < kGrid; ++i)
      for (std::size_t j = i; j-- > 0;) {
        const double a = kCell_N * (static_cast<double>(i) - 0.5), b = kCell_N * (static_cast<double>(j) + 0.5);
        const double cell = a > b ? density(a, b) : 0.5 * density(a + 0.2 * kCell_N, b);
        const double above = j + 1 < i ? at(i - 1, j) + at(i, j + 1) - at(i - 1, j + 1) : 0.0;
        table_[i * kGrid + j] = above + cell;
      }
    const double whole = at(kGrid - 1, 0);
    for (double& v : table_) v *= kTop_N / whole;
  }

  double operator()(double alpha, double beta) const {
    const double x = std::clamp(alpha / kCell_N, 0.0, kGrid - 1.001), y = std::clamp(beta / kCell_N, 0.0, kGrid - 1.001);
    const auto i = static_cast<std::size_t>(x), j = static_cast<std::size_t>(y);
    const double u = x - static_cast<double>(i), v = y - static_cast<double>(j);
    return (1 - u) * ((1 - v) * at(i, j) + v * at(i, j + 1)) + u * ((1 - v) * at(i + 1, j) + v * at(i + 1, j + 1));
  }

 private:
  double at(std::size_t i, std::size_t j) const { return table_[i * kGrid + j]; }
  std::vector<double> table_;
};

class PreisachFilm final : public HiddenEffect {
 public:
  explicit PreisachFilm(Rng& rng)
      : width_N_(rng.uniform(0.08, 0.5)), shape_(rng.uniform(0.0, 1.0)), everett_(width_N_, shape_, rng.uniform(1.0, 4.0)) {}

  std::string form() const override {
    return fmt::format("Preisach plane, density ~ w^{:.2f} exp(-w / {:.3f} N) over the half-width w, weight {:.3f}",
                       shape_, width_N_, kWeight * strength_);
  }

  void film(Waves& waves, const RecordContext&) override {
    if (strength_ == 0.0) return;
    std::vector<Turn> turns{{0.0, 0.0}};
    double before = 0.0, value = 0.0;
    bool rising = true;
    for (double& film_N : waves.film_N) {
      const double u = std::clamp(film_N, 0.0, kTop_N);
      if (u != before) {
        if ((u > before) != rising) {
          rising = !rising;
          turns.push_back({before, value});
        }
        while (turns.size() >= 3 && (rising ? u >= turns[turns.size() - 2].u : u <= turns[turns.size() - 2].u))
          turns.resize(turns.size() - 2);
        const Turn& last = turns.back();
        value = rising ? last.value + everett_(u, last.u) : last.value - everett_(last.u, u);
        before = u;
      }
      const double down = everett_(kTop_N, 0.0) - everett_(kTop_N, u);
      film_N += kWeight * strength_ * (value - 0.5 * (everett_(u, 0.0) + down));
    }
  }

 private:
  struct Turn {
    double u, value;
  };
  static constexpr double kWeight = 0.4;
  double width_N_, shape_;
  Everett everett_;
};

class DuhemFilm final : public HiddenEffect {
 public:
  explicit DuhemFilm(Rng& rng)
      : reach_N_(rng.uniform(0.15, 0.8)), up_(rng.uniform(0.8, 1.4)), down_(rng.uniform(1.4, 2.4)) {}

  std::string form() const override {
    return fmt::format("Duhem operator, reach {:.2f} N, exponents {:.2f} up and {:.2f} down, size {:.3f} N", reach_N_, up_,
                       down_, kSize_N * strength_);
  }

  void film(Waves& waves, const RecordContext& context) override {
    if (strength_ == 0.0) return;
    double z = 0.0, before = waves.film_N.front();
    for (double& film_N : waves.film_N) {
      const double dF = film_N - before;
      before = film_N;
      if (dF > 0.0) z += dF / reach_N_ * portable::pow(std::max(1e-9, 1.0 - z), up_);
      else if (dF < 0.0) z += dF / reach_N_ * portable::pow(std::max(1e-9, 1.0 + z), down_);
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
