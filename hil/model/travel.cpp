#include "hil/model/travel.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "hil/base/quantile.h"

namespace forcegate {
namespace {

// Of second differences: a force that moves steadily has none.
double noise_of_row_N(const RecordInput& r) {
  constexpr double kOfMedian = 0.6745, kOfDifference = 2.449489742783178;  // of a normal deviate; sqrt 6
  std::vector<double> bent_N;
  for (std::size_t i = 1; i + 1 < r.rows(); ++i)
    if (r.ok[i - 1] != 0 && r.ok[i] != 0 && r.ok[i + 1] != 0) bent_N.push_back(std::abs(r.F_N[i - 1] - 2.0 * r.F_N[i] + r.F_N[i + 1]));
  return bent_N.empty() ? std::numeric_limits<double>::infinity() : quantile(std::move(bent_N), 0.5) / (kOfMedian * kOfDifference);
}

// Follows a force from turn to turn.
class Way {
 public:
  Way(double start_N, double least_turn_N) : turn_N_(start_N), low_N_(start_N), high_N_(start_N), least_N_(least_turn_N) {}

  double step(double F_N) {
    low_N_ = std::min(low_N_, F_N);
    high_N_ = std::max(high_N_, F_N);
    if (direction_ >= 0 && high_N_ - F_N > least_N_) turn_at(high_N_, F_N, -1);
    else if (direction_ <= 0 && F_N - low_N_ > least_N_) turn_at(low_N_, F_N, 1);
    return done_N_ + (direction_ > 0 ? high_N_ - turn_N_ : direction_ < 0 ? turn_N_ - low_N_ : 0.0);
  }

 private:
  void turn_at(double extreme_N, double F_N, int direction) {
    if (direction_ != 0) done_N_ += std::abs(extreme_N - turn_N_);
    turn_N_ = extreme_N;
    low_N_ = high_N_ = F_N;
    (direction > 0 ? low_N_ : high_N_) = extreme_N;
    direction_ = direction;
  }

  int direction_ = 0;  // 0: has not moved yet
  double turn_N_, low_N_, high_N_, done_N_ = 0.0, least_N_;
};

// Returns that of the whole record.
double set_travel(RecordInput& r, double least_N) {
  r.travel_N.assign(r.rows(), 0.0);
  if (r.rows() == 0) return 0.0;
  Way way(r.F_N[0], least_N);
  for (std::size_t i = 0; i < r.rows(); ++i) r.travel_N[i] = way.step(r.F_N[i]);
  return r.travel_N.back();
}

// To and fro by what the cycled records swing, else by the span.
double travel_of_cycle_N(const CampaignInput& campaign) {
  std::vector<double> swings_N;
  for (const RecordInput& r : campaign.records)
    if (r.dynamic && r.A_N > 0.0) swings_N.push_back(2.0 * r.A_N);
  return 2.0 * (swings_N.empty() ? campaign.range_N : quantile(swings_N, 0.5));
}

}  // namespace

double least_turn_N(const CampaignInput& campaign) {
  constexpr double kOfNoise = 10.0, kOfSpan = 0.005;
  double noise_N = std::numeric_limits<double>::infinity();
  for (const RecordInput& r : campaign.records) noise_N = std::min(noise_N, noise_of_row_N(r));
  return std::max(kOfSpan * campaign.range_N, std::isfinite(noise_N) ? kOfNoise * noise_N : 0.0);
}

void add_up_travel(CampaignInput& campaign) {
  const double cycle_N = travel_of_cycle_N(campaign), least_N = least_turn_N(campaign);
  double travel_N = 0.0;
  for (RecordInput& r : campaign.records) {
    travel_N += r.cycles_before * cycle_N;
    r.travel_before_N = travel_N;
    travel_N += set_travel(r, least_N);
  }
  campaign.travel_total_N = std::max(travel_N, 1e-9);
}

}  // namespace forcegate
