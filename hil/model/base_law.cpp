#include "hil/model/base_law.h"

#include <cmath>

#include "hil/model/decay_clock.h"

namespace forcegate {

double decay_factor(double since_s, double b_per_s, double q) {
  return since_s <= 0.0 ? 1.0 : (std::exp(-b_per_s * since_s) + q) / (1.0 + q);
}

void set_decay(RecordInput& record, const BaseLaw& law, double log_b_shift, double log_q_shift) {
  record.decay.assign(record.rows(), 1.0);
  if (!record.dynamic || !law.decays) return;
  const double b = law.decay_rate_per_s(record.f_Hz) * std::exp(log_b_shift);
  const double q = law.depth_ratio(record.A_N) * std::exp(log_q_shift);
  const DecayClock clock(record, law.loading_share);
  for (std::size_t i = 0; i < record.rows(); ++i) record.decay[i] = decay_factor(clock(i), b, q);
}

std::vector<double> base_output_V(const RecordInput& record, const BaseLaw& law) {
  std::vector<double> out(record.rows());
  for (std::size_t i = 0; i < record.rows(); ++i)
    out[i] = (record.base_force_N(i) - law.offset_N) / law.gain_N_per_V;
  return out;
}

}  // namespace forcegate
