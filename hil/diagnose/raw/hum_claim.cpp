#include "hil/diagnose/raw/hum_claim.h"

#include <algorithm>

#include <fmt/format.h>

#include "hil/base/quantile.h"
#include "hil/diagnose/raw/mains_line.h"

namespace forcegate::diagnose {

namespace {

bool shows_one_of(const RecordHealth& h, const HealthScales& scales, const LinesOfHum& lines) {
  return shows_hum(h, scales) && (may_be_of_mains(h.hum_Hz, lines.first_Hz, h.rate_Hz) || may_be_of_mains(h.hum_Hz, lines.second_Hz, h.rate_Hz));
}

bool can_show_one_of(const RecordHealth& h, const LinesOfHum& lines) {
  return h.hum_ratio > 0.0 && (can_show_mains(lines.first_Hz, h.rate_Hz) || can_show_mains(lines.second_Hz, h.rate_Hz));
}

}  // namespace

bool shows_hum(const RecordHealth& h, const HealthScales& scales) {
  constexpr double kMatters = 4e-4;  // of the range
  return h.hum_ratio > kPlainLine && h.hum_V > kMatters * scales.U_range_V;
}

RecordsOfHum records_of_hum(const std::vector<RecordHealth>& health, const HealthScales& scales, const LinesOfHum& lines) {
  RecordsOfHum out;
  for (const RecordHealth& h : health) {
    out.show += shows_one_of(h, scales, lines) ? 1 : 0;
    out.can_show += can_show_one_of(h, lines) ? 1 : 0;
  }
  return out;
}

bool is_hum(const RecordsOfHum& records) {
  constexpr std::size_t kSeveral = 2;
  return records.show > 0 && records.show >= std::min(kSeveral, records.can_show) && 2 * records.show >= records.can_show;
}

std::optional<HealthClaim> claim_of_hum(const std::vector<RecordHealth>& health, const HealthScales& scales) {
  // a supply shows the mains in one record and their rectifier in another
  for (const LinesOfHum& lines : {LinesOfHum{50.0, 50.0}, {60.0, 60.0}, {100.0, 100.0}, {120.0, 120.0}, {50.0, 100.0}, {60.0, 120.0}}) {
    if (!is_hum(records_of_hum(health, scales, lines))) continue;
    std::vector<double> amplitude_V, line_Hz;
    for (const RecordHealth& h : health)
      if (shows_one_of(h, scales, lines)) {
        amplitude_V.push_back(h.hum_V);
        line_Hz.push_back(h.hum_Hz);
      }
    const double middle_V = quantile(amplitude_V, 0.5);
    return HealthClaim{"hum", 0.95, fmt::format("a line at {:.4g} Hz stands in the output and not in the force", quantile(line_Hz, 0.5)),
                       "amplitude_V", scales.unit, middle_V, 0.1 * middle_V};
  }
  return std::nullopt;
}

}  // namespace forcegate::diagnose
