#pragma once
// Ticks at round numbers (1, 2 or 5 times a power of ten) and their labels.

#include <string>
#include <vector>

namespace forcegate::figures {

struct Tick {
  double value = 0.0;
  std::string label;  ///< "" for a minor tick
};

/// At most about `target` ticks inside [low, high], low < high; all labels have the same number of decimals.
std::vector<Tick> linear_ticks(double low, double high, int target);

/// Decades of [low, high], 0 < low < high, labelled; 2 and 5 (labelled when there are fewer than two decades)
/// between them; at least two labels, of whatever round numbers lie in the range. Labels "0.01 ... 1000", "10⁴" and beyond as powers.
std::vector<Tick> logarithmic_ticks(double low, double high, int target);

/// Zero and decades of either sign beyond `linear_within`, of [low, high] on a symmetric_log axis; at most about `target` labels.
std::vector<Tick> symmetric_log_ticks(double low, double high, double linear_within, int target);

}  // namespace forcegate::figures
