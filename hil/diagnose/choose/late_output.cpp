#include "hil/diagnose/choose/late_output.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "hil/diagnose/choose/lag_and_curve.h"
#include "hil/diagnose/choose/reference_latency.h"
#include "hil/diagnose/choose/screen.h"
#include "hil/model/rows.h"
#include "hil/model/states.h"

namespace forcegate::diagnose {

namespace {

using Point = LagAndCurvePoint;
using Delay = LagAndCurveModel::Delay;

// A decay that small may be what a delay has left beside the wrong lag; which it is the second look tells.
bool hardly_decays(const CampaignInput& input) {
  constexpr double kSlight = 0.1;
  return std::ranges::all_of(input.records, [](const RecordInput& r) { return std::ranges::all_of(r.decay, [](double D) { return D > 1.0 - kSlight; }); });
}

/// What a delay and a lag share is told late: along the ridge the one grows by what the other loses, and a climb by one of them at a time comes to rest on it.
class AlongRidge {
 public:
  AlongRidge(LagAndCurveModel& model, const LagWithCurve& forms) : model_(model), forms_(forms) {}

  /// The best lag and curve beside a delay that is `factor` times that of `from`.
  Point beside(const Point& from, double factor) {
    constexpr double kLeastOfLag = 0.2;
    Point start = from;
    start.delay_s *= factor;
    start.lag.front() = std::max(kLeastOfLag * from.lag.front(), from.lag.front() + from.delay_s - start.delay_s);
    if (!start.curve.empty()) start.curve.front() = start.lag.front();
    return model_.best(forms_, start, Delay::stays);
  }

  Point top(Point at) {
    constexpr double kFirst = 0.2, kLast = 0.01, kBetter = 0.01;
    constexpr int kMostSteps = 30;
    int direction = 1;
    bool turned = false;
    double step = kFirst;
    for (int n = 0; n < kMostSteps && step > kLast; ++n) {
      const Point next = beside(at, direction > 0 ? 1.0 + step : 1.0 / (1.0 + step));
      if (next.evidence > at.evidence + kBetter) {
        at = next;
        turned = true;  // the way it came from is worse
      } else if (!turned) {
        direction = -direction;
        turned = true;
      } else {
        step *= 0.5;
        turned = false;
      }
    }
    return at;
  }

 private:
  LagAndCurveModel& model_;
  LagWithCurve forms_;
};

}  // namespace

void delay_force(CampaignInput& campaign, double delay_s) {
  const RecordInput* whole = nullptr;  // the first block of a recording, which alone has the force at full rate
  for (RecordInput& r : campaign.records) {
    if (r.fast_F_N.empty()) {
      if (whole != nullptr && whole->recording == r.recording) r.F_N = whole->F_N, r.rate_N_per_s = whole->rate_N_per_s;
      continue;
    }
    r.wanted.clear();
    r.F_N = delayed_rows(r, delay_s);
    set_rates(r);
    const std::vector<double>&t = r.fast_t_s, F = r.fast_F_N;
    for (std::size_t k = 0, j = 0; k < t.size() && t.size() > 1; ++k) {
      const double at = t[k] - delay_s;
      while (j + 2 < t.size() && t[j + 1] <= at) ++j;
      r.fast_F_N[k] = std::lerp(F[j], F[j + 1], std::clamp((at - t[j]) / (t[j + 1] - t[j]), 0.0, 1.0));
    }
    whole = &r;
  }
}

LateOutput late_output(const Workspace& w, unsigned threads) {
  constexpr double kPlainly = 30.0, kLeft = 0.5;  // nats, share of the mean square: a lag of a kind that nobody wrote down may come as near
  constexpr double kSomething = 0.1;              // of what the instruments may leave (mean square): else nothing is left to be explained
  constexpr double kOfLag = 0.4, kBeside = 0.7;   // of the lag alone: where the climb begins
  constexpr double kTypical_n = 0.8, kTypicalRatio = 1.2, kTypicalUnloaded = 1.0, kProfile = 0.1;
  const Candidate* guess = lag_of_model(w.output);
  if (guess == nullptr || !guess->is_guess || !hardly_decays(w.input)) return {};
  LagAndCurveModel model(w, LagAndCurveModel::Decay::none, threads);
  const double tau_s = guess->shape.front();
  Point without, late;
  LagWithCurve forms;
  const auto see = [&](const Point& p) {
    if (p.evidence > without.evidence) without = p;
  };
  const auto plain = [&] { return late.evidence > without.evidence + kPlainly && late.left < kLeft * without.left; };
  // with a delay, from where the lag alone came to rest
  const auto delayed = [&](const LagWithCurve& of, Point start) {
    start.delay_s = kOfLag * start.lag.front();
    start.lag.front() *= kBeside;
    if (const Point p = model.best(of, start, Delay::moves); p.evidence > late.evidence) late = p, forms = of;
  };
  // banks, which have no shape but the lag, tell whether it is worth asking the others; so flexible a curve has no best delay
  LagWithCurve best;
  for (const char* curve : {"quartic_before_lag", "quartic_after_lag"}) {
    const Point p = model.best({kOnePole, curve}, {0.0, {tau_s}, {tau_s}}, Delay::stays);
    if (p.evidence > without.evidence) best = {kOnePole, curve};
    see(p);
  }
  const double allowed = std::pow(allowed_rms(w.output), 2);
  if (without.left < kSomething * allowed) return {};
  delayed(best, without);
  for (const char* lag : {"two_poles", "diffusive"}) see(model.best({lag, best.curve}, {0.0, {tau_s}, {tau_s}}, Delay::stays));
  if (late.evidence < without.evidence + kPlainly) return {};
  late = {};

  const std::vector<std::pair<std::string, std::vector<double>>> curves = {{"power_before_lag", {tau_s, kTypical_n}},
                                                                           {"power_after_lag", {tau_s, kTypical_n}},
                                                                           {"polynomial_before_lag", {tau_s}},
                                                                           {"polynomial_after_lag", {tau_s}}};
  for (const auto& [curve, shape] : curves) {
    const Point alone = model.best({kOnePole, curve}, {0.0, {tau_s}, shape}, Delay::stays);
    see(alone);
    delayed({kOnePole, curve}, alone);
  }
  const std::vector<std::pair<std::string, std::vector<double>>> lags = {
      {"two_poles", {tau_s}}, {"diffusive", {tau_s}}, {"two_speeds", {tau_s, kTypicalRatio}}, {"sooner_under_load", {tau_s, kTypicalUnloaded}}};
  AlongRidge ridge(model, forms);
  late = ridge.top(late);
  if (!plain() || late.delay_s <= allowed_latency_s(w.input)) return {};
  for (const auto& [curve, shape] : curves)
    for (const auto& [lag, of_lag] : lags) {
      see(model.best({lag, curve}, {0.0, of_lag, shape}, Delay::stays));
      if (!plain()) return {};
    }
  const double fall = std::max(late.evidence - ridge.beside(late, 1.0 + kProfile).evidence, 1e-3);
  return {late.delay_s, kProfile * late.delay_s / std::sqrt(2.0 * fall), late.lag.front(), late.evidence - without.evidence, late.left / without.left};
}

}  // namespace forcegate::diagnose
