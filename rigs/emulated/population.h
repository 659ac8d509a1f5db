#pragma once
// Who lies on the emulated bench. Parameters are drawn on two levels from the spreads that the paper states:
//   specimen: b 25 % (IV-A1b), q = c/a 14 % (ours: the paper gives the fit error of c, no spread of c/a)
//   session:  gain G 9 %, offset F0 22 % (III-D; FSR 10 % and 45 %); b and q repeat to 4 % (ours)
// All draws are normal and cut at +-2 standard deviations. Nothing is tuned per test.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "hil/base/result.h"
#include "rigs/emulated/film.h"

namespace forcegate::emulated {

enum class SensorType { flexiforce, fsr };

/// What stays with a specimen.
struct Specimen {
  std::string name;
  double b_scale = 1.0;      ///< decay rate against eq. (5)
  double q_scale = 1.0;      ///< c/a against eq. (5)
  double loss_20min = 0.16;  ///< FSR: loss of the maxima in 20 min, negative = they rise
  double curvature = 0.006;
  double creep_share = 0.025;
  double play_share = 0.05;
};

/// Nominal values of law (1): what the paper would tell about the type of sensor.
inline constexpr double kNominalGain_N_per_V = 0.5;
inline constexpr double kNominalOffset_N = 0.15;

/// The fixed panel: nine quantiles of the b spread, each paired with a quantile of the q spread by a fixed
/// permutation, so that the two are not correlated.
const std::vector<std::string>& panel_names();  ///< "q05" "q15" "q25" "q38" "q50" "q62" "q75" "q85" "q95"

/// "nominal", a name of the panel, any "qNN" (01-99, b and q at that quantile and its mirror), or "seed:N".
Result<Specimen> find_specimen(std::string_view name);

/// The film of this specimen in a session: draws G, F0 and the repeatability from (seed, session);
/// record > 0 draws the repeatability of b and q for that record of the session.
/// `spread` = false gives nominal G and F0 and exact repeatability.
FilmParameters draw_session(SensorType type, const Specimen& specimen, std::uint64_t seed,
                            std::uint64_t session, bool spread = true, std::uint64_t record = 0);

/// Standard normal quantile, 0 < p < 1, error below 5e-9.
double normal_quantile(double p);

}  // namespace forcegate::emulated
