// Single wild samples, and runs of samples that never arrived.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "rigs/emulated/hidden/effect.h"
#include "rigs/emulated/hidden/numeric.h"

namespace forcegate::hidden {
namespace {

class WildSamples final : public HiddenEffect {
 public:
  explicit WildSamples(Rng& rng)
      : share_(2e-4 * portable::pow(10.0, rng.uniform())),
        one_sided_(rng.uniform() < 0.4),
        seed_(rng.next()) {}
  std::string form() const override {
    return fmt::format("{:.3f} % of the samples are off by up to {:.2f} V{}", 100 * share_,
                       kSize_V * strength_, one_sided_ ? ", upwards" : "");
  }
  void samples(Samples& samples, const RecordContext& context) override {
    if (strength_ == 0.0) return;
    Rng rng(seed_ ^ context.plan.seed, "wild");
    for (double& voltage_V : samples.voltage_V) {
      if (rng.uniform() >= share_) continue;
      const double size = kSize_V * strength_ * (0.3 + 0.7 * rng.uniform());
      voltage_V += one_sided_ || rng.uniform() < 0.5 ? size : -size;
    }
  }

 private:
  static constexpr double kSize_V = 1.5;
  double share_;
  bool one_sided_;
  std::uint64_t seed_;
};

/// Runs of lost samples: the recorder repeats the last one, writes zeros, or leaves cells empty.
class LostRuns final : public HiddenEffect {
 public:
  explicit LostRuns(Rng& rng)
      : stale_(rng.uniform() < 0.6),
        length_s_(rng.uniform(0.03, 0.2)),
        empty_(rng.uniform(0.0, 0.3)),
        seed_(rng.next()) {}
  std::string form() const override {
    return fmt::format("{} for about {:.0f} ms, {:.2f} times a minute; a share of {:.2f} left empty",
                       stale_ ? "last value repeated" : "zero written", 1e3 * length_s_, 60.0 * rate_Hz(),
                       empty_);
  }
  void logged(Samples& samples, const RecordContext& context) override {
    if (strength_ == 0.0) return;
    // instants are drawn in time, so that a coarse preview loses the same runs
    Rng rng(seed_ ^ context.plan.seed, "lost");
    const auto gap_s = [&] { return -portable::log(1.0 - rng.uniform()) / rate_Hz(); };
    double next_s = gap_s(), until_s = -1.0, held_V = 0.0;
    bool blank = false;
    for (std::size_t i = 1; i < samples.size(); ++i) {
      const double t = samples.stamp_s[i];
      if (t >= until_s && t >= next_s) {
        until_s = t + length_s_ * (0.4 + 1.2 * rng.uniform());
        next_s = until_s + gap_s();
        held_V = samples.voltage_V[i - 1];
        blank = rng.uniform() < empty_;
      }
      if (t < until_s) samples.voltage_V[i] = blank ? std::numeric_limits<double>::quiet_NaN() : stale_ ? held_V : 0.0;
    }
  }

 private:
  double rate_Hz() const { return 0.01 * strength_ * strength_; }
  bool stale_;
  double length_s_, empty_;
  std::uint64_t seed_;
};

const HiddenRegistration kOutliers{
    {.name = "outliers", .side = "instrument", .reducible = false, .strength_max = 5.0, .make = [](Rng& rng) {
       return std::make_unique<WildSamples>(rng);
     }}};

const HiddenRegistration kDropouts{{.name = "dropouts",
                                    .side = "instrument",
                                    .reducible = false,
                                    .needs_kinds = {"sine", "sine", "prbs"},
                                    .strength_max = 12.0,
                                    .make = [](Rng& rng) { return std::make_unique<LostRuns>(rng); }}};

}  // namespace
}  // namespace forcegate::hidden
