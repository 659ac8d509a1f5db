#pragma once
// What the decay of a cycled record runs with. Eq. (3) of Lebosse 2011 has a rate that grows with the frequency: a part of the decay goes with the
// cycles and not with the time. Under even cycling nobody can tell; of a load that pauses or changes its pace both follow another course.

#include <cstddef>

#include "hil/model/record_input.h"

namespace forcegate {

/// s = (1 - p) t + p X/(4 A f), seconds: t since the start of the excitation, X the loading done since then (sum |dF|, RecordInput::travel_N), which is
/// 4 A f in each second of even cycling, p the share that goes with it, 0 to 1. Before the start, and of a record without a swing or a frequency, s = t.
class DecayClock {
 public:
  DecayClock(const RecordInput& record, double loading_share);
  double operator()(std::size_t row) const {
    const double since_s = record_->t_s[row] - record_->onset_s;
    return seconds_per_N_ > 0.0 && since_s > 0.0 ? (1.0 - share_) * since_s + share_ * seconds_per_N_ * (record_->travel_N[row] - from_N_) : since_s;
  }

 private:
  const RecordInput* record_;
  double share_, from_N_ = 0.0, seconds_per_N_ = 0.0;
};

/// The farthest that the loading done is before or behind the time, each as a share of what it is at the end of the record: 0 under even cycling.
double unevenness_of_loading(const RecordInput& record);

}  // namespace forcegate
