// The bench itself: coils that close, play with a compliant flank, the wheel's transverse push, loss of
// contact with a bounce, and a drive that does not turn evenly.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "rigs/emulated/hidden/effect.h"
#include "rigs/emulated/hidden/numeric.h"

namespace forcegate::hidden {
namespace {

/// Coils seat one after another: each adds stiffness smoothly beyond its own travel.
class ClosingCoils final : public HiddenEffect {
 public:
  explicit ClosingCoils(Rng& rng) : width_mm_(rng.uniform(0.4, 1.5)) {
    const double first_mm = rng.uniform(3.0, 8.0);
    for (std::size_t k = 0; k < kCoils; ++k)
      closes_mm_[k] = first_mm + rng.uniform(1.0, 3.0) * static_cast<double>(k + 1);
    for (std::size_t i = 0; i < extra_mm_.size(); ++i)
      for (const double at_mm : closes_mm_)
        extra_mm_[i] += width_mm_ * softplus((kCell_mm * static_cast<double>(i) - at_mm) / width_mm_);
  }
  std::string form() const override {
    return fmt::format("five coils close between {:.1f} and {:.1f} mm, each stiffens by {:.2f} %",
                       closes_mm_.front(), closes_mm_.back(), 100 * kShare * strength_);
  }
  void force(Waves& waves, const RecordContext& context) override {
    if (strength_ == 0.0) return;
    const double k = context.truth.spring_N_per_mm;
    for (std::size_t i = 0; i < waves.size(); ++i)
      waves.force_N[i] += k * kShare * strength_ * interpolate(extra_mm_, waves.travel_mm[i] / kCell_mm);
  }

 private:
  static constexpr std::size_t kCoils = 5;
  static constexpr double kShare = 0.02, kCell_mm = 0.01;
  double width_mm_;
  std::array<double, kCoils> closes_mm_{};
  std::vector<double> extra_mm_ = std::vector<double>(3200, 0.0);  // of all coils, over the travel
};

/// Trolley behind the wheel with a flank that yields before it carries: dd/dx = 1 - |d / g|^n on the way out.
class CompliantPlay final : public HiddenEffect {
 public:
  explicit CompliantPlay(Rng& rng) : gap_mm_(rng.uniform(0.08, 0.2)), order_(rng.uniform(1.5, 5.0)) {}
  std::string form() const override {
    return fmt::format("play of {:.3f} mm with a flank of order {:.1f}", 2.0 * gap_mm_ * strength_, order_);
  }
  void travel(Waves& waves, const RecordContext&) override {
    if (strength_ == 0.0) return;
    const double gap_mm = gap_mm_ * strength_;
    double lost = 0.0, before = waves.travel_mm.front();
    for (double& travel_mm : waves.travel_mm) {
      const double dx = travel_mm - before;
      before = travel_mm;
      const double towards = dx >= 0.0 ? lost : -lost;  // in [-1, 1], share of the gap taken up
      const double grip = towards <= 0.0 ? 0.0 : portable::pow(towards, order_);
      lost = std::clamp(lost + dx / gap_mm * (1.0 - grip), -1.0, 1.0);
      travel_mm -= gap_mm * lost;
    }
  }

 private:
  double gap_mm_, order_;
};

/// Transverse share of the wheel's push by its pressure angle; the reference cell does not see it.
class TransversePush final : public HiddenEffect {
 public:
  explicit TransversePush(Rng& rng)
      : sign_(rng.uniform() < 0.5 ? 1.0 : -1.0), lever_(rng.uniform(0.02, 0.06)) {}
  std::string form() const override {
    return fmt::format("film feels {:+.3f} F tan(phi), tan(phi) = e sin(theta) / (R + e cos(theta))",
                       sign_ * lever_ * strength_);
  }
  void film(Waves& waves, const RecordContext& context) override {
    if (strength_ == 0.0) return;
    const double e = context.truth.eccentricity_mm, R = context.truth.wheel_radius_mm;
    for (std::size_t i = 0; i < waves.size(); ++i) {
      const double s = portable::sin(waves.theta_rad[i]), c = portable::cos(waves.theta_rad[i]);
      waves.film_N[i] += sign_ * lever_ * strength_ * 4.0 * waves.force_N[i] * e * s / (R + e * c);
    }
  }

 private:
  double sign_, lever_;
};

/// The trolley sits too far back: no force below a gap, and a damped bounce on landing.
class LostContact final : public HiddenEffect {
 public:
  explicit LostContact(Rng& rng)
      : gap_mm_(rng.uniform(0.8, 1.4)),
        bounce_Hz_(rng.uniform(9.0, 14.0)),
        damping_(rng.uniform(0.08, 0.25)) {}
  std::string form() const override {
    return fmt::format("gap of {:.2f} mm, bounce at {:.1f} Hz with damping {:.2f}", gap_mm_ * strength_,
                       bounce_Hz_, damping_);
  }
  void force(Waves& waves, const RecordContext& context) override {
    if (strength_ == 0.0) return;
    const double k = context.truth.spring_N_per_mm, gap_mm = gap_mm_ * strength_, h = waves.step_s;
    const double w = 2.0 * kPi * bounce_Hz_;
    waves.airborne.assign(waves.size(), 0);
    double x = 0.0, v = 0.0, before_N = 0.0;
    bool in_air = false;
    for (std::size_t i = 0; i < waves.size(); ++i) {
      const double push_N = waves.force_N[i] - k * gap_mm;
      const double rate = i > 0 ? (push_N - before_N) / h : 0.0;
      before_N = push_N;
      if (push_N <= 0.0) {
        in_air = true;
        x = v = 0.0;
        waves.force_N[i] = 0.0;
        waves.airborne[i] = 1;
        continue;
      }
      if (in_air) {  // landing: the momentum of the closing gap starts the oscillation
        in_air = false;
        v = 0.8 * rate;
      }
      v += h * (-w * w * x - 2.0 * damping_ * w * v);
      x += h * v;
      waves.force_N[i] = std::max(0.0, push_N + x);
      waves.airborne[i] = waves.force_N[i] == 0.0;
    }
  }

 private:
  double gap_mm_, bounce_Hz_, damping_;
};

/// Cogging of the motor and a speed that sags with the load it drives.
class UnevenDrive final : public HiddenEffect {
 public:
  explicit UnevenDrive(Rng& rng)
      : poles_(static_cast<double>(5 + 2 * rng.below(5))),
        cog_rad_(rng.uniform(0.01, 0.03)),
        sag_s_(rng.uniform(0.01, 0.03)),
        phase_rad_(rng.uniform(0.0, 2.0 * kPi)) {}
  std::string form() const override {
    return fmt::format(
        "cogging of {:.4f} rad at {:.0f} per turn, eccentric rotor, {:.1f} ms behind under load",
        cog_rad_ * strength_, poles_, 1e3 * sag_s_ * strength_);
  }
  void angle(Waves& waves, const RecordContext&) override {
    if (strength_ == 0.0) return;
    double before = waves.theta_rad.front();
    for (double& theta_rad : waves.theta_rad) {
      const double speed = (theta_rad - before) / waves.step_s;
      before = theta_rad;
      const double load = 0.5 * (1.0 - portable::cos(theta_rad));
      theta_rad += strength_ *
                   (cog_rad_ * (portable::sin(poles_ * theta_rad + phase_rad_) - portable::sin(phase_rad_)) +
                    1.5 * cog_rad_ * (portable::sin(theta_rad + phase_rad_) - portable::sin(phase_rad_)) -
                    sag_s_ * speed * load);
    }
  }

 private:
  double poles_, cog_rad_, sag_s_, phase_rad_;
};

const HiddenRegistration kSpring{{.name = "spring_nonlinearity",
                                  .side = "rig",
                                  .measure = Measure::force,
                                  .needs_theta = true,
                                  .needs_kinds = {"ramp", "ramp"},
                                  .strength_max = 20.0,
                                  .make = [](Rng& rng) { return std::make_unique<ClosingCoils>(rng); }}};

const HiddenRegistration kBacklash{{.name = "backlash",
                                    .side = "rig",
                                    .measure = Measure::force,
                                    .needs_theta = true,
                                    .needs_kinds = {"ramp", "ramp", "staircase"},
                                    .strength_max = 10.0,
                                    .make = [](Rng& rng) { return std::make_unique<CompliantPlay>(rng); }}};

const HiddenRegistration kOffAxis{{.name = "off_axis",
                                   .side = "rig",
                                   .needs_theta = true,
                                   .needs_kinds = {"ramp", "sine", "sine", "sine"},
                                   .strength_max = 10.0,
                                   .make = [](Rng& rng) { return std::make_unique<TransversePush>(rng); }}};

const HiddenRegistration kContact{{.name = "contact_loss",
                                   .side = "rig",
                                   .measure = Measure::force,
                                   .needs_theta = true,
                                   .needs_kinds = {"ramp", "sine", "sine", "sine"},
                                   .strength_max = 12.0,
                                   .make = [](Rng& rng) { return std::make_unique<LostContact>(rng); }}};

const HiddenRegistration kMotor{{.name = "motor",
                                 .side = "rig",
                                 .measure = Measure::force,
                                 .needs_theta = true,
                                 .needs_command = true,
                                 .needs_kinds = {"sine", "sine", "sweep"},
                                 .strength_max = 10.0,
                                 .make = [](Rng& rng) { return std::make_unique<UnevenDrive>(rng); }}};

}  // namespace
}  // namespace forcegate::hidden
