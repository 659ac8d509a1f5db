#include "hil/diagnose/raw/outliers_claim.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace forcegate::diagnose {

namespace {

bool are_many(const HealthTotals& totals) {
  constexpr double kFewest = 12.0;
  constexpr std::size_t kSeveral = 2, kManyRecords = 3;
  return totals.share(totals.outliers) > kLeastShare && totals.outliers >= kFewest &&
         (totals.records_of_two_outliers >= kSeveral || totals.records < kManyRecords);
}

// A few are somebody's hand on the cable, unless they make an error that matters, again and again.
bool are_large(const HealthTotals& totals, const HealthScales& scales) {
  constexpr double kFewest = 5.0, kLargeError = 0.01;  // RMS, of the span
  constexpr std::size_t kRecords = 3;
  return totals.outliers >= kFewest && totals.records_of_outliers >= kRecords &&
         std::sqrt(totals.share(totals.outlier_square_V2)) > kLargeError * scales.U_range_V;
}

// One short recording has few, and no hand that comes back all along it.
bool come_all_along(const std::vector<RecordHealth>& health, const HealthTotals& totals) {
  constexpr double kOften = 1e-3, kSeveral = 7.0;
  constexpr std::size_t kAllAlong = 4;  // eighths
  return health.size() == 1 && totals.outliers >= kSeveral && totals.share(totals.outliers) > kOften &&
         health.front().outlier_parts >= kAllAlong;
}

}  // namespace

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

std::optional<HealthClaim> claim_of_outliers(const std::vector<RecordHealth>& health, const HealthTotals& totals, const HealthScales& scales) {
  if (!are_many(totals) && !are_large(totals, scales) && !come_all_along(health, totals)) return std::nullopt;
  return HealthClaim{"outliers", 0.95, totals.percent(totals.outliers) + " of the samples stand far off their neighbours while the force is smooth",
                     "share", "1", totals.share(totals.outliers), std::sqrt(totals.outliers) / totals.samples};
}

}  // namespace forcegate::diagnose
