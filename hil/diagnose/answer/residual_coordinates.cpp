#include "hil/diagnose/answer/residual_coordinates.h"

#include <cmath>
#include <numbers>

#include "hil/base/parallel.h"
#include "hil/diagnose/answer/force_turns.h"
#include "hil/model/rows.h"

namespace forcegate::diagnose {

namespace {

std::vector<LastTurn> last_turns(const RecordInput& r, double prominence) {
  std::vector<LastTurn> out;
  out.reserve(r.rows());
  LastTurn last{r.F_N[0], r.t_s[0]};
  for (const ForceTurn& turn : force_turns(r.F_N, prominence)) {
    out.resize(turn.seen_at, last);
    last = {r.F_N[turn.row], r.t_s[turn.row]};
  }
  out.resize(r.rows(), last);
  return out;
}

double force_while(const MappedRow& r, double direction) {
  return direction * r.record.rate_N_per_s[r.i] > 0.0 ? r.record.F_N[r.i] : kMissing;
}

}  // namespace

ResidualCoordinate wheel_angle() {
  return {"angle", "angle", "rad", [](const MappedRow& r) {
            return r.record.theta_rad.empty() ? kMissing : std::remainder(r.record.theta_rad[r.i], 2.0 * std::numbers::pi);
          }};
}

std::vector<ResidualCoordinate> residual_coordinates(const Workspace& w) {
  std::vector<ResidualCoordinate> out = {
      {"force", "force", "N", [](const MappedRow& r) { return r.record.F_N[r.i]; }},
      {"force while loading", "history", "N", [](const MappedRow& r) { return force_while(r, 1.0); }},
      {"force while unloading", "history", "N", [](const MappedRow& r) { return force_while(r, -1.0); }},
      {"rate", "rate", "N/s", [](const MappedRow& r) { return r.record.rate_N_per_s[r.i]; }},
      {"size of the rate", "rate", "N/s", [](const MappedRow& r) { return std::abs(r.record.rate_N_per_s[r.i]); }},
      {"last turning point", "history", "N", [](const MappedRow& r) { return r.turn.force_N; }},
      {"time since the last turn", "history", kLogOfTime,
       [](const MappedRow& r) { return std::log10(1.0 + r.record.t_s[r.i] - r.turn.time_s); }},
      {"time in the record", "time", "s", [](const MappedRow& r) { return r.record.t_s[r.i]; }},
      {"campaign time", "time", "s", [](const MappedRow& r) { return r.record.start_s + r.record.t_s[r.i]; }},
      {"load done", "history", "N", [](const MappedRow& r) { return r.record.travel_before_N + r.record.travel_N[r.i]; }},
      {"output", "force", w.output.unit.c_str(), [](const MappedRow& r) { return r.record.U_V[r.i]; }},
      {"cycle frequency", "frequency", "Hz", [](const MappedRow& r) { return r.record.dynamic ? r.record.f_Hz : kMissing; }}};
  if (w.input.has_temp)
    out.push_back({"temperature", "temperature", "degC",
                   [](const MappedRow& r) { return r.record.temp_C.empty() ? kMissing : r.record.temp_C[r.i]; }});
  if (w.input.has_theta) out.push_back(wheel_angle());
  if (w.input.has_drive)
    out.push_back({"drive", "drive", "V", [](const MappedRow& r) { return r.record.drive_mean_V; }});
  return out;
}

std::vector<std::vector<MappedRow>> mapped_rows(const Workspace& w, const ResidualChannel& channel, unsigned threads) {
  constexpr double kProminence = 0.05;  // of the force range
  std::vector<std::vector<MappedRow>> out(channel.record_of.size());
  parallel_for(out.size(), threads, [&](std::size_t k) {
    const RecordInput& record = w.input.records[channel.record_of[k]];
    const std::vector<LastTurn> turns = last_turns(record, kProminence * w.input.range_N);
    out[k].reserve(channel.rows[k].row.size());
    for (const std::size_t i : channel.rows[k].row) out[k].push_back({record, i, turns[i]});
  });
  return out;
}

}  // namespace forcegate::diagnose
