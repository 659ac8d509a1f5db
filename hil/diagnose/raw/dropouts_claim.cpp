#include "hil/diagnose/raw/dropouts_claim.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>

namespace forcegate::diagnose {

namespace {

constexpr std::size_t kFewestLong = 2;  // losses that are plain each

// A sample that is missing here and there is noted, and so is a logger that loses cells of every column; an output that goes missing again
// and again in most records, and plainly more than the reference does, loses samples.
std::optional<HealthClaim> claim_of_missing(const HealthTotals& totals) {
  constexpr std::size_t kFewestRuns = 10;
  constexpr double kMany = 0.01, kErrors = 3.0;
  const double more = totals.missing - totals.reference_missing, u_more = std::sqrt(totals.missing_variance);
  const bool plainly_more = more > kMany * totals.samples && more > kErrors * u_more;
  if (!plainly_more || totals.records_of_missing * 2 <= totals.records || totals.missing_runs < kFewestRuns) return std::nullopt;
  const std::string of_reference =
      totals.reference_missing > 0.0 ? ", " + totals.percent(totals.reference_missing) + " of the reference's alone" : "";
  return HealthClaim{"dropouts", 0.95,
                     totals.percent(totals.missing) + " of the samples of the output are missing while the reference goes on" + of_reference,
                     "share", "1", totals.share(more), totals.share(u_more)};
}

// The output cannot be at its low end there: a few are enough, and so are two losses of several samples or a long one.
bool are_plain_zeros(const HealthTotals& totals) {
  constexpr std::size_t kFewest = 5;
  constexpr double kLong = 3.0, kLongLoss = 20.0;  // samples
  const bool are_long = totals.zeros >= kLong * static_cast<double>(totals.zero_runs);
  const bool again = totals.records_of_zeros >= totals.several() && totals.zero_runs >= (are_long ? kFewestLong : kFewest);
  return !totals.lone_are_spikes && (again || totals.fallen >= kLongLoss);
}

// The output stands while the force goes through a tenth of its range, and then jumps to where it has been meanwhile; what does so for long,
// and farther, needs no second record.
bool are_plain_holds(const std::vector<RecordHealth>& health, const HealthTotals& totals, const HealthScales& scales) {
  constexpr double kFarOff = 0.05, kVeryFar = 0.1;  // of the range
  constexpr std::size_t kLasting = 16;
  std::size_t far = 0, records_of_far = 0, lasting = 0;
  for (const RecordHealth& h : health) {
    if (h.at_rail > 0) continue;
    const auto count = [&](std::size_t samples, double off) {
      return static_cast<std::size_t>(
          std::ranges::count_if(h.runs, [&](const HeldRun& run) { return run.samples >= samples && run.error_V > off * scales.U_range_V; }));
    };
    const std::size_t far_here = count(0, kFarOff);
    far += far_here;
    records_of_far += far_here > 0 ? 1 : 0;
    lasting += count(kLasting, kVeryFar);
  }
  return (far >= kFewestLong && records_of_far >= totals.several()) || lasting >= kFewestLong;
}

bool is_plain_silence(const HealthTotals& totals) {
  constexpr std::size_t kFewest = 4;
  return totals.silent_runs >= kFewest && totals.records_of_silent >= totals.several();
}

// No noise repeats itself: a few blocks are enough.
std::optional<HealthClaim> claim_of_repeated(const HealthTotals& totals) {
  constexpr std::size_t kFewest = 3;
  if (totals.repeated_blocks < kFewest || totals.records_of_repeated < totals.several()) return std::nullopt;
  return HealthClaim{"dropouts", 0.95,
                     totals.percent(totals.repeated) + " of the samples of the output are in blocks that were sent before, noise and all, while the reference goes on",
                     "share", "1", totals.share(totals.repeated), std::sqrt(totals.repeated) / totals.samples};
}

// A slow record does not show that its samples are held: one that does so again and again is enough. Nor does any hand hold the output that
// long at one code where its noise goes over the codes.
bool is_plainly_held(const RecordHealth& h) {
  constexpr double kMany = 0.005;
  constexpr std::size_t kManyRuns = 10, kLong = 100;
  if (h.at_rail > 0) return false;
  const bool again = static_cast<double>(h.held) > kMany * static_cast<double>(h.samples) && h.runs.size() >= kManyRuns;
  return again || (h.noise_U_V > h.lsb_U_V && std::ranges::any_of(h.runs, [](const HeldRun& run) { return run.samples >= kLong; }));
}

bool are_many(const std::vector<RecordHealth>& health, const HealthTotals& totals, double lost) {
  constexpr double kFewest = 20.0;
  constexpr std::size_t kSeveral = 2, kManyRecords = 3;
  return totals.share(lost) > kLeastShare && lost >= kFewest &&
         (totals.records_of_lost >= kSeveral || totals.records < kManyRecords || std::ranges::any_of(health, is_plainly_held));
}

}  // namespace

std::optional<HealthClaim> claim_of_dropouts(const std::vector<RecordHealth>& health, const HealthTotals& totals, const HealthScales& scales,
                                             bool holds_lose_nothing) {
  if (auto missing = claim_of_missing(totals)) return missing;
  if (auto repeated = claim_of_repeated(totals)) return repeated;
  const bool plain_silence = !holds_lose_nothing && is_plain_silence(totals);
  const bool plain_holds = !holds_lose_nothing && are_plain_holds(health, totals, scales);
  const double lost = totals.held + (plain_silence ? totals.silent : 0.0) + totals.zeros;
  if (!are_plain_zeros(totals) && !plain_holds && !plain_silence && !are_many(health, totals, lost)) return std::nullopt;
  return HealthClaim{"dropouts", 0.95,
                     totals.percent(lost) + " of the samples are held or zero where the force, or their own noise, says otherwise",
                     "share", "1", totals.share(lost), std::sqrt(lost) / totals.samples};
}

}  // namespace forcegate::diagnose
