#include "hil/gate/input_checks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace forcegate {
namespace {

constexpr double kInputLagShare = 0.6;
// A specimen calibrated for this record reads low where it loses or has not crept yet, and never high. A calibration that was
// given: from session to session the gain differs by 9 % and the offset by 22 % (Lebosse 2011, III-D).
struct Tolerance {
  double rel, floor_N, low_rel, low_floor_N;
};
constexpr Tolerance kOwnLevel{0.04, 0.03, 0.12, 0.05}, kOwnSwing{0.05, 0.05, 0.12, 0.05}, kGivenFits{0.25, 0.1, 0.25, 0.1};
// What the film may have lost of the force by then: at once, and with every second of cycling (b of eq. (5) at 1.5 N).
constexpr double kFilmLoss = 0.03, kFilmLoss_per_s = 0.004;
constexpr double kLevel_N = 0.5;     // below, what is off is no gain
constexpr double kCarriedOn = 1.5;  // of a gain into the error: c/a goes with the square of the amplitude (measured: 1.2 to 1.4)
constexpr double kFirstSwing_s = 25.0;  // one cycle at 0.05 Hz and the ramp

Check to_check(std::string id, std::string title, double value, std::string unit, double limit, Blame blame,
               std::string evidence) {
  Check c;
  c.id = std::move(id);
  c.title = std::move(title);
  c.value = value;
  c.unit = std::move(unit);
  c.limit = {Limit::Kind::upper, limit, "ours: rig self-check"};
  c.verdict = value <= limit ? Verdict::pass : Verdict::rig_error;
  c.blame = c.verdict == Verdict::pass ? Blame::none : blame;
  c.evidence = std::move(evidence);
  return c;
}

std::optional<Check> sensor_sync(const Plan& plan, const CaseRecord& record) {
  if (!std::isfinite(record.raw_lag_s) || !record.facts.dynamic) return std::nullopt;
  const bool behind = record.raw_lag_s >= 0.0;
  const auto sensor = record.rig.details.find("sensor");
  const bool is_fsr = sensor != record.rig.details.end() && sensor->second.find("FSR") != std::string::npos;
  return to_check("rig_sensor_sync", "Distance in time between the sensor's codes and the ATI", std::fabs(record.raw_lag_s),
                  "s", kInputLagShare * plan.limits.lag_s, !behind ? Blame::reference : is_fsr ? Blame::sensor : Blame::link,
                  fmt::format("the {} {:.1f} ms behind the {}", behind ? "codes are" : "ATI is", 1000.0 * std::fabs(record.raw_lag_s),
                              !behind  ? "codes: its reading is late"
                              : is_fsr ? "ATI: an FSR lags by tens of milliseconds itself, and no image sees the force earlier (lag_s of [limits] allows more)"
                                       : "ATI"));
}

// Departure over tolerance: <= 1 fits.
double departure(double raw_N, double ati_N, const Tolerance& t) {
  const double off_N = raw_N - ati_N;
  return off_N > 0.0 ? off_N / (t.rel * std::fabs(ati_N) + t.floor_N) : -off_N / (t.low_rel * std::fabs(ati_N) + t.low_floor_N);
}

// Swing of the first minimum and maximum after the excitation began, where the converter has room for both.
struct Swing {
  double raw_N, ati_N, until_s;  // until_s: since the excitation began
};

std::optional<Swing> first_swing(const CaseRecord& record) {
  const CasePair* low = nullptr;
  const CasePair* high = nullptr;
  for (const CasePair& p : record.pairs) {
    if (p.t_s < record.facts.excitation_start_s || !std::isfinite(p.raw_N + p.ati_N)) continue;
    const CasePair*& slot = p.maximum ? high : low;
    if (slot == nullptr) slot = &p;
    if (low != nullptr && high != nullptr) break;
  }
  if (low == nullptr || high == nullptr) return std::nullopt;
  const double until_s = std::max(low->t_s, high->t_s) - record.facts.excitation_start_s;
  if (until_s > kFirstSwing_s) return std::nullopt;
  const Calibration& c = record.calibration;
  const double top_N = c.offset_N + c.gain_N_per_V * c.v_range_V;
  if (low->ati_N < c.offset_N + 0.1 || high->ati_N > top_N - 0.1) return std::nullopt;
  return Swing{high->raw_N - low->raw_N, high->ati_N - low->ati_N, until_s};
}

// Volts in the column of newtons and newtons in that of volts: would the first seconds fit the other way round?
bool fits_exchanged(const CaseRecord& record) {
  const Calibration& c = record.calibration;
  const double code_V = (record.early_raw_N - c.offset_N) / c.gain_N_per_V;
  return departure(c.offset_N + c.gain_N_per_V * record.early_ati_N, code_V, kGivenFits) <= 1.0;
}

// Of a divider or another range nobody told of: by how much the sensor's volts are too small, as level and first swing say alike.
std::optional<double> factor_that_fits(const CaseRecord& record) {
  constexpr double kAlike = 0.05, kWorthTelling = 0.1;
  const auto swing = first_swing(record);
  const double of_volts_N = record.early_raw_N - record.calibration.offset_N;
  if (!swing || !(of_volts_N > 0.0) || !(swing->raw_N > 0.0)) return std::nullopt;
  const double of_level = (record.early_ati_N - record.calibration.offset_N) / of_volts_N, of_swing = swing->ati_N / swing->raw_N;
  if (!(std::fabs(of_level / of_swing - 1.0) < kAlike) || std::fabs(of_level - 1.0) < kWorthTelling) return std::nullopt;
  return of_level;
}

// What would make the recording fit: with an offset of nearly nothing both may.
std::string would_fit(const CaseRecord& record) {
  std::string out;
  const auto factor = record.calibration.level == CalibrationLevel::nominal ? std::nullopt : factor_that_fits(record);  // nominal values are a factor off anyway
  if (factor) out = fmt::format("; the sensor's volts times {:.2g} would fit: a divider, or another range?", *factor);
  if (fits_exchanged(record)) out += fmt::format("; with the columns of sensor and ATI exchanged it would fit{}", out.empty() ? "" : " too");
  return out;
}

// A bench calibrates in the run or is told; nominal values of the type are meant to be wrong there, and the plan says so.
// A recording is judged by what was given, whatever that is.
bool to_be_held_against(const CaseRecord& record) {
  return std::isfinite(record.early_raw_N) && !(record.rig.can_move && record.calibration.level == CalibrationLevel::nominal);
}

std::optional<Check> calibration_fits(const CaseRecord& record) {
  if (!to_be_held_against(record)) return std::nullopt;
  const bool given = record.calibration_given;
  double worst = departure(record.early_raw_N, record.early_ati_N, given ? kGivenFits : kOwnLevel);
  std::string evidence = fmt::format("calibration '{}' makes {:.3f} N of {:.3f} N over the first 3 s",
                                     record.calibration.id, record.early_raw_N, record.early_ati_N);
  if (const auto swing = first_swing(record)) {
    worst = std::max(worst, departure(swing->raw_N, swing->ati_N, given ? kGivenFits : kOwnSwing));
    evidence += fmt::format(", {:.3f} N of the first swing of {:.3f} N", swing->raw_N, swing->ati_N);
  }
  Check c = to_check("rig_calibration_fits",
                     "Calibration that was loaded against the ATI, departure over tolerance", worst, "1", 1.0,
                     Blame::calibration, std::move(evidence));
  if (c.verdict == Verdict::pass || !record.calibration_given) return c;
  c.verdict = Verdict::inconclusive;  // playing it again with the same file gives the same
  const std::string fits = record.rig.can_move ? std::string() : would_fit(record);
  if (!fits.empty()) c.evidence += fits;
  else if (!record.rig.can_move && record.calibration.level == CalibrationLevel::nominal)
    c.evidence += "; no calibration was given: --cal FILE (forcegate bench calibrate)";
  return c;
}

}  // namespace

Misfit calibration_misfit(const CaseRecord& record) {
  if (!to_be_held_against(record)) return {};
  const double least_N = std::max(kLevel_N, std::fabs(record.early_ati_N));
  const double level = (record.early_raw_N - record.early_ati_N) / least_N;
  double high = level + kFilmLoss, low = -level;
  if (const auto swing = first_swing(record); swing && swing->ati_N > 0.0) {
    const double gain = swing->raw_N / swing->ati_N - 1.0;
    high = std::max(high, gain + kFilmLoss + kFilmLoss_per_s * swing->until_s);
    low = std::max(low, -gain);
  }
  return {kCarriedOn * std::max(0.0, high), kCarriedOn * std::max(0.0, low)};
}

std::vector<Check> input_checks(const Plan& plan, const CaseRecord& record) {
  std::vector<Check> checks;
  if (auto check = sensor_sync(plan, record)) checks.push_back(std::move(*check));
  if (auto check = calibration_fits(record)) checks.push_back(std::move(*check));
  return checks;
}

}  // namespace forcegate
