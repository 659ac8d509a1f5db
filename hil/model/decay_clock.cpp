#include "hil/model/decay_clock.h"

#include <algorithm>
#include <cmath>

namespace forcegate {

DecayClock::DecayClock(const RecordInput& record, double loading_share) : record_(&record), share_(loading_share) {
  if (!(loading_share > 0.0) || record.rows() == 0 || record.travel_N.size() != record.rows()) return;
  const auto after = static_cast<std::size_t>(std::ranges::upper_bound(record.t_s, record.onset_s) - record.t_s.begin());
  if (after >= record.rows()) return;
  from_N_ = record.travel_N[after > 0 ? after - 1 : 0];
  const double loading_N = record.travel_N.back() - from_N_;
  if (loading_N > 0.0) seconds_per_N_ = (record.t_s.back() - record.onset_s) / loading_N;
}

double DecayClock::unevenness() const {
  if (!(seconds_per_N_ > 0.0)) return 0.0;
  double farthest_s = 0.0;
  for (std::size_t i = 0; i < record_->rows(); ++i)
    if (const double since_s = record_->t_s[i] - record_->onset_s; since_s > 0.0)
      farthest_s = std::max(farthest_s, std::abs(seconds_per_N_ * (record_->travel_N[i] - from_N_) - since_s));
  return farthest_s / (record_->t_s.back() - record_->onset_s);
}

}  // namespace forcegate
