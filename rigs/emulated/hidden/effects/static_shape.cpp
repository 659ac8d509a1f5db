// Shape of the static law: conductance power law or saturating contact area (static_nonlinearity), and
// contacts that close at distributed forces (dead_zone).

#include <fmt/format.h>

#include <vector>

#include "rigs/emulated/hidden/effect.h"
#include "rigs/emulated/hidden/numeric.h"

namespace forcegate::hidden {
namespace {

/// A static curve tabulated once per strength.
class CurveEffect : public HiddenEffect {
 public:
  void begin_campaign() override {
    table_.resize(1 + static_cast<std::size_t>(kTop_N / kCell_N));
    fill(table_);
  }
  void film(Waves& waves, const RecordContext&) override {
    if (strength_ == 0.0) return;
    for (double& film_N : waves.film_N)
      if (film_N > 0.0) film_N = interpolate(table_, film_N / kCell_N);
  }

 protected:
  static constexpr double kTop_N = 8.0, kCell_N = 0.004;
  virtual void fill(std::vector<double>& table) const = 0;

 private:
  std::vector<double> table_;
};

class PowerLaw final : public CurveEffect {
 public:
  explicit PowerLaw(Rng& rng) : bend_(rng.uniform() < 0.7 ? -0.06 : 0.06) {}
  std::string form() const override { return fmt::format("conductance ~ F^{:.4f}", 1.0 + bend_ * strength_); }

 private:
  void fill(std::vector<double>& table) const override {
    for (std::size_t i = 1; i < table.size(); ++i) {
      const double F = kCell_N * static_cast<double>(i);
      table[i] = F * portable::pow(F / 4.0, bend_ * strength_);
    }
  }
  double bend_;
};

class AreaSaturation final : public CurveEffect {
 public:
  explicit AreaSaturation(Rng& rng) : onset_N_(rng.uniform(1.0, 4.0)), steep_(rng.uniform(1.6, 3.5)) {}
  std::string form() const override {
    return fmt::format("contact area saturates: F / (1 + {:.4f} (F / {:.2f} N)^{:.2f})", kSize * strength_,
                       onset_N_, steep_);
  }

 private:
  static constexpr double kSize = 0.03;
  void fill(std::vector<double>& table) const override {
    for (std::size_t i = 1; i < table.size(); ++i) {
      const double F = kCell_N * static_cast<double>(i);
      table[i] = F / (1.0 + kSize * strength_ * portable::pow(F / onset_N_, steep_));
    }
  }
  double onset_N_, steep_;
};

class DistributedThreshold final : public CurveEffect {
 public:
  explicit DistributedThreshold(Rng& rng) : force_N_(rng.uniform(0.08, 0.2)), order_(rng.uniform(2.0, 5.0)) {}
  std::string form() const override {
    return fmt::format("share of closed contacts 1 / (1 + ({:.3f} N / F)^{:.2f})", force_N_ * strength_,
                       order_);
  }

 private:
  void fill(std::vector<double>& table) const override {
    const double middle = force_N_ * strength_;
    double closed = 0.0;
    table[0] = 0.0;
    for (std::size_t i = 1; i < table.size(); ++i) {
      const double F = kCell_N * (static_cast<double>(i) - 0.5);
      const double share = middle > 0.0 ? 1.0 / (1.0 + portable::pow(middle / F, order_)) : 1.0;
      closed += kCell_N * share;
      table[i] = closed;
    }
  }
  double force_N_, order_;
};

const HiddenRegistration kNonlinearity{{.name = "static_nonlinearity",
                                        .side = "sensor",
                                        .needs_kinds = {"ramp", "ramp"},
                                        .strength_max = 10.0,
                                        .make = [](Rng& rng) -> std::unique_ptr<HiddenEffect> {
                                          if (rng.uniform() < 0.5) return std::make_unique<PowerLaw>(rng);
                                          return std::make_unique<AreaSaturation>(rng);
                                        }}};

const HiddenRegistration kDeadZone{
    {.name = "dead_zone",
     .side = "sensor",
     .needs_kinds = {"ramp", "ramp"},
     .strength_max = 8.0,
     .make = [](Rng& rng) { return std::make_unique<DistributedThreshold>(rng); }}};

}  // namespace
}  // namespace forcegate::hidden
