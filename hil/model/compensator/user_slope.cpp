#include "hil/model/compensator/user_slope.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "hil/model/user_equation.h"

namespace forcegate {
namespace {

constexpr double kFullSwing_s = 0.2;  // no rig and no finger crosses the span faster
constexpr double kFine_s = 12.0, kLong_s = 900.0, kLongStep_s = 0.02;
constexpr int kLooks = 600;   // instants of a course
constexpr int kHalvings = 9;  // steps away from the force before: w, w/2, w/4 ...
constexpr double kTemperatureSpan_degC = 20.0;

// Two triangles, a step up and down, a sine; u is 0 ... 1 over the course.
double course(double u) {
  const double x = std::fmod(6.0 * u, 1.0);
  switch (static_cast<int>(6.0 * u)) {
    case 0:
    case 1: return x < 0.5 ? 2.0 * x : 2.0 - 2.0 * x;
    case 2: return std::min(1.0, 5.0 * x);
    case 3: return std::max(0.3, 1.0 - 5.0 * x);
    case 4: return 0.3 + 0.35 * (1.0 - std::cos(20.0 * std::numbers::pi * x));
    default: return 0.3 * (1.0 - x);
  }
}

class Looker {
 public:
  Looker(UserEquation& e, const CTermContext& x) : e_(e), x_(x) {
    const double T0 = std::isnan(x.reference_temperature_C) ? kTemperatureSpan_degC : x.reference_temperature_C;
    temperatures_ = {T0};
    if (e.uses("T")) temperatures_ = {T0, T0 - kTemperatureSpan_degC, T0 + kTemperatureSpan_degC};
  }

  void walk(double duration_s, double step_s) {
    const auto n = static_cast<std::size_t>(duration_s / step_s);
    const std::size_t every = std::max<std::size_t>(1, n / kLooks), states = e_.state.size();
    const auto force = [&](double i) { return x_.lowest_N + x_.span_N * course(std::min(i / static_cast<double>(n), 1.0 - 1e-9)); };
    std::fill(e_.state.begin(), e_.state.end(), 0.0);
    std::vector<double> start(states), slope(states);
    const auto derive = [&](double i, double rate) {
      e_.F = force(i);
      e_.dF = rate;
      e_.t = i * step_s;
      e_.T = temperatures_.front();
      for (std::size_t k = 0; k < states; ++k) slope[k] = e_.derivative(k);
    };
    for (std::size_t i = 1; i < n; ++i) {
      const auto at = static_cast<double>(i);
      const double rate = (force(at) - force(at - 1.0)) / step_s;
      if (i % every == 0 && !look(force(at), force(at) - rate / x_.rate_Hz, at * step_s)) return;
      start = e_.state;
      derive(at, rate);
      for (std::size_t k = 0; k < states; ++k) e_.state[k] = start[k] + 0.5 * step_s * slope[k];
      derive(at + 0.5, rate);
      for (std::size_t k = 0; k < states; ++k) e_.state[k] = start[k] + step_s * slope[k];
    }
  }

  LeastSlope found() const { return found_; }

 private:
  double value(double F, double before, double earlier) {
    e_.F = F;
    e_.dF = x_.rate_Hz * (1.5 * F - 2.0 * before + 0.5 * earlier);
    return e_.output();
  }

  // False once a state has run away: what follows says nothing.
  bool look(double before, double earlier, double t) {
    if (std::any_of(e_.state.begin(), e_.state.end(), [](double s) { return !std::isfinite(s); })) return false;
    const double highest = x_.lowest_N + 1.2 * x_.span_N, window = std::min(x_.span_N, x_.span_N / (kFullSwing_s * x_.rate_Hz));
    e_.t = t;
    for (const double T : temperatures_) {
      e_.T = T;
      const double here = value(before, before, earlier);
      for (const double way : {1.0, -1.0}) {
        double near = before, at_near = here;
        for (int k = kHalvings; k >= 0; --k) {
          const double F = before + way * std::ldexp(window, -k);
          if (F < x_.lowest_N || F > highest) break;
          const double at_F = value(F, before, earlier), slope = (at_F - at_near) / (F - near);
          if (std::isfinite(slope) && slope < found_.slope) found_ = {slope, before, way < 0.0};
          near = F;
          at_near = at_F;
        }
      }
    }
    return true;
  }

  UserEquation& e_;
  const CTermContext& x_;
  std::vector<double> temperatures_;
  LeastSlope found_;
};

}  // namespace

Result<LeastSlope> least_slope(const UserEffect& effect, const CTermContext& context) {
  FORCEGATE_TRY(const std::unique_ptr<UserEquation> equation, UserEquation::make(effect));
  Looker looker(*equation, context);
  looker.walk(kFine_s, 1.0 / context.rate_Hz);
  if (!effect.states.empty() && kLongStep_s > 1.0 / context.rate_Hz) looker.walk(kLong_s, kLongStep_s);
  return looker.found();
}

}  // namespace forcegate
