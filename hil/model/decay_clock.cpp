#include "hil/model/decay_clock.h"

#include <algorithm>
#include <cmath>

namespace forcegate {

namespace {

// The first row after the start of the excitation; that of no row where nothing is known of the way.
std::size_t first_cycled_row(const RecordInput& record) {
  if (record.travel_N.size() != record.rows()) return record.rows();
  return static_cast<std::size_t>(std::ranges::upper_bound(record.t_s, record.onset_s) - record.t_s.begin());
}

}  // namespace

DecayClock::DecayClock(const RecordInput& record, double loading_share) : record_(&record), share_(loading_share) {
  if (!(loading_share > 0.0)) return;
  const std::size_t after = first_cycled_row(record);
  if (after >= record.rows()) return;
  from_N_ = record.travel_N[after > 0 ? after - 1 : 0];
  if (const double pace_N_per_s = 4.0 * record.A_N * record.f_Hz; pace_N_per_s > 0.0) seconds_per_N_ = 1.0 / pace_N_per_s;
}

double unevenness_of_loading(const RecordInput& record) {
  const std::size_t after = first_cycled_row(record);
  if (after >= record.rows()) return 0.0;
  const double from_N = record.travel_N[after > 0 ? after - 1 : 0], of_all_N = record.travel_N.back() - from_N, of_all_s = record.t_s.back() - record.onset_s;
  if (!(of_all_N > 0.0)) return 0.0;
  double farthest = 0.0;
  for (std::size_t i = after; i < record.rows(); ++i)
    farthest = std::max(farthest, std::abs((record.travel_N[i] - from_N) / of_all_N - (record.t_s[i] - record.onset_s) / of_all_s));
  return farthest;
}

}  // namespace forcegate
