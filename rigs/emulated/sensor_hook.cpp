#include "rigs/emulated/sensor_hook.h"

#include <algorithm>
#include <array>
#include <charconv>

#include "hil/base/portable_math.h"
#include "hil/base/text.h"
#include "hil/interface/sealed_setting.h"
#include "rigs/emulated/hidden/seal.h"
#include "rigs/emulated/preisach_plane.h"

namespace forcegate::emulated {
namespace {

constexpr const char *kNothing = "none", *kNonce = "sensor hook";

/// Adds a share of the loop of a Preisach plane.
class LoopHook final : public SensorHook {
 public:
  explicit LoopHook(double share) : share_(share), everett_(0.22, 0.5, 2.2), plane_(everett_) {}

  void begin(double, double force_N) override {
    plane_ = PreisachPlane(everett_);
    plane_.next(force_N);
  }
  void feel(std::size_t n, const double* force_N, double* film_N) override {
    for (std::size_t i = 0; i < n; ++i) film_N[i] = force_N[i] + share_ * plane_.next(force_N[i]);
  }
  void tick(double) override {}

 private:
  double share_;
  Everett everett_;
  PreisachPlane plane_;
};

/// Adds a share of the load that grows as t^0.12 between half a second and an hour: a spectrum of relaxation
/// times.
class CreepHook final : public SensorHook {
 public:
  explicit CreepHook(double share) : share_(share) {
    double total = 0.0;
    for (std::size_t k = 0; k < kModes; ++k) {
      tau_s_[k] = 0.5 * portable::pow(8000.0, static_cast<double>(k) / (kModes - 1));
      total += weight_[k] = portable::pow(tau_s_[k], 0.12);
    }
    for (double& w : weight_) w /= total;
  }

  void begin(double, double force_N) override {
    state_.fill(0.0);
    creep_N_ = 0.0;
    last_N_ = force_N;
  }
  void feel(std::size_t n, const double* force_N, double* film_N) override {
    for (std::size_t i = 0; i < n; ++i) film_N[i] = force_N[i] + share_ * creep_N_;
    last_N_ = force_N[n - 1];
  }
  void tick(double dt_s) override {
    creep_N_ = 0.0;
    for (std::size_t k = 0; k < kModes; ++k) {
      state_[k] += dt_s / (tau_s_[k] + 0.5 * dt_s) * (last_N_ - state_[k]);
      creep_N_ += weight_[k] * state_[k];
    }
  }

 private:
  static constexpr std::size_t kModes = 18;
  double share_, creep_N_ = 0.0, last_N_ = 0.0;
  std::array<double, kModes> tau_s_{}, weight_{}, state_{};
};

const Registration<SensorHookKind> kLoop{{"hysteresis", "loop of a Preisach plane, rate-independent", 0.12,
                                          [](double share) { return std::make_unique<LoopHook>(share); }}};
const Registration<SensorHookKind> kCreep{{"creep", "growth under load as a power of time", 0.08,
                                           [](double share) { return std::make_unique<CreepHook>(share); }}};

struct NamedHook {
  const SensorHookKind* kind = nullptr;
  double strength = 0.0;
};

Result<NamedHook> named_hook(const std::string& text) {
  const std::size_t colon = text.find(':');
  const std::string name = text.substr(0, colon),
                    how = colon == std::string::npos ? "medium" : text.substr(colon + 1);
  const SensorHookKind* kind = Registry<SensorHookKind>::instance().find(name);
  if (!kind)
    return fail(ErrorCode::config, "the emulated sensor cannot hide '" + printable_utf8(name) + "'", "rig emulated",
                "it has: " + join(Registry<SensorHookKind>::instance().names(), ", "));
  if (how == "weak") return NamedHook{kind, 0.4 * kind->medium};
  if (how == "medium") return NamedHook{kind, kind->medium};
  if (how == "strong") return NamedHook{kind, 2.5 * kind->medium};
  double share = 0.0;
  const auto [end, error] = std::from_chars(how.data(), how.data() + how.size(), share);
  if (error != std::errc{} || end != how.data() + how.size() || !(share >= 0.0 && share <= 1.0))
    return fail(ErrorCode::config, "'" + printable_utf8(how) + "' is no strength", "rig emulated",
                "use weak, medium, strong, or a share of the load from 0 to 1");
  return NamedHook{kind, share};
}

}  // namespace

Result<std::unique_ptr<SensorHook>> make_sensor_hook(const std::string& text) {
  if (text == kNothing) return std::unique_ptr<SensorHook>();
  FORCEGATE_TRY(const NamedHook hook, named_hook(text));
  return hook.kind->make(hook.strength);
}

Result<std::string> resolved_sensor_hook(const std::string& text) {
  if (text == kNothing) return text;
  FORCEGATE_TRY(const NamedHook hook, named_hook(text));
  return hook.kind->name + ":" + shortest(hook.strength);
}

std::string sealed_sensor_hook(const std::string& resolved) {
  constexpr std::size_t kLength = 40;  // of the longest, so that none is told by its length
  const hidden::SealedSheet sheet = hidden::seal(resolved + std::string(kLength - std::min(kLength, resolved.size()), ' '), kNonce);
  return std::string(kSealedSetting) + sheet.commitment + ":" + sheet.sealed;
}

Result<std::string> unsealed_sensor_hook(const std::string& text) {
  if (!text.starts_with(kSealedSetting)) return text;
  const std::string rest = text.substr(kSealedSetting.size());
  const std::size_t colon = rest.find(':');
  const auto sheet = hidden::open({rest.substr(0, colon), kNonce, colon == std::string::npos ? "" : rest.substr(colon + 1)});
  if (!sheet) return fail(ErrorCode::config, "what the sensor hides does not fit its seal: it was changed after it was sealed", "rig emulated", "take the text as forcegate record wrote it");
  return std::string(trim(*sheet));
}

}  // namespace forcegate::emulated
