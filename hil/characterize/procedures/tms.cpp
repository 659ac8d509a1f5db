// Robotised TMS (V-B, Fig. 12): the robot holds 1.5 N on the head of a patient who breathes, moves suddenly and at times
// leaves the coil, for 20 minutes. Force by eq. (1), no compensation: the FSR's way.
//   contact   largest force by the ATI over the whole record: below 5 N always (II-A)
//   noise     largest peak to peak of the detrended ATI force in a steady span (our reading of "force noise, as felt by the
//             patient ... below 0.34 N"): 5 s, and the 2 s before, in which "the position of the coil barely changes": its
//             speed, mean over 0.1 s, stays below 3 mm/s, which is twice that of breathing. The straight line through the
//             span is taken out; the force itself selects nothing

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "hil/characterize/session.h"

namespace forcegate::characterize {
namespace {

constexpr double kSetpoint_N = 1.5, kSpan_s = 5.0, kBefore_s = 2.0, kSpeedOver_s = 0.1,
                 kBarely_mm_per_s = 3.0;
constexpr double kNoContact_N = 0.05, kCurveStep_s = 0.1;

double detrended_peak_to_peak_N(const std::vector<float>& force_N, std::size_t from, std::size_t n) {
  double st = 0, sf = 0, stt = 0, stf = 0;
  const double count = static_cast<double>(n);
  for (std::size_t i = 0; i < n; ++i) {
    const double t = static_cast<double>(i), f = static_cast<double>(force_N[from + i]);
    st += t, sf += f, stt += t * t, stf += t * f;
  }
  const double slope = (stf - st * sf / count) / (stt - st * st / count);
  double low = 1e9, high = -1e9;
  for (std::size_t i = 0; i < n; ++i) {
    const double f = static_cast<double>(force_N[from + i]) - slope * static_cast<double>(i);
    low = std::min(low, f);
    high = std::max(high, f);
  }
  return high - low;
}

Result<void> run(Session& s) {
  const double per_code = s.bench.volts_per_code();
  const double gain = s.sheet.calibration.gain_N_per_V * per_code, offset = s.sheet.calibration.offset_N;
  std::vector<float> force_N, position_mm;
  Curve curve{"fig12", {"t_s", "ati_N", "position_mm"}, std::vector<std::vector<float>>(3)};
  double next_s = 0.0;
  FORCEGATE_TRY(
      const PlayedRecord played,
      s.bench.play(rest(kSetpoint_N, s.plan.record_s),
                   [&](const RigBlock& b, std::size_t n, std::span<const float>) {
                     force_N.insert(force_N.end(), b.force_ref_N.begin(),
                                    b.force_ref_N.begin() + static_cast<std::ptrdiff_t>(n));
                     const RigGeometry g = s.bench.info().geometry;
                     for (std::size_t i = 0; i < n; ++i) {
                       position_mm.push_back(static_cast<float>(
                           g.eccentricity_mm * (1.0 - std::cos(static_cast<double>(b.theta_rad[i])))));
                       if (!s.curves || b.t_s[i] < next_s) continue;
                       next_s += kCurveStep_s;
                       curve.data[0].push_back(static_cast<float>(b.t_s[i]));
                       curve.data[1].push_back(b.force_ref_N[i]);
                       curve.data[2].push_back(position_mm.back());
                     }
                   },
                   {.estimator = [=](std::uint16_t code) { return gain * code + offset; },
                    .controller = "contact_force",
                    .faults = {{"head_motion", 1.0}}}));
  if (played.safety.stopped())
    return fail(ErrorCode::safety, fmt::format("the treatment was stopped at {:.1f} s: {}", played.safety.t_s, to_string(played.safety.reason)));
  const double rate_Hz = played.rig.rate_Hz;
  const auto rows = [&](double t_s) { return static_cast<std::size_t>(t_s * rate_Hz + 0.5); };
  const std::size_t span = rows(kSpan_s), before = rows(kBefore_s), stride = rows(kSpeedOver_s);
  const auto still = [&](std::size_t from, std::size_t to) {
    for (std::size_t i = from; i + stride <= to; i += stride)
      if (std::abs(static_cast<double>(position_mm[i + stride - 1] - position_mm[i])) >
          kBarely_mm_per_s * kSpeedOver_s)
        return false;
    return true;
  };
  double noise_N = 0.0, steady = 0.0, spans = 0.0;
  for (std::size_t from = before; from + span <= force_N.size(); from += span) {
    spans += 1.0;
    if (!still(from - before, from + span)) continue;
    noise_N = std::max(noise_N, detrended_peak_to_peak_N(force_N, from, span));
    steady += 1.0;
  }
  double lost = 0.0, largest_N = 0.0;
  for (const float f : force_N) {
    lost += f < kNoContact_N ? 1.0 : 0.0;
    largest_N = std::max(largest_N, static_cast<double>(f));
  }
  const double n = static_cast<double>(force_N.size());
  s.add("tms.contact", "TMS: largest contact force", "N", largest_N);
  s.add("tms.noise", "TMS: force noise in steady spans, peak to peak", "N",
        steady > 0.0 ? noise_N : std::nan(""));
  s.add("tms.steady", "TMS: share of the time that is steady", "%", 100.0 * steady / spans);
  s.add("tms.lost", "TMS: share of the time without contact", "%", 100.0 * lost / n);
  s.add("tms.duration", "TMS: length of the record", "s", n / rate_Hz);
  if (s.curves) s.sheet.curves.push_back(std::move(curve));
  return {};
}

const Registration<ProcedureKind> kRow{
    {"tms", "Robotised TMS: 1.5 N on a moving head for 20 min (V-B, Fig. 12)", true, run,
     always({"tms.contact", "tms.noise", "tms.steady", "tms.lost", "tms.duration"})}};

}  // namespace
}  // namespace forcegate::characterize
