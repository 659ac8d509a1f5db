#pragma once
// A lag and a curve that lags with it, fitted together in place of the model's own: a search knows only what one of them leaves of the other.
//
//   U = o_i + g_i (L F + h(L F))  or  o_i + g_i L (F + h(F)),  F at a delay

#include <memory>
#include <string>
#include <vector>

#include "hil/diagnose/workspace.h"

namespace forcegate::diagnose {

inline constexpr const char* kLag = "lag";
inline constexpr const char* kCurve = "static_nonlinearity";
inline constexpr const char* kOnePole = "one_pole";

/// Names of their forms in the library; those of the curve act beside a lag.
struct LagWithCurve {
  std::string lag, curve;
  bool operator==(const LagWithCurve&) const = default;
};

struct LagAndCurvePoint {
  double delay_s = 0.0;
  std::vector<double> lag, curve;         ///< shapes; the curve's first is the lag's
  double evidence = -1e300, left = 0.0;   ///< nats; excess mean square
};

class LagAndCurveModel {
 public:
  enum class Delay { moves, stays };
  enum class Decay { none, of_records };

  LagAndCurveModel(const Workspace& workspace, Decay decay, unsigned threads) : w_(workspace), decay_(decay), threads_(threads) {}

  /// From `start` to where the evidence is largest.
  LagAndCurvePoint best(const LagWithCurve& forms, const LagAndCurvePoint& start, Delay delay);

  /// Strengths of the curve there, as shares of the gain; empty where nothing can be fitted.
  std::vector<double> curve_at(const LagWithCurve& forms, LagAndCurvePoint point);

 private:
  MixedFit judge(const LagWithCurve& forms, LagAndCurvePoint& point);
  void build(const LagWithCurve& forms, const LagAndCurvePoint& point);

  const Workspace& w_;
  Decay decay_;
  unsigned threads_;
  std::unique_ptr<Workspace> own_;
  double delay_s_ = 0.0;
  LagWithCurve forms_;
};

/// The model's lag of the output's channel, at its present shape; nullptr: it has none.
const Candidate* lag_of_model(const ResidualChannel& channel);

}  // namespace forcegate::diagnose
