#include "hil/diagnose/raw/health_claims.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>

#include "hil/diagnose/raw/adc_codes_claim.h"
#include "hil/diagnose/raw/dropouts_claim.h"
#include "hil/diagnose/raw/health_totals.h"
#include "hil/diagnose/raw/held_codes.h"
#include "hil/diagnose/raw/hum_claim.h"
#include "hil/diagnose/raw/outliers_claim.h"
#include "hil/diagnose/raw/reference_noise_claim.h"
#include "hil/diagnose/raw/sent_on_change.h"

namespace forcegate::diagnose {

namespace {

// Where samples are held again and again, one run is held at the highest value too. A rail is one value, and met more than once.
bool is_held_at_top(const std::vector<RecordHealth>& health, const HealthTotals& totals) {
  constexpr double kSameOfSteps = 1.5;
  const RecordHealth* highest = nullptr;
  for (const RecordHealth& h : health)
    if (h.at_rail > 0 && (highest == nullptr || h.rail_V > highest->rail_V)) highest = &h;
  if (highest == nullptr || totals.held < static_cast<double>(highest->at_rail)) return false;
  std::ptrdiff_t met = 0;
  for (const RecordHealth& h : health)
    if (h.at_rail > 0)
      met += std::ranges::count_if(h.runs, [&](const HeldRun& run) { return std::abs(run.value_V - highest->rail_V) <= kSameOfSteps * highest->lsb_U_V + 1e-12; });
  return met < 2;
}

std::optional<HealthClaim> claim_of_clipping(const HealthTotals& totals, const HealthScales& scales) {
  constexpr double kLeast = 1e-3;
  if (!(totals.share(totals.at_rail) > kLeast)) return std::nullopt;
  return HealthClaim{"clipping", 0.95, "the output stays at exactly one value at its top while the force moves on",
                     "rail_V", scales.unit, totals.rail_V, scales.U_range_V * 1e-4};
}

}  // namespace

std::vector<HealthClaim> health_claims(const std::vector<RecordHealth>& health, const HealthScales& scales, const BenchFacts& bench) {
  HealthTotals totals = health_totals(health);
  if (totals.samples < 1.0) return {};
  std::vector<HealthClaim> out;
  const auto add = [&](std::optional<HealthClaim> claim) {
    if (claim) out.push_back(std::move(*claim));
  };
  const HeldCodes codes = find_held_codes(health, scales);
  if (are_steps_of_converter(health)) totals.outliers = 0.0;
  if (codes.found) totals.held -= std::min(totals.held, codes.samples);
  if (auto held_codes = claim_of_held_codes(codes, totals, scales)) {
    out.push_back(std::move(*held_codes));
    // a sample on the other side of a gap stands off its neighbours too
    totals.at_rail = totals.outliers = totals.bit_errors = 0.0;
  }
  const bool sends_changes = step_of_sent_changes(health).has_value();
  if (sends_changes) totals.held = totals.at_rail = 0.0;  // the highest value is held as the others are
  add(claim_of_bit_errors(totals, scales));
  add(claim_of_outliers(health, totals, scales));
  std::optional<HealthClaim> dropouts = claim_of_dropouts(health, totals, scales, codes.found || sends_changes);
  const bool held_at_top = dropouts && is_held_at_top(health, totals);
  add(std::move(dropouts));
  if (!held_at_top) add(claim_of_clipping(totals, scales));
  add(claim_of_hum(health, scales));
  add(claim_of_reference_noise(health, scales, bench));
  return out;
}

std::string note_of_left_out(const std::vector<RecordHealth>& health, const std::vector<HealthClaim>& claims) {
  const auto claimed = [&](const char* effect) { return std::ranges::find(claims, effect, &HealthClaim::effect) != claims.end(); };
  const bool dropouts = claimed("dropouts"), outliers = claimed("outliers");
  constexpr std::size_t kNamed = 4;
  std::size_t zeros = 0, spikes = 0, repeated = 0, records = 0;
  std::string where;
  for (const RecordHealth& h : health) {
    const std::size_t own_zeros = dropouts ? 0 : h.zeros + (outliers ? 0 : h.lone_zeros), own_spikes = outliers ? 0 : h.outliers,
                      own_repeated = dropouts ? 0 : h.repeated;
    zeros += own_zeros;
    spikes += own_spikes;
    repeated += own_repeated;
    if (own_zeros + own_spikes + own_repeated > 0 && ++records <= kNamed) where += (where.empty() ? "" : ", ") + h.record;
  }
  if (records > kNamed) where += " and " + std::to_string(records - kNamed) + " more";
  if (zeros + spikes + repeated == 0) return {};
  const bool of_steps = are_steps_of_converter(health);
  std::string what;
  const auto add = [&](std::size_t samples, const char* which) {
    if (samples > 0) what += (what.empty() ? "" : ", ") + std::to_string(samples) + which;
  };
  add(zeros, " at the low end where the force says otherwise");
  add(repeated, " in blocks that were sent before");
  add(spikes, of_steps ? " that go back and forth between the same levels, as over a step of the converter" : " far off their neighbours");
  return std::string("samples of the output left out") + (of_steps ? ": " : ", too few for a finding: ") + what + " (" + where + ")";
}

std::string note_of_hum_taken_off(const std::vector<RecordHealth>& health, const HealthScales& scales, const std::vector<HealthClaim>& claims) {
  constexpr std::size_t kNamed = 4;
  if (std::ranges::find(claims, "hum", &HealthClaim::effect) != claims.end()) return {};
  std::string where;
  std::size_t records = 0;
  for (const RecordHealth& h : health)
    if (shows_hum(h, scales) && ++records <= kNamed)
      where += fmt::format("{}{:.2g} {} at {:.3g} Hz of {}", where.empty() ? "" : ", ", h.hum_V, scales.unit, h.hum_Hz, h.record);
  if (records == 0) return {};
  if (records > kNamed) where += fmt::format(" and of {} more", records - kNamed);
  return "hum taken off the output, in too few records for a finding: " + where;
}

std::string note_of_claims(const std::vector<HealthClaim>& claims) {
  std::string out;
  for (const HealthClaim& c : claims) out += (out.empty() ? "taken out of the samples before any fit, see diagnose: " : "; ") + c.effect + " (" + c.evidence + ")";
  return out;
}

}  // namespace forcegate::diagnose
