#include "hil/trace/decimate.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace forcegate {

M4Accumulator::M4Accumulator(std::size_t columns, double first_s, double last_s, std::size_t channels,
                             std::vector<std::size_t> watched)
    : first_s_(first_s),
      last_s_(last_s),
      per_second_(last_s > first_s ? static_cast<double>(columns) / (last_s - first_s) : 0.0),
      columns_(std::max<std::size_t>(1, columns)),
      channels_(channels),
      watched_(std::move(watched)),
      extremes_(watched_.size()) {
  for (Extremes& e : extremes_) e.low.value.resize(channels), e.high.value.resize(channels);
  first_.value.resize(channels);
  latest_.value.resize(channels);
}

void M4Accumulator::store(Row& row, double t_s, std::size_t i, std::span<const float* const> channel) const {
  row.t_s = t_s;
  row.number = count_;
  for (std::size_t k = 0; k < channels_; ++k) row.value[k] = channel[k][i];
}

void M4Accumulator::push(std::span<const double> t_s, std::span<const float* const> channel) {
  assert(channel.size() == channels_);
  const double last_column = static_cast<double>(columns_ - 1);
  for (std::size_t i = 0; i < t_s.size(); ++i) {
    const double x = std::clamp((t_s[i] - first_s_) * per_second_, 0.0, last_column);
    const auto column = static_cast<std::size_t>(x);
    if (open_ && column != column_) close_column();
    if (!open_) {
      open_ = true;
      column_ = column;
      store(first_, t_s[i], i, channel);
      for (Extremes& e : extremes_) e.any = false;
    }
    for (std::size_t w = 0; w < watched_.size(); ++w) {
      Extremes& e = extremes_[w];
      const float v = channel[watched_[w]][i];
      if (std::isnan(v)) continue;
      if (!e.any || v < e.low.value[watched_[w]]) store(e.low, t_s[i], i, channel);
      if (!e.any || v > e.high.value[watched_[w]]) store(e.high, t_s[i], i, channel);
      e.any = true;
    }
    // the last row of the column is known only afterwards; a block's last row is stored at its end
    const bool ends =
        i + 1 == t_s.size() || static_cast<std::size_t>(std::clamp((t_s[i + 1] - first_s_) * per_second_, 0.0,
                                                                   last_column)) != column_;
    if (ends) store(latest_, t_s[i], i, channel);
    ++count_;
  }
}

void M4Accumulator::close_column() {
  std::vector<const Row*> rows{&first_, &latest_};
  for (const Extremes& e : extremes_)
    if (e.any) rows.push_back(&e.low), rows.push_back(&e.high);
  std::sort(rows.begin(), rows.end(), [](const Row* a, const Row* b) { return a->number < b->number; });
  for (std::size_t k = 0; k < rows.size(); ++k)
    if (k == 0 || rows[k]->number != rows[k - 1]->number) kept_.push_back(*rows[k]);
  open_ = false;
}

DecimatedRows M4Accumulator::rows() const {
  M4Accumulator finished = *this;
  if (finished.open_) finished.close_column();
  DecimatedRows out;
  out.value.resize(channels_);
  for (const Row& row : finished.kept_) {
    out.t_s.push_back(static_cast<float>(row.t_s));
    for (std::size_t k = 0; k < channels_; ++k) out.value[k].push_back(row.value[k]);
  }
  return out;
}

}  // namespace forcegate
