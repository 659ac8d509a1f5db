// Voltage channel: amplifier rail, mains, clocks, and converter.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "rigs/emulated/hidden/effect.h"
#include "rigs/emulated/hidden/numeric.h"

namespace forcegate::hidden {
namespace {

/// Soft corner of the output stage; charge of the overload leaves with a tail.
class SoftRail final : public HiddenEffect {
 public:
  explicit SoftRail(Rng& rng)
      : corner_V_(rng.uniform(0.03, 0.15)), tail_s_(rng.uniform(0.02, 0.2)), tail_(rng.uniform(0.05, 0.3)) {}
  std::string form() const override {
    return fmt::format("rail at {:.2f} V, corner {:.2f} V, overload tail {:.0f} ms", rail_V(), corner_V_,
                       1e3 * tail_s_);
  }
  void electronics(Waves& waves, const RecordContext&) override {
    if (strength_ == 0.0) return;
    const double rail = rail_V(), leave = waves.step_s / tail_s_;
    double charge_V = 0.0;
    for (double& voltage_V : waves.voltage_V) {
      const double excess_V = corner_V_ * softplus((voltage_V - rail) / corner_V_);
      charge_V += leave * (excess_V - charge_V);
      voltage_V -= excess_V;
      voltage_V += tail_ * std::max(0.0, charge_V - excess_V);
    }
  }

 private:
  double rail_V() const { return 10.2 - 1.6 * strength_; }
  double corner_V_, tail_s_, tail_;
};

/// Mains at 50 Hz with its third harmonic, larger while the sensor's resistance is high; the grid's frequency
/// wanders.
class MainsHum final : public HiddenEffect {
 public:
  explicit MainsHum(Rng& rng)
      : mains_Hz_(50.0 + 0.02 * rng.normal()),
        third_(rng.uniform(0.05, 0.4)),
        high_(rng.uniform(0.2, 1.5)),
        phase_rad_(rng.uniform(0.0, 2.0 * kPi)) {}
  std::string form() const override {
    return fmt::format("{:.3f} Hz of {:.1f} mV, third harmonic {:.2f}, {:.2f} times more at no load",
                       mains_Hz_, 1e3 * kSize_V * strength_, third_, high_);
  }
  void samples(Samples& samples, const RecordContext& context) override {
    if (strength_ == 0.0) return;
    const double start_s = context.plan.start_s;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const double t = start_s + samples.instant_s[i];
      const double turns = mains_Hz_ * t + 0.2 * portable::sin(2.0 * kPi * t / 97.0);
      const double phase = 2.0 * kPi * (turns - std::floor(turns)) + phase_rad_;
      const double resistance = 1.0 / (1.0 + 2.0 * std::max(0.0, samples.reference_N[i]));
      samples.voltage_V[i] += kSize_V * strength_ * (1.0 + high_ * resistance) *
                              (portable::sin(phase) + third_ * portable::sin(3.0 * phase + 1.0));
    }
  }

 private:
  static constexpr double kSize_V = 0.05;
  double mains_Hz_, third_, high_, phase_rad_;
};

/// The voltage channel is read late, or early, by a constant.
class ChannelDelay final : public HiddenEffect {
 public:
  explicit ChannelDelay(Rng& rng) : delay_s_(rng.uniform(0.006, 0.02) * (rng.uniform() < 0.9 ? 1.0 : -1.0)) {}
  std::string form() const override {
    return fmt::format("voltage is {:+.3f} ms late", 1e3 * delay_s_ * strength_);
  }
  double voltage_instant_s(double t_s, const RecordContext&) override { return t_s - delay_s_ * strength_; }

 private:
  double delay_s_;
};

/// Two clocks: a rate error, and a block lost now and then.
class ClockSkew final : public HiddenEffect {
 public:
  explicit ClockSkew(Rng& rng)
      : skew_(rng.uniform(3e-5, 9e-5) * (rng.uniform() < 0.5 ? 1.0 : -1.0)),
        block_s_(rng.uniform(0.0, 0.02)),
        seed_(rng.next()) {}
  std::string form() const override {
    return fmt::format("voltage clock runs {:+.1f} ppm off and loses blocks of {:.1f} ms",
                       1e6 * skew_ * strength_, 1e3 * block_s_ * strength_);
  }
  void begin_record(const RecordContext& context) override {
    Rng rng(seed_ ^ context.plan.seed, "blocks");
    lost_at_s_[0] = context.plan.duration_s * rng.uniform(0.2, 0.9);
    lost_at_s_[1] = context.plan.duration_s * rng.uniform(0.5, 1.6);
  }
  double voltage_instant_s(double t_s, const RecordContext&) override {
    double late_s = skew_ * t_s;
    for (const double at_s : lost_at_s_)
      if (t_s >= at_s) late_s += skew_ > 0 ? block_s_ : -block_s_;
    return t_s - strength_ * late_s;
  }

 private:
  double skew_, block_s_;
  std::uint64_t seed_;
  std::array<double, 2> lost_at_s_{1e9, 1e9};
};

/// Weights of the three leading bits are off, so that codes jump at the half, the quarters and the eighths.
class BitWeights final : public HiddenEffect {
 public:
  explicit BitWeights(Rng& rng) {
    for (std::size_t k = 0; k < error_V_.size(); ++k)
      error_V_[k] = (k == 0 ? 1.0 : 0.6) * rng.uniform(0.4, 1.2) * (rng.uniform() < 0.5 ? 1.0 : -1.0);
  }
  std::string form() const override {
    return fmt::format("leading bits weigh {:+.1f}, {:+.1f} and {:+.1f} mV too much",
                       1e3 * kSize_V * strength_ * error_V_[0], 1e3 * kSize_V * strength_ * error_V_[1],
                       1e3 * kSize_V * strength_ * error_V_[2]);
  }
  void codes(std::vector<int>& codes, int adc_bits, const RecordContext& context) override {
    if (strength_ == 0.0) return;
    const int top = (1 << adc_bits) - 1;
    std::array<int, 8> shift{};
    for (std::size_t eighth = 0; eighth < shift.size(); ++eighth) {
      double error_V = 0.0;
      for (std::size_t k = 0; k < error_V_.size(); ++k)
        if (eighth >> (2 - k) & 1u) error_V += kSize_V * strength_ * error_V_[k];
      shift[eighth] = static_cast<int>(std::round(error_V / context.voltage_range_V * top));
    }
    for (int& code : codes)
      code = std::clamp(code + shift[static_cast<std::size_t>(code >> (adc_bits - 3))], 0, top);
  }

 private:
  static constexpr double kSize_V = 0.08;
  std::array<double, 3> error_V_{};
};

/// One bit of the converter sticks in a share of the conversions.
class StickyBit final : public HiddenEffect {
 public:
  explicit StickyBit(Rng& rng)
      : from_top_(3 + static_cast<int>(rng.below(2))), high_(rng.uniform() < 0.5), seed_(rng.next()) {}
  std::string form() const override {
    return fmt::format("bit {} below the top reads {} in {:.2f} % of the conversions", from_top_,
                       high_ ? 1 : 0, 100 * share());
  }
  void codes(std::vector<int>& codes, int adc_bits, const RecordContext& context) override {
    if (strength_ == 0.0) return;
    Rng rng(seed_ ^ context.plan.seed, "bit");
    const int bit = 1 << (adc_bits - from_top_ - 1);
    for (int& code : codes)
      if (rng.uniform() < share()) code = high_ ? (code | bit) : (code & ~bit);
  }

 private:
  double share() const { return std::min(1.0, 0.01 * strength_ * strength_); }
  int from_top_;
  bool high_;
  std::uint64_t seed_;
};

const HiddenRegistration kClipping{{.name = "clipping",
                                    .side = "instrument",
                                    .needs_kinds = {"ramp", "ramp", "steps"},
                                    .strength_max = 4.5,
                                    .make = [](Rng& rng) { return std::make_unique<SoftRail>(rng); }}};

const HiddenRegistration kHum{
    {.name = "hum", .side = "instrument", .strength_max = 20.0, .make = [](Rng& rng) {
       return std::make_unique<MainsHum>(rng);
     }}};

const HiddenRegistration kDelay{{.name = "delay",
                                 .side = "instrument",
                                 .needs_fast_reference = true,
                                 .needs_kinds = {"prbs", "steps", "sweep"},
                                 .strength_max = 20.0,
                                 .make = [](Rng& rng) { return std::make_unique<ChannelDelay>(rng); }}};

const HiddenRegistration kSkew{{.name = "clock_skew",
                                .side = "instrument",
                                .needs_fast_reference = true,
                                .needs_kinds = {"sine", "sine", "sine", "sweep"},
                                .strength_max = 20.0,
                                .make = [](Rng& rng) { return std::make_unique<ClockSkew>(rng); }}};

const HiddenRegistration kCodes{{.name = "adc_codes",
                                 .side = "instrument",
                                 .needs_kinds = {"ramp", "ramp"},
                                 .strength_max = 12.0,
                                 .make = [](Rng& rng) -> std::unique_ptr<HiddenEffect> {
                                   if (rng.uniform() < 0.6) return std::make_unique<BitWeights>(rng);
                                   return std::make_unique<StickyBit>(rng);
                                 }}};

}  // namespace
}  // namespace forcegate::hidden
