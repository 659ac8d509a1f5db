#pragma once
// Rate-independent hysteresis of many contacts that close and open at different forces: a Preisach plane with
// a smooth density, read through its Everett integral (Mayergoyz, Mathematical Models of Hysteresis, 1991,
// ch. 1).

#include <algorithm>
#include <cstddef>
#include <vector>

#include "hil/base/portable_math.h"

namespace forcegate::emulated {

/// E(alpha, beta): integral over the triangle beta <= b <= a <= alpha of the density
/// (w / w0 + 0.02)^shape exp(-w / w0) exp(-((m - crest) / 3 N)^2), w = (a - b) / 2, m = (a + b) / 2; scaled
/// so that E(6 N, 0) = 6 N. Bilinear between nodes 0.05 N apart; forces outside 0 to 6 N are clamped.
class Everett {
 public:
  static constexpr double kTop_N = 6.0;

  Everett(double width_N, double shape, double crest_N) : table_(kGrid * kGrid, 0.0) {
    const auto density = [&](double a, double b) {
      const double width = (a - b) / 2.0 / width_N, middle = ((a + b) / 2.0 - crest_N) / 3.0;
      return portable::pow(width + 0.02, shape) * portable::exp(-width) * portable::exp(-middle * middle);
    };
    for (std::size_t i = 1; i < kGrid; ++i)
      for (std::size_t j = i; j-- > 0;) {
        const double a = kCell_N * (static_cast<double>(i) - 0.5),
                     b = kCell_N * (static_cast<double>(j) + 0.5);
        const double cell = a > b ? density(a, b) : 0.5 * density(a + 0.2 * kCell_N, b);
        const double above = j + 1 < i ? at(i - 1, j) + at(i, j + 1) - at(i - 1, j + 1) : 0.0;
        table_[i * kGrid + j] = above + cell;
      }
    const double whole = at(kGrid - 1, 0);
    for (double& v : table_) v *= kTop_N / whole;
  }

  double operator()(double alpha, double beta) const {
    const double x = std::clamp(alpha / kCell_N, 0.0, kGrid - 1.001),
                 y = std::clamp(beta / kCell_N, 0.0, kGrid - 1.001);
    const auto i = static_cast<std::size_t>(x), j = static_cast<std::size_t>(y);
    const double u = x - static_cast<double>(i), v = y - static_cast<double>(j);
    return (1 - u) * ((1 - v) * at(i, j) + v * at(i, j + 1)) +
           u * ((1 - v) * at(i + 1, j) + v * at(i + 1, j + 1));
  }

 private:
  static constexpr std::size_t kGrid = 121;
  static constexpr double kCell_N = kTop_N / (kGrid - 1);
  double at(std::size_t i, std::size_t j) const { return table_[i * kGrid + j]; }
  std::vector<double> table_;
};

/// Memory of turning points with wiping-out, from the virgin state at 0 N.
class PreisachPlane {
 public:
  explicit PreisachPlane(const Everett& everett) : everett_(&everett) { turns_.push_back({0.0, 0.0}); }

  /// Loop alone, newtons: the branch less the middle between the outer branches at this force.
  double next(double force_N) {
    const Everett& E = *everett_;
    const double u = std::clamp(force_N, 0.0, Everett::kTop_N);
    if (u != before_) {
      if ((u > before_) != rising_) {
        rising_ = !rising_;
        turns_.push_back({before_, value_});
      }
      while (turns_.size() >= 3 &&
             (rising_ ? u >= turns_[turns_.size() - 2].u : u <= turns_[turns_.size() - 2].u))
        turns_.resize(turns_.size() - 2);
      const Turn& last = turns_.back();
      value_ = rising_ ? last.value + E(u, last.u) : last.value - E(last.u, u);
      before_ = u;
    }
    const double down = Everett::kTop_N - E(Everett::kTop_N, u);
    return value_ - 0.5 * (E(u, 0.0) + down);
  }

 private:
  struct Turn {
    double u, value;
  };
  const Everett* everett_;
  std::vector<Turn> turns_;
  double before_ = 0.0, value_ = 0.0;
  bool rising_ = true;
};

}  // namespace forcegate::emulated
