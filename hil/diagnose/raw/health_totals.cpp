#include "hil/diagnose/raw/health_totals.h"

#include "hil/base/plain_number.h"

namespace forcegate::diagnose {

namespace {

bool are_lone_spikes(const std::vector<RecordHealth>& health) {
  constexpr std::size_t kFewestSpikes = 12;
  std::size_t spikes = 0;
  for (const RecordHealth& h : health) spikes += h.outliers;
  return spikes >= kFewestSpikes;
}

}  // namespace

std::string HealthTotals::percent(double some) const { return plain_number(100.0 * share(some)) + " %"; }

HealthTotals health_totals(const std::vector<RecordHealth>& health) {
  constexpr std::size_t kFewestLost = 4;
  HealthTotals out{.records = health.size(), .lone_are_spikes = are_lone_spikes(health)};
  for (const RecordHealth& h : health) {
    const std::size_t lone_outliers = out.lone_are_spikes ? h.lone_zeros : 0, lone_losses = h.lone_zeros - lone_outliers;
    out.samples += static_cast<double>(h.samples);

    out.outliers += static_cast<double>(h.outliers + lone_outliers);
    out.outlier_square_V2 += h.outlier_square_V2;
    out.records_of_outliers += h.outliers > 0 ? 1 : 0;
    out.records_of_two_outliers += h.outliers >= 2 ? 1 : 0;

    out.bit_errors += static_cast<double>(h.bit_errors);
    if (h.bit_errors > 0) out.bit_V.push_back(h.bit_V);

    out.missing += static_cast<double>(h.missing);
    out.missing_variance += h.missing_variance;
    out.reference_missing += static_cast<double>(h.reference_missing);
    out.missing_runs += h.missing_runs;
    out.records_of_missing += h.missing_runs > 0 ? 1 : 0;

    out.held += static_cast<double>(h.held);
    out.silent += static_cast<double>(h.silent);
    out.silent_runs += h.silent_runs;
    out.records_of_silent += h.silent_runs > 0 ? 1 : 0;
    out.repeated += static_cast<double>(h.repeated);
    out.repeated_blocks += h.repeated_blocks;
    out.records_of_repeated += h.repeated_blocks > 0 ? 1 : 0;
    out.zeros += static_cast<double>(h.zeros + lone_losses);
    out.fallen += h.zero_runs > 0 ? static_cast<double>(h.zeros) : 0.0;
    out.zero_runs += h.zero_runs;
    out.records_of_zeros += h.zero_runs > 0 ? 1 : 0;
    out.records_of_lost += h.held + h.zeros + lone_losses >= kFewestLost ? 1 : 0;

    out.at_rail += static_cast<double>(h.at_rail);
    if (h.at_rail > 0) out.rail_V = h.rail_V;
  }
  return out;
}

}  // namespace forcegate::diagnose
