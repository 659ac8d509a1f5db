#include "hil/diagnose/raw/health_claims.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "hil/base/plain_number.h"
#include "hil/base/quantile.h"
#include "hil/diagnose/raw/held_codes.h"
#include "hil/diagnose/raw/mains_line.h"
#include "hil/diagnose/raw/reference_noise_claim.h"

namespace forcegate::diagnose {

bool shows_hum(const RecordHealth& h, const HealthScales& scales) { return h.hum_ratio > kPlainLine && h.hum_V > 4e-4 * scales.U_range_V; }

RecordsOfHum records_of_hum(const std::vector<RecordHealth>& health, const HealthScales& scales, double mains_Hz) {
  RecordsOfHum out;
  for (const RecordHealth& h : health) {
    const bool shows = may_be_of_mains(h.hum_Hz, mains_Hz, h.rate_Hz) && shows_hum(h, scales);
    out.show += shows ? 1 : 0;
    out.can_show += h.hum_ratio > 0.0 && can_show_mains(mains_Hz, h.rate_Hz) ? 1 : 0;
  }
  return out;
}

bool is_hum(const RecordsOfHum& records) {
  constexpr std::size_t kSeveral = 2;
  return records.show > 0 && records.show >= std::min(kSeveral, records.can_show) && 2 * records.show >= records.can_show;
}

namespace {

std::optional<HealthClaim> claim_of_hum(const std::vector<RecordHealth>& health, const HealthScales& scales) {
  for (const double mains_Hz : kMains_Hz) {
    if (!is_hum(records_of_hum(health, scales, mains_Hz))) continue;
    std::vector<double> amplitude_V, line_Hz;
    for (const RecordHealth& h : health)
      if (may_be_of_mains(h.hum_Hz, mains_Hz, h.rate_Hz) && shows_hum(h, scales)) {
        amplitude_V.push_back(h.hum_V);
        line_Hz.push_back(h.hum_Hz);
      }
    const double middle_V = quantile(amplitude_V, 0.5);
    return HealthClaim{"hum", 0.95, fmt::format("a line at {:.4g} Hz stands in the output and not in the force", quantile(line_Hz, 0.5)),
                       "amplitude_V", scales.unit, middle_V, 0.1 * middle_V};
  }
  return std::nullopt;
}

// A record has few of them, and a converter is the same in all.
bool are_steps_of_converter(const std::vector<RecordHealth>& health) {
  std::vector<Jump> all;
  double near_V = 0.0;
  std::size_t outliers = 0;
  for (const RecordHealth& h : health) {
    all.insert(all.end(), h.lone_jumps.begin(), h.lone_jumps.end());
    near_V = std::max(near_V, h.near_V);
    outliers += h.outliers;
  }
  return all.size() * 2 > outliers && go_back_and_forth(all, near_V);
}

}  // namespace

std::vector<HealthClaim> health_claims(const std::vector<RecordHealth>& health, const HealthScales& scales,
                                       const BenchFacts& bench) {
  std::vector<HealthClaim> out;
  // where spikes stand elsewhere too, a single sample at the low end is one of them
  std::size_t spikes = 0;
  for (const RecordHealth& h : health) spikes += h.outliers;
  constexpr std::size_t kFewestSpikes = 12;
  const bool lone_are_spikes = spikes >= kFewestSpikes;
  double samples = 0.0, missing = 0.0, reference_missing = 0.0, missing_variance = 0.0, outliers = 0.0, held = 0.0, zeros = 0.0, fallen = 0.0, rail = 0.0;
  double outlier_square_V2 = 0.0;
  bool plainly_held = false;
  std::size_t silent_runs = 0, with_silent = 0;
  double silent = 0.0;
  std::size_t with_outliers = 0, with_any_outlier = 0, with_held = 0, with_zeros = 0, zero_runs = 0, with_missing = 0, missing_runs = 0, far_holds = 0, with_far_holds = 0, lasting_holds = 0;
  double rail_V = 0.0, bit_errors = 0.0;
  std::size_t with_bit_errors = 0;
  std::vector<double> bit_V;
  for (const RecordHealth& h : health) {
    samples += static_cast<double>(h.samples);
    outliers += static_cast<double>(h.outliers);
    held += static_cast<double>(h.held);
    zeros += static_cast<double>(h.zeros);
    (lone_are_spikes ? outliers : zeros) += static_cast<double>(h.lone_zeros);
    silent_runs += h.silent_runs;
    with_silent += h.silent_runs > 0 ? 1 : 0;
    silent += static_cast<double>(h.silent);
    missing += static_cast<double>(h.missing);
    missing_runs += h.missing_runs;
    reference_missing += static_cast<double>(h.reference_missing);
    missing_variance += h.missing_variance;
    with_missing += h.missing_runs > 0 ? 1 : 0;
    rail += static_cast<double>(h.at_rail);
    zero_runs += h.zero_runs;
    fallen += h.zero_runs > 0 ? static_cast<double>(h.zeros) : 0.0;
    with_zeros += h.zero_runs > 0 ? 1 : 0;
    with_outliers += h.outliers >= 2 ? 1 : 0;
    with_any_outlier += h.outliers > 0 ? 1 : 0;
    outlier_square_V2 += h.outlier_square_V2;
    // a slow record does not show that its samples are held: one that does so again and again is enough
    constexpr double kManyHeld = 0.005;
    constexpr std::size_t kManyRuns = 10;
    plainly_held = plainly_held || (static_cast<double>(h.held) > kManyHeld * static_cast<double>(h.samples) && h.at_rail == 0 && h.runs.size() >= kManyRuns);
    // nor does any hand hold the output that long at one code where its noise goes over the codes
    constexpr std::size_t kLongHold = 100;
    plainly_held = plainly_held || (h.at_rail == 0 && h.noise_U_V > h.lsb_U_V && std::ranges::any_of(h.runs, [](const HeldRun& run) { return run.samples >= kLongHold; }));
    // and one that stands while the force goes through a tenth of its range, and then jumps to where it has been meanwhile
    constexpr double kFarOff = 0.05;  // of the range
    const auto far_off = h.at_rail > 0 ? 0 : std::ranges::count_if(h.runs, [&](const HeldRun& run) { return run.error_V > kFarOff * scales.U_range_V; });
    far_holds += static_cast<std::size_t>(far_off);
    // one that does so for long, and farther, needs no second record
    constexpr double kVeryFar = 0.1;
    constexpr std::size_t kLasting = 16;
    if (h.at_rail == 0)
      lasting_holds += static_cast<std::size_t>(std::ranges::count_if(h.runs, [&](const HeldRun& run) { return run.samples >= kLasting && run.error_V > kVeryFar * scales.U_range_V; }));
    with_far_holds += far_off > 0 ? 1 : 0;
    with_held += h.held + h.zeros + (lone_are_spikes ? 0 : h.lone_zeros) >= 4 ? 1 : 0;
    bit_errors += static_cast<double>(h.bit_errors);
    if (h.bit_errors > 0) {
      ++with_bit_errors;
      bit_V.push_back(h.bit_V);
    }
    if (h.at_rail > 0) rail_V = h.rail_V;
  }
  if (samples < 1.0) return out;
  if (are_steps_of_converter(health)) outliers = 0.0;
  const auto percent = [](double share) { return plain_number(100.0 * share) + " %"; };
  const std::size_t n = health.size();
  const bool many_records = n >= 3;
  const std::size_t several = std::min<std::size_t>(2, n);  // one recording has no second to bear it out
  constexpr double kShare = 1.5e-4;  // of the samples: fewer are left out, and no matter for a fit
  const HeldCodes codes = find_held_codes(health, scales);
  constexpr double kLeastHeld = 1e-3;
  if (codes.found) held -= std::min(held, codes.samples);
  if (codes.found && codes.samples / samples > kLeastHeld) {
    out.push_back({"adc_codes", 0.95,
                   percent(codes.samples / samples) + " of the samples stand at " +
                       (codes.value_V.size() == 1 ? std::string("one value") : std::to_string(codes.value_V.size()) + " values") +
                       (n > 1 ? ", the same in several records," : ", the same again and again,") + " while the force moves on: codes beside them never come",
                   "code_V", scales.unit, codes.value_V.front(), scales.U_range_V * 1e-4});
    rail = outliers = bit_errors = 0.0;  // a sample on the other side of a gap stands off its neighbours too
  }
  if (bit_errors / samples > kShare && with_bit_errors >= several)
    out.push_back(
        {"adc_codes", 0.95,
         percent(bit_errors / samples) + " of the samples are off by the weight of one bit of the converter",
         "bit_V", scales.unit, quantile(bit_V, 0.5), 0.05 * quantile(bit_V, 0.5)});
  // a few are somebody's hand on the cable, unless they make an error that matters, again and again
  constexpr double kFew = 5.0, kLargeError = 0.01;  // RMS, of the span
  const bool few_but_large = outliers >= kFew && with_any_outlier >= 3 && std::sqrt(outlier_square_V2 / samples) > kLargeError * scales.U_range_V;
  // one short recording has few, and no hand that comes back all along it
  constexpr double kOften = 1e-3, kSeveral = 7.0;
  constexpr std::size_t kAllAlong = 4;  // eighths
  const bool few_all_along = n == 1 && outliers >= kSeveral && outliers / samples > kOften && health.front().outlier_parts >= kAllAlong;
  if (few_but_large || few_all_along || (outliers / samples > kShare && outliers >= 12 && (with_outliers >= 2 || !many_records)))
    out.push_back({"outliers", 0.95,
                   percent(outliers / samples) +
                       " of the samples stand far off their neighbours while the force is smooth",
                   "share", "1", outliers / samples, std::sqrt(outliers) / samples});
  // the output cannot be at its low end there: a few are enough, and so are two losses of several samples or a long one
  constexpr std::size_t kFewestZeros = 5, kFewestLong = 2;
  constexpr double kLong = 3.0, kLongLoss = 20.0;  // samples
  const bool are_long = zeros >= kLong * static_cast<double>(zero_runs);
  const bool plain_zeros = !lone_are_spikes && ((with_zeros >= several && zero_runs >= (are_long ? kFewestLong : kFewestZeros)) || fallen >= kLongLoss);
  const bool plain_holds = !codes.found && ((far_holds >= kFewestLong && with_far_holds >= several) || lasting_holds >= kFewestLong);
  constexpr std::size_t kFewestSilent = 4;
  const bool plain_silence = !codes.found && silent_runs >= kFewestSilent && with_silent >= several;
  if (plain_silence) held += silent;
  // a sample that is missing here and there is noted, and so is a logger that loses cells of every column; an output that goes missing again
  // and again in most records, and plainly more than the reference does, loses samples
  constexpr std::size_t kFewestRuns = 10;
  constexpr double kManyMissing = 0.01, kErrors = 3.0;
  const double more = missing - reference_missing, u_more = std::sqrt(missing_variance);
  if (more > kManyMissing * samples && more > kErrors * u_more && with_missing * 2 > n && missing_runs >= kFewestRuns)
    out.push_back({"dropouts", 0.95,
                   percent(missing / samples) + " of the samples of the output are missing while the reference goes on" +
                       (reference_missing > 0.0 ? ", " + percent(reference_missing / samples) + " of the reference's alone" : ""),
                   "share", "1", more / samples, u_more / samples});
  else if (plain_zeros || plain_holds || plain_silence || ((held + zeros) / samples > kShare && held + zeros >= 20 && (with_held >= 2 || !many_records || plainly_held)))
    out.push_back(
        {"dropouts", 0.95,
         percent((held + zeros) / samples) + " of the samples are held or zero where the force, or their own noise, says otherwise",
         "share", "1", (held + zeros) / samples, std::sqrt(held + zeros) / samples});
  if (rail / samples > 1e-3)
    out.push_back({"clipping", 0.95,
                   "the output stays at exactly one value at its top while the force moves on", "rail_V", scales.unit,
                   rail_V, scales.U_range_V * 1e-4});
  if (auto hum = claim_of_hum(health, scales)) out.push_back(std::move(*hum));
  if (auto noise = claim_of_reference_noise(health, scales, bench)) out.push_back(std::move(*noise));
  return out;
}

std::string note_of_left_out(const std::vector<RecordHealth>& health, const std::vector<HealthClaim>& claims) {
  const auto claimed = [&](const char* effect) { return std::ranges::find(claims, effect, &HealthClaim::effect) != claims.end(); };
  constexpr std::size_t kNamed = 4;
  std::size_t zeros = 0, spikes = 0, records = 0;
  std::string where;
  for (const RecordHealth& h : health) {
    const std::size_t own_zeros = claimed("dropouts") ? 0 : h.zeros + (claimed("outliers") ? 0 : h.lone_zeros), own_spikes = claimed("outliers") ? 0 : h.outliers;
    zeros += own_zeros;
    spikes += own_spikes;
    if (own_zeros + own_spikes > 0 && ++records <= kNamed) where += (where.empty() ? "" : ", ") + h.record;
  }
  if (records > kNamed) where += " and " + std::to_string(records - kNamed) + " more";
  if (zeros + spikes == 0) return {};
  const auto told = [](std::size_t n, const char* what) { return n > 0 ? std::to_string(n) + " " + what : std::string(); };
  const bool of_steps = are_steps_of_converter(health);
  return std::string("samples of the output left out") + (of_steps ? ": " : ", too few for a finding: ") + told(zeros, "at the low end where the force says otherwise") +
         (zeros > 0 && spikes > 0 ? ", " : "") + told(spikes, of_steps ? "that go back and forth between the same levels, as over a step of the converter" : "far off their neighbours") + " (" + where + ")";
}

}  // namespace forcegate::diagnose
