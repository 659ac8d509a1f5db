// Sensor and circuit as electric parts: R(F) with parasitic capacitance, current of a changing capacitance,
// dependence on the drive voltage, and the gain that each mounting gives anew.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "rigs/emulated/hidden/effect.h"
#include "rigs/emulated/hidden/numeric.h"

namespace forcegate::hidden {
namespace {

/// Two cells of a cable, each with a time constant R(F) C that falls with the load.
class LoadedCable final : public HiddenEffect {
 public:
  explicit LoadedCable(Rng& rng)
      : tau_s_(rng.uniform(0.02, 0.05)), knee_N_(rng.uniform(0.1, 0.4)), second_(rng.uniform(0.1, 0.35)) {}
  std::string form() const override {
    return fmt::format("R(F) C of {:.2f} ms at no load, half of it at {:.2f} N, in two cells",
                       1e3 * tau_s_ * strength_, knee_N_);
  }
  void electronics(Waves& waves, const RecordContext&) override {
    if (strength_ == 0.0) return;
    double first = waves.voltage_V.front(), second = first;
    for (std::size_t i = 0; i < waves.size(); ++i) {
      const double tau_s = tau_s_ * strength_ * knee_N_ / (knee_N_ + std::max(0.0, waves.film_N[i]));
      // implicit Euler on both cells: stable for any tau, and not a discretisation that a fit would use
      first += waves.step_s / (waves.step_s + (1.0 - second_) * tau_s) * (waves.voltage_V[i] - first);
      second += waves.step_s / (waves.step_s + second_ * tau_s) * (first - second);
      waves.voltage_V[i] = second;
    }
  }

 private:
  double tau_s_, knee_N_, second_;
};

/// Displacement current V dC/dt through the feedback resistor, C = C0 + C1 F^p.
class DisplacementCurrent final : public HiddenEffect {
 public:
  explicit DisplacementCurrent(Rng& rng) : power_(rng.uniform(0.45, 0.75)) {}
  std::string form() const override {
    return fmt::format("current of C ~ F^{:.2f}: {:.2f} mV s times its rate", power_,
                       1e3 * kSize_Vs * strength_);
  }
  void electronics(Waves& waves, const RecordContext&) override {
    if (strength_ == 0.0) return;
    const double follow = 1.0 - portable::exp(-waves.step_s / 0.003);
    double smooth = portable::pow(std::max(0.0, waves.film_N.front()) + 0.02, power_);
    for (std::size_t i = 0; i < waves.size(); ++i) {
      const double step = follow * (portable::pow(std::max(0.0, waves.film_N[i]) + 0.02, power_) - smooth);
      smooth += step;
      waves.voltage_V[i] += kSize_Vs * strength_ * step / waves.step_s;
    }
  }

 private:
  static constexpr double kSize_Vs = 0.03;
  double power_;
};

/// Tunnelling: conductance ~ tanh(V / V0), and less loss of the maxima at low drive.
class DriveDependence final : public HiddenEffect {
 public:
  explicit DriveDependence(Rng& rng) : knee_V_(rng.uniform(0.8, 2.2)), hold_(rng.uniform(0.2, 0.7)) {}
  std::string form() const override {
    return fmt::format(
        "output varies by {:.2f} % as tanh(V / {:.2f} V), loss of the maxima smaller at low drive",
        100 * kSize * strength_, knee_V_);
  }
  void voltage(Waves& waves, const RecordContext& context) override {
    if (strength_ == 0.0) return;
    const double bend =
        hyperbolic_tangent(context.plan.drive_V / knee_V_) - hyperbolic_tangent(5.0 / knee_V_);
    const double gain = 1.0 + kSize * strength_ * bend;
    const double hold = std::clamp(-hold_ * kSize * strength_ * bend * 4.0, 0.0, 0.6);
    const double G = context.truth.gain_N_per_V, F0 = context.truth.offset_N;
    for (std::size_t i = 0; i < waves.size(); ++i) {
      const double static_V = (waves.film_N[i] - F0) / G;
      waves.voltage_V[i] = gain * (waves.voltage_V[i] + hold * (static_V - waves.voltage_V[i]));
    }
  }

 private:
  static constexpr double kSize = 0.1;
  double knee_V_, hold_;
};

/// Hardness and curvature of the surface at each mounting: gain, zero and a little bend.
class Remounted final : public HiddenEffect {
 public:
  explicit Remounted(Rng& rng) {
    for (Seat& seat : seats_) seat = {rng.normal(), rng.normal(), rng.normal()};
  }
  std::string form() const override {
    return fmt::format("each mounting draws its gain with {:.2f} % and its zero with {:.1f} mN",
                       100 * kGain * strength_, 1e3 * kZero_N * strength_);
  }
  void film(Waves& waves, const RecordContext& context) override {
    if (strength_ == 0.0) return;
    const Seat& seat = seats_[static_cast<std::size_t>(context.plan.mounting) % kSeats];
    const Seat& first = seats_[0];
    const double gain =
        kGain * strength_ * (seat.gain - first.gain - (context.plan.mounting > 0 ? kTurn : 0.0));
    const double zero_N = kZero_N * strength_ * (seat.zero - first.zero), bend = 0.2 * gain * seat.bend;
    for (double& film_N : waves.film_N) {
      const double x = std::clamp(film_N / context.force_range_N, 0.0, 1.5);
      film_N += gain * film_N + zero_N * x * x + bend * film_N * (x - 0.5);
    }
  }

 private:
  struct Seat {
    double gain = 0.0, zero = 0.0, bend = 0.0;
  };
  static constexpr std::size_t kSeats = 16;
  static constexpr double kGain = 0.03, kZero_N = 0.03, kTurn = 0.8;
  Seat seats_[kSeats];
};

const HiddenRegistration kRc{{.name = "rc",
                              .side = "sensor",
                              .also_side = {"instrument"},
                              .needs_fast_reference = true,
                              .needs_kinds = {"prbs", "steps", "steps"},
                              .strength_max = 20.0,
                              .make = [](Rng& rng) { return std::make_unique<LoadedCable>(rng); }}};

const HiddenRegistration kPiezo{
    {.name = "piezocapacitance",
     .side = "sensor",
     .needs_fast_reference = true,
     .needs_kinds = {"prbs", "steps", "sweep"},
     .strength_max = 50.0,
     .make = [](Rng& rng) { return std::make_unique<DisplacementCurrent>(rng); }}};

const HiddenRegistration kBias{{.name = "bias",
                                .side = "sensor",
                                .rival = Rival::repeatability,
                                .needs_drive = true,
                                .needs_kinds = {"ramp", "ramp", "ramp"},
                                .cause = Cause::drive,
                                .strength_max = 15.0,
                                .make = [](Rng& rng) { return std::make_unique<DriveDependence>(rng); }}};

const HiddenRegistration kMounting{{.name = "mounting",
                                    .side = "sensor",
                                    .also_side = {"rig"},
                                    .rival = Rival::repeatability,
                                    .needs_remounting = true,
                                    .needs_kinds = {"ramp", "ramp", "staircase"},
                                    .cause = Cause::mounting,
                                    .strength_max = 15.0,
                                    .make = [](Rng& rng) { return std::make_unique<Remounted>(rng); }}};

}  // namespace
}  // namespace forcegate::hidden
