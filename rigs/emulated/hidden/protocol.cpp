#include "rigs/emulated/hidden/protocol.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "hil/base/portable_math.h"

namespace forcegate::hidden {
namespace {

double log_uniform(Rng& rng, double low, double high) {
  return low * portable::pow(high / low, rng.uniform());
}

double rounded(double value, double step) { return std::round(value / step) / std::round(1.0 / step); }

/// Lowest and highest force of a cyclic record within the bench's range.
void draw_range(Rng& rng, RecordPlan& plan, double force_max_N, double A_low, double A_high) {
  const double A = rounded(rng.uniform(A_low, std::min(A_high, 0.46 * force_max_N)), 0.01);
  const double m = rounded(rng.uniform(A + 0.15, std::max(A + 0.2, force_max_N - A)), 0.01);
  plan.low_N = m - A;
  plan.high_N = std::min(m + A, force_max_N);
}

class Planner {
 public:
  Planner(Rng& rng, Rng& other, const Conditions& conditions, double minutes)
      : rng_(rng),
        other_(other),
        conditions_(conditions),
        scale_(std::min(1.0, minutes / 20.0)),
        minutes_(minutes) {}

  RecordPlan plan(const std::string& kind, bool is_long) {
    RecordPlan p;
    p.kind = kind;
    p.rate_Hz = conditions_.fast_rate_Hz;
    p.excitation_start_s = rounded(rng_.uniform(2.0, 5.0), 0.5);
    if (kind == "ramp" || kind == "staircase" || kind == "hold" || kind == "rest")
      plan_static(p);
    else if (kind == "sine" || kind == "multisine")
      plan_periodic(p, is_long);
    else
      plan_transient(p);
    return p;
  }

 private:
  void plan_static(RecordPlan& p) {
    const double top = conditions_.force_max_N;
    p.rate_Hz = std::min(p.rate_Hz, conditions_.slow_rate_Hz);
    p.low_N = rng_.uniform() < 0.5 ? 0.0 : rounded(rng_.uniform(0.02, 0.2), 0.01);
    p.high_N = rounded(rng_.uniform(0.9, 1.0) * top, 0.05);
    if (p.high_N > top) p.high_N = top;
    if (p.kind == "ramp") {
      p.repeats = 2 + static_cast<int>(rng_.below(2));
      p.duration_s = p.excitation_start_s + p.repeats * rng_.uniform(40.0, 90.0) + 3.0;
    } else if (p.kind == "staircase") {
      p.dwell_s = rounded(rng_.uniform(6.0, 15.0), 0.5);
      p.repeats = 5 + static_cast<int>(rng_.below(4));  // levels going up
      p.duration_s = p.excitation_start_s + p.dwell_s * (2 * p.repeats - 1);
    } else if (p.kind == "hold") {
      p.high_N = rounded(rng_.uniform(0.4, 0.9) * top, 0.05);
      p.duration_s = std::max(200.0, rng_.uniform(400.0, 700.0) * scale_);
    } else {
      p.high_N = p.low_N = rounded(rng_.uniform(0.1, 0.4), 0.05);
      p.duration_s = std::max(60.0, 180.0 * scale_);
    }
  }

  void plan_periodic(RecordPlan& p, bool is_long) {
    p.dynamic = true;
    p.rate_Hz = std::min(p.rate_Hz, conditions_.slow_rate_Hz);
    const bool wide = conditions_.wide_loads;
    draw_range(rng_, p, conditions_.force_max_N, wide ? 0.25 : 0.5, wide ? 2.2 : 1.9);
    const double share = is_long ? 1.0 : rng_.uniform(0.2, 0.4);
    p.duration_s = std::max(is_long ? 120.0 : 90.0, 60.0 * minutes_ * share);
    if (wide && is_long) p.duration_s = std::max(90.0, std::round(p.duration_s * other_.uniform(0.4, 1.2)));
    if (p.kind == "sine") {
      p.wheel = true;
      p.frequencies_Hz = {rounded(wide ? log_uniform(rng_, 0.04, 5.0) : log_uniform(rng_, 0.1, 3.0), 0.01)};
      p.weights = {1.0};
    } else {
      const bool four = rng_.uniform() < 0.5;
      const double f = rounded(log_uniform(rng_, 0.05, 0.2), 0.01);
      if (four) {
        p.frequencies_Hz = {f, 2 * f, 10 * f, 20 * f > 3.0 ? 3.0 : 20 * f};
        p.weights = {0.4, 0.3, 0.2, 0.1};
      } else {
        p.frequencies_Hz = {f, f * rounded(rng_.uniform(3.0, 12.0), 0.1)};
        p.weights = {0.5, 0.5};
      }
    }
    p.f_min_Hz = p.frequencies_Hz.front();
  }

  void plan_transient(RecordPlan& p) {
    p.dynamic = true;
    draw_range(rng_, p, conditions_.force_max_N, 0.8, 2.0);
    if (p.kind == "sweep") {
      const double f0 = rounded(rng_.uniform(0.05, 0.2), 0.01), f1 = rounded(rng_.uniform(1.5, 4.0), 0.1);
      p.frequencies_Hz = rng_.uniform() < 0.7 ? std::vector{f0, f1} : std::vector{f1, f0};
      p.duration_s = std::max(100.0, rng_.uniform(150.0, 260.0) * scale_);
      p.f_min_Hz = p.frequencies_Hz.front();
    } else if (p.kind == "prbs") {
      p.dwell_s = rounded(rng_.uniform(0.15, 0.5), 0.05);
      p.duration_s = std::max(60.0, rng_.uniform(70.0, 150.0) * scale_);
      p.f_min_Hz = 0.1;
    } else if (p.kind == "switch") {
      const double f1 = rounded(rng_.uniform(0.3, 0.8), 0.05);
      const double f2 = rounded(f1 * rng_.uniform(2.5, 5.0), 0.05);
      p.frequencies_Hz = rng_.uniform() < 0.5 ? std::vector{f1, f2, f1} : std::vector{f2, f1, f2};
      p.duration_s = std::max(180.0, rng_.uniform(240.0, 330.0) * scale_);
      p.event_s = {rounded(p.duration_s * rng_.uniform(0.28, 0.38), 1.0),
                   rounded(p.duration_s * rng_.uniform(0.62, 0.72), 1.0)};
      p.f_min_Hz = p.frequencies_Hz.front();
    } else {  // steps: quasi-static levels with fast edges, no decay of the maxima
      p.dynamic = false;
      p.low_N = rounded(rng_.uniform(0.1, 0.4), 0.05);
      p.high_N = rounded(rng_.uniform(0.8, 1.0) * conditions_.force_max_N, 0.05);
      if (p.high_N > conditions_.force_max_N) p.high_N = conditions_.force_max_N;
      p.dwell_s = rounded(rng_.uniform(1.5, 5.0), 0.5);
      p.duration_s = std::max(60.0, rng_.uniform(70.0, 140.0) * scale_);
    }
  }

  Rng& rng_;
  Rng& other_;  ///< habits of other laboratories, beside the stream of the usual draws
  const Conditions& conditions_;
  double scale_, minutes_;
};

/// Two or three records, of a short campaign more than half; never the first ramp, and never the only record of a required kind.
void choose_heldout(Rng& rng, std::vector<RecordPlan>& plans, const std::vector<std::string>& required) {
  const auto fitted = [&](const std::string& kind) {
    return std::count_if(plans.begin(), plans.end(),
                         [&](const RecordPlan& p) { return p.kind == kind && !p.heldout; });
  };
  std::size_t wanted = 2 + rng.below(2), chosen = 0;
  std::vector<std::size_t> order;
  for (std::size_t i = 1; i < plans.size(); ++i) order.push_back(i);
  for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[rng.below(i)]);
  const auto wants = [&](const std::string& kind) {
    return std::find(required.begin(), required.end(), kind) != required.end();
  };
  for (const int pass : {0, 1}) {  // first records that excite what was asked for, then any
    for (const std::size_t i : order) {
      RecordPlan& p = plans[i];
      if (chosen >= wanted || p.heldout || p.kind == "rest") continue;
      if (pass == 0 && (required.empty() ? !p.dynamic : !wants(p.kind))) continue;
      if (fitted(p.kind) < 2 && (wants(p.kind) || p.kind == "sine")) continue;
      p.heldout = true;
      ++chosen;
      if (pass == 0) break;
    }
  }
}

}  // namespace

std::vector<RecordPlan> draw_protocol(std::uint64_t seed, const Conditions& conditions,
                                      const std::vector<std::string>& required, double minutes) {
  Rng rng(seed, "protocol"), other(seed, "protocol/other");
  Planner planner(rng, other, conditions, minutes);
  std::vector<std::string> kinds = required;
  const auto missing = [&](const char* kind) {
    return std::find(kinds.begin(), kinds.end(), kind) == kinds.end();
  };
  if (missing("ramp")) kinds.push_back("ramp");
  while (std::count(kinds.begin(), kinds.end(), "sine") < 2) kinds.push_back("sine");
  std::vector<std::string> pool = {"staircase", "sine",  "sine",   "sweep", "multisine", "multisine",
                                   "prbs",      "steps", "switch", "hold",  "rest",      "ramp"};
  std::size_t usual = 7 + rng.below(5);
  if (conditions.short_protocol) usual = 5 + other.below(3);
  if (conditions.long_protocol) usual = 11 + other.below(3);
  const std::size_t count = std::max<std::size_t>(kinds.size(), usual);
  while (kinds.size() < count && !pool.empty()) {
    const std::size_t i = rng.below(pool.size());
    kinds.push_back(pool[i]);
    pool.erase(pool.begin() + static_cast<std::ptrdiff_t>(i));
  }
  for (std::size_t i = kinds.size(); i > 1; --i) std::swap(kinds[i - 1], kinds[rng.below(i)]);
  std::iter_swap(kinds.begin(), std::find(kinds.begin(), kinds.end(), "ramp"));
  if (const auto last = std::find(kinds.rbegin(), kinds.rend(), "ramp"); last != kinds.rend() - 1)
    std::iter_swap(kinds.rbegin(), last);

  std::vector<RecordPlan> plans;
  double clock_s = rng.uniform(0.0, 600.0);
  int long_sines = 0, mounting = 0, session = 0;
  constexpr double kDrives_V[] = {1.0, 2.0, 3.3, 5.0, 5.0};
  const std::size_t remount_at = 2 + rng.below(kinds.size() - 3);
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    RecordPlan p = planner.plan(kinds[i], kinds[i] == "sine" && ++long_sines <= 2);
    p.rest_before_s = std::round(log_uniform(rng, 30.0, 2400.0));
    if (conditions.session_share > 0.0 && i > 0 && other.uniform() < 0.3) {
      ++session;
      p.rest_before_s = std::round(other.uniform(3600.0, 60000.0));
    }
    p.session_seed = mix_seed(seed, "session/" + std::to_string(session));
    clock_s += p.rest_before_s;
    p.start_s = std::round(clock_s);
    clock_s = p.start_s + p.duration_s;
    p.drive_V = conditions.vary_drive ? kDrives_V[rng.below(std::size(kDrives_V))] : 5.0;
    if (conditions.remount && (i == remount_at || (i > remount_at && rng.uniform() < 0.25))) ++mounting;
    p.mounting = mounting;
    p.seed = mix_seed(seed, "record/" + std::to_string(i));
    plans.push_back(std::move(p));
  }
  choose_heldout(rng, plans, required);
  return plans;
}

}  // namespace forcegate::hidden
