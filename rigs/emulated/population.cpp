#include "rigs/emulated/population.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "hil/base/portable_math.h"
#include "hil/base/rng.h"
#include "hil/base/text.h"

namespace forcegate::emulated {
namespace {

constexpr double kRateSpread = 0.25, kRatioSpread = 0.14, kRepeatability = 0.04;
constexpr double kCut = 2.0;

struct PanelEntry {
  const char* name;
  double b_quantile, q_quantile;
};
constexpr std::array<PanelEntry, 9> kPanel{{{"q05", 0.05, 0.38},
                                            {"q15", 0.15, 0.85},
                                            {"q25", 0.25, 0.15},
                                            {"q38", 0.38, 0.62},
                                            {"q50", 0.50, 0.50},
                                            {"q62", 0.62, 0.95},
                                            {"q75", 0.75, 0.05},
                                            {"q85", 0.85, 0.75},
                                            {"q95", 0.95, 0.25}}};

double cut_normal(Rng& rng) {
  double z = rng.normal();
  while (std::abs(z) > kCut) z = rng.normal();
  return z;
}

Specimen at_quantiles(std::string name, double b_quantile, double q_quantile) {
  Specimen s;
  s.name = std::move(name);
  s.b_scale = 1.0 + kRateSpread * std::clamp(normal_quantile(b_quantile), -kCut, kCut);
  s.q_scale = 1.0 + kRatioSpread * std::clamp(normal_quantile(q_quantile), -kCut, kCut);
  // FSR: 16 % on average, up to 30 %, sometimes rising (III-C, Fig. 7).
  s.loss_20min = 0.16 + 0.10 * std::clamp(normal_quantile(b_quantile), -2.2, 1.4);
  return s;
}

Specimen drawn(std::string name, std::uint64_t seed) {
  Rng rng(seed, "specimen");
  Specimen s;
  s.name = std::move(name);
  s.b_scale = 1.0 + kRateSpread * cut_normal(rng);
  s.q_scale = 1.0 + kRatioSpread * cut_normal(rng);
  s.loss_20min = 0.16 + 0.10 * std::clamp(rng.normal(), -2.2, 1.4);
  s.curvature = 0.006 * cut_normal(rng);
  s.creep_share = 0.025 * (1.0 + 0.4 * cut_normal(rng));
  s.play_share = 0.05 * (1.0 + 0.3 * cut_normal(rng));
  return s;
}

}  // namespace

double normal_quantile(double p) {
  // Bisection on the distribution function by Simpson's rule would do; Newton on it is shorter still.
  const double target = p < 0.5 ? 1.0 - p : p;
  const auto density = [](double x) { return 0.39894228040143267794 * portable::exp(-0.5 * x * x); };
  const auto cumulative = [&](double x) {
    constexpr int kPanels = 64;
    const double h = x / kPanels;
    double sum = density(0.0) + density(x);
    for (int i = 1; i < kPanels; ++i) sum += (i % 2 ? 4.0 : 2.0) * density(i * h);
    return 0.5 + sum * h / 3.0;
  };
  double x = 0.0;
  for (int i = 0; i < 60; ++i) {
    const double next = std::min(x + (target - cumulative(x)) / density(x), x + 1.0);
    if (std::abs(next - x) < 1e-12) break;
    x = next;
  }
  return p < 0.5 ? -x : x;
}

const std::vector<std::string>& panel_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> out;
    for (const PanelEntry& e : kPanel) out.emplace_back(e.name);
    return out;
  }();
  return names;
}

Result<Specimen> find_specimen(std::string_view name) {
  if (name == "nominal" || name.empty()) return at_quantiles("nominal", 0.5, 0.5);
  for (const PanelEntry& e : kPanel)
    if (name == e.name) return at_quantiles(e.name, e.b_quantile, e.q_quantile);
  const auto number = [](std::string_view digits) -> Result<std::uint64_t> {
    std::uint64_t n = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), n);
    if (error != std::errc{} || end != digits.data() + digits.size() || digits.empty())
      return fail(ErrorCode::config, "'" + printable_utf8(digits) + "' is not a whole number", "rig emulated", "write for instance seed:1000");
    return n;
  };
  if (name.starts_with("seed:")) {
    FORCEGATE_TRY(const std::uint64_t seed, number(name.substr(5)));
    return drawn(std::string(name), seed);
  }
  if (name.starts_with("q") && name.size() == 3) {
    if (const auto percent = number(name.substr(1)); percent && *percent >= 1) {
      const double quantile = static_cast<double>(*percent) / 100.0;
      return at_quantiles(std::string(name), quantile, 1.0 - quantile);
    }
  }
  return fail(ErrorCode::config, "the emulated rig has no specimen '" + printable_utf8(name) + "'", "rig emulated",
              "use nominal, one of " + join(panel_names(), ", ") + ", another quantile from q01 to q99, or seed:N");
}

FilmParameters draw_session(SensorType type, const Specimen& specimen, std::uint64_t seed,
                            std::uint64_t session, bool spread, std::uint64_t record) {
  Rng rng(mix_seed(seed, "session/" + specimen.name), std::to_string(session));
  const auto z = [&] { return spread ? cut_normal(rng) : 0.0; };
  const bool fsr = type == SensorType::fsr;
  FilmParameters film;
  film.gain_N_per_V = kNominalGain_N_per_V * (1.0 + (fsr ? 0.10 : 0.09) * z());
  film.offset_N = kNominalOffset_N * (1.0 + (fsr ? 0.45 : 0.22) * z());
  film.loading.b_scale = specimen.b_scale * (1.0 + kRepeatability * z());
  film.loading.q_scale = specimen.q_scale * (1.0 + kRepeatability * z());
  if (record != 0 &&
      spread) {  // what repeats to 4 % does so from record to record, not only between sessions
    Rng again(mix_seed(seed, "record/" + specimen.name),
              std::to_string(session) + "/" + std::to_string(record));
    film.loading.b_scale = specimen.b_scale * (1.0 + kRepeatability * cut_normal(again));
    film.loading.q_scale = specimen.q_scale * (1.0 + kRepeatability * cut_normal(again));
  }
  film.curvature = specimen.curvature;
  film.creep_share = specimen.creep_share;
  film.play_share = specimen.play_share;
  if (fsr) {
    // The paper has no model of the FSR: static law, lag, a nearly linear loss and a wandering swing are
    // ours.
    film.curvature = 4.0 * specimen.curvature;
    film.play_share = 1.5 * specimen.play_share;
    film.lag_s = 0.060;
    film.wander = 0.012;
    film.loading.rate_offset_per_s = 3e-4;
    film.loading.rate_slope_per_s_Hz = 0.0;
    film.loading.b_scale = 1.0;
    // y(1200 s) = 0.302 floor for this rate
    film.loading.fixed_loss = std::abs(specimen.loss_20min) / 0.302;
    film.loading.sign = specimen.loss_20min < 0.0 ? -1.0 : 1.0;
    film.loading.bump = 0.2;
    // III-D: gain -11 % after cycling, whatever the loss: the static output rises by 12 %. The larger figure
    // stands for the release until a calibration some minutes later.
    film.loading.residue = -0.18 * film.loading.sign / std::max(0.02, std::abs(specimen.loss_20min));
  }
  return film;
}

}  // namespace forcegate::emulated
