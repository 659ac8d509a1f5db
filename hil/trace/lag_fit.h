#pragma once
// Lag of one signal behind another by least squares of y(t) = g x(t - lag) + o, linearised:
// y = g x - g lag x' + o, x' the central difference of neighbouring items. For lags well below the period of the motion.

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

}  // namespace forcegate
