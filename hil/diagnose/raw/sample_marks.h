#pragma once
// Why no fit may use which samples of a record, and by how much these mislead.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "hil/diagnose/raw/floor_by_force.h"
#include "hil/diagnose/raw/raw_health.h"
#include "hil/diagnose/raw/record_scales.h"

namespace forcegate::diagnose {

class SampleMarks {
 public:
  /// Both must outlive it.
  SampleMarks(const ForceAndOutput& samples, const RecordScales& scales) : samples_(samples), scales_(scales), why_(samples.size(), 0) {}

  /// A later mark takes the place of an earlier one, whose error stays. Nothing is marked as a zero where the force says that the low end of the
  /// output belongs (floor_by_force.h). `error_V`: of either sign, at most the span that the output can have.
  void mark(std::size_t i, BadSample why, double error_V);

  BadSample at(std::size_t i) const { return static_cast<BadSample>(why_[i]); }
  std::size_t size() const { return why_.size(); }
  /// What the marked samples add to the mean squared error of the record.
  double mean_square_V2() const { return square_V2_ / static_cast<double>(why_.size()); }
  /// BadSample of every sample.
  const std::vector<std::uint8_t>& all() const { return why_; }

 private:
  bool belongs_at_floor(std::size_t i);

  const ForceAndOutput& samples_;
  const RecordScales& scales_;
  std::vector<std::uint8_t> why_;
  double square_V2_ = 0.0;
  std::optional<FloorByForce> floor_;  // sorts all samples: not before it is asked for
};

}  // namespace forcegate::diagnose
