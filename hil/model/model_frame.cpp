#include "hil/model/model_frame.h"

#include <cmath>

namespace forcegate {

namespace {

double mean_of(const CampaignInput& c, std::vector<double> RecordInput::*channel) {
  double sum = 0.0, n = 0.0;
  for (const RecordInput& r : c.records)
    for (const double x : r.*channel) {
      sum += x;
      n += 1.0;
    }
  return n > 0.0 ? sum / n : kMissing;
}

double mean_drive_V(const CampaignInput& c) {
  double sum = 0.0, n = 0.0;
  for (const RecordInput& r : c.records)
    if (std::isfinite(r.drive_mean_V)) {
      sum += r.drive_mean_V;
      n += 1.0;
    }
  return n > 0.0 ? sum / n : kMissing;
}

double known_or(double value, double otherwise) { return std::isfinite(value) ? value : otherwise; }

}  // namespace

ModelFrame frame_of(const CampaignInput& c) {
  return {c.range_N, c.lowest_N, mean_of(c, &RecordInput::temp_C), mean_of(c, &RecordInput::humidity), mean_drive_V(c), c.travel_total_N};
}

CampaignInFrame::CampaignInFrame(const ModelFrame& frame, CampaignInput campaign) : input_(std::move(campaign)) {
  input_.range_N = frame.span_N;
  if (std::isfinite(frame.lowest_N)) input_.lowest_N = frame.lowest_N;
  if (std::isfinite(frame.travel_N)) input_.travel_total_N = frame.travel_N;
  input_.reference_temp_C = frame.temperature_C;
  input_.reference_humidity_pct = frame.humidity_pct;
  input_.reference_drive_V = frame.drive_V;
}

double reference_temperature_C(const CampaignInput& c) {
  return std::isfinite(c.reference_temp_C) ? c.reference_temp_C : known_or(mean_of(c, &RecordInput::temp_C), 0.0);
}
double reference_humidity_pct(const CampaignInput& c) {
  return std::isfinite(c.reference_humidity_pct) ? c.reference_humidity_pct : known_or(mean_of(c, &RecordInput::humidity), 0.0);
}
double reference_drive_V(const CampaignInput& c) {
  return std::isfinite(c.reference_drive_V) ? c.reference_drive_V : known_or(mean_drive_V(c), 1.0);
}

void hold_references_of_air(CampaignInput& c) {
  c.reference_temp_C = reference_temperature_C(c);
  c.reference_humidity_pct = reference_humidity_pct(c);
}

}  // namespace forcegate
