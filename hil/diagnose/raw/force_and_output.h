#pragma once
// Force and output of a record, sample by sample, and how they vary together.

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "hil/trace/trace.h"

namespace forcegate::diagnose {

/// Both are as long as their clock: what a channel lacks at its end is missing. Looks at the trace, which must outlive it.
class ForceAndOutput {
 public:
  /// Nothing where the trace lacks one of the two.
  static std::optional<ForceAndOutput> of(const Trace& trace);

  std::size_t size() const { return clock_->t_s.size(); }
  const TimeBase& clock() const { return *clock_; }
  const std::vector<double>& t_s() const { return clock_->t_s; }
  const std::vector<double>& F_N() const { return padded_F_N_ ? *padded_F_N_ : force_->value; }
  const std::vector<double>& U_V() const { return padded_U_V_ ? *padded_U_V_ : output_->value; }

 private:
  ForceAndOutput(const TimeBase& clock, const Channel& force, const Channel& output);

  const TimeBase* clock_;
  const Channel *force_, *output_;
  std::optional<std::vector<double>> padded_F_N_, padded_U_V_;  // only where a channel is not as long as the clock
};

/// Sums of squares and products of both about their means, over the samples that both have.
struct JointSquares {
  double n = 0.0, FF = 0.0, FU = 0.0, UU = 0.0;
  /// Least squares of U on F, V/N; nothing where the force stands still.
  std::optional<double> gain_V_per_N() const { return FF > 0.0 ? std::optional(FU / FF) : std::nullopt; }
};
JointSquares joint_squares(std::span<const double> F_N, std::span<const double> U_V);

}  // namespace forcegate::diagnose
