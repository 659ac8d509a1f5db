#pragma once
// Lag of one signal behind another by least squares of y(t) = g x(t - lag) + o, linearised:
// y = g x - g lag x' + o, x' the central difference of neighbouring items. For lags well below the period of the motion;
// beyond, LagSearch looks where the two go together.

#include <array>
#include <cstddef>
#include <vector>

namespace forcegate {

class LagFit {
 public:
  LagFit() = default;
  explicit LagFit(double step_s) : step_s_(step_s) {}

  /// Items in order, step_s apart (means over a few samples). One that is not finite breaks the sequence.
  void push(double x, double y);

  /// lag_s: y behind x, u_lag_s its standard error from the residuals, which follow the cycles: about one independent
  /// item a second. NaN below 100 items or when x hardly moves (variance <= 0.01) or y does not follow it (g <= 0.05).
  void finish(double& lag_s, double& u_lag_s) const;

 private:
  double step_s_ = 0.01;
  double x_[3] = {}, y_[3] = {};
  int history_ = 0;
  double n_ = 0, sx_ = 0, sd_ = 0, sy_ = 0, sxx_ = 0, sdd_ = 0, sxd_ = 0, sxy_ = 0, sdy_ = 0, syy_ = 0;
};

/// A lag of one signal behind another that is too long for LagFit (a quarter of a period and more), by their correlation: to two
/// items, up to 120 of them either way.
class LagSearch {
 public:
  LagSearch() = default;
  explicit LagSearch(double step_s) : step_s_(step_s) {}

  /// As LagFit::push.
  void push(double x, double y);

  /// y behind x, s: median over stretches of 1000 items, for the gain of a film under overload falls tenfold in a record. In each
  /// the nearest place where both go together; none where they do so nowhere (correlation < 0.7) or hardly better than as they
  /// stand (by less than 0.2), and where x hardly moves (variance <= 0.01). NaN where less than half of the stretches have one. (A
  /// loop that swings through the converter's rails leaves 0.85 to 0.93 of codes that are only late.)
  double finish() const;

 private:
  void close();
  static constexpr std::size_t kMost = 60, kEach = 2;
  static constexpr double kStretch = 500;
  double step_s_ = 0.01;
  double sum_x_ = 0.0, sum_y_ = 0.0;
  std::size_t filled_ = 0, history_ = 0, at_ = 0;
  std::array<double, 2 * (kMost + 1)> x_{}, y_{};  ///< every item twice: the last ones stand in a row, newest first
  std::array<double, kMost + 1> behind_{}, ahead_{};
  double n_ = 0, sx_ = 0, sy_ = 0, sxx_ = 0, syy_ = 0;
  std::size_t stretches_ = 0;  ///< in which x moves
  std::vector<double> lags_s_;
};

}  // namespace forcegate
