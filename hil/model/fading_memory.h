#pragma once
// States on the way to the wanted rows. Filters of the full-rate force forget: only what a wanted row can still feel is stepped.

#include <algorithm>
#include <cstdint>

#include "hil/model/record_input.h"

namespace forcegate {

/// In time constants: e^-40 of the span is below the last bit of a double.
inline constexpr double kForgotten = 40.0;

/// First sample in [next, begin) that is still felt at `begin`, for a state that forgets in `memory_s`; the one before `begin` always is.
inline std::uint32_t first_felt(const RecordInput& record, double memory_s, std::uint32_t next, std::uint32_t begin) {
  if (begin <= next) return begin;
  const auto from = record.fast_t_s.begin();
  return static_cast<std::uint32_t>(std::lower_bound(from + next, from + begin - 1, record.fast_t_s[begin] - memory_s) - from);
}

/// Means of a filter's output over the wanted rows, in order: take(row, mean). felt(next, begin): where a state of which nothing is known
/// must start to be known at sample `begin`, at least `next`. start(k): settled on sample k. step(k): from sample k - 1 to k.
/// start and step return the output at k.
template <class Felt, class Start, class Step, class Take>
void filter_wanted_rows(const RecordInput& record, const Felt& felt, const Start& start, const Step& step, const Take& take) {
  std::uint32_t next = 0;  // first sample that the state has not seen
  double y = 0.0;
  record.for_each_wanted([&](std::size_t row) {
    const std::uint32_t begin = record.row_begin[row], end = record.row_begin[row + 1];
    const std::uint32_t first = felt(next, begin);
    if (next == 0 || first > next) {
      y = start(first);
      next = first + 1;
    }
    for (; next < begin; ++next) y = step(next);
    double sum = 0.0;
    if (next > begin) sum = y;  // it started there
    for (; next < end; ++next) sum += y = step(next);
    take(row, sum / static_cast<double>(end - begin));
  });
}

/// What forgets nothing: step(row) for every row up to the last wanted one, each wanted one's before take(row).
template <class Step, class Take>
void step_to_wanted_rows(const RecordInput& record, const Step& step, const Take& take) {
  std::size_t next = 0;
  record.for_each_wanted([&](std::size_t row) {
    for (; next <= row; ++next) step(next);
    take(row);
  });
}

}  // namespace forcegate
