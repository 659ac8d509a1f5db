#pragma once
// What real instruments said is recorded before its block is whole, so that a killed run loses little. The reference of the
// youngest rows may still be interpolated anew; they wait.

#include <cstddef>

namespace forcegate {

class SettledRows {
 public:
  explicit SettledRows(double rate_Hz = 1000.0)
      : unsettled_(static_cast<std::size_t>(kUnsettled_s * rate_Hz)),
        enough_(static_cast<std::size_t>(kSaved_s * rate_Hz)) {}

  /// First row of the block that is not recorded yet.
  std::size_t saved() const { return saved_; }
  /// Row before which the rows are to be recorded now that `rows` of the block are there; saved() when it can wait.
  std::size_t due(std::size_t rows) const {
    return rows < saved_ + enough_ + unsettled_ ? saved_ : rows - unsettled_;
  }
  void save_until(std::size_t end) { saved_ = end; }
  void next_block() { saved_ = 0; }

 private:
  static constexpr double kSaved_s = 0.2, kUnsettled_s = 0.1;
  std::size_t unsettled_, enough_, saved_ = 0;
};

}  // namespace forcegate
