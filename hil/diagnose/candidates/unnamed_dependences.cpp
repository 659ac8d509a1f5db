#include "hil/diagnose/candidates/unnamed_dependences.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <iterator>
#include <numbers>

namespace forcegate::diagnose {

namespace {

using Grid = std::vector<std::vector<double>>;
using Fill = std::function<void(const CampaignInput&, const RecordInput&, std::span<const double>, ColumnsRef)>;

UnnamedDependence dependence(const char* name, const char* on, const char* group, std::vector<ParameterSpec> shape, std::size_t columns, Grid grid,
                             Fill fill) {
  EffectForm form;
  form.name = name;
  form.shape = std::move(shape);
  for (std::size_t k = 0; k < columns; ++k) form.strength.push_back({"c" + std::to_string(k + 1), "1", -10.0, 10.0, 0.0, ""});
  form.grid = [grid = std::move(grid)](const CampaignInput&) { return grid; };
  form.columns = std::move(fill);
  form.refine = false;
  UnnamedDependence out;
  out.kind.name = name;
  out.kind.summary = on;
  out.kind.forms.push_back(std::move(form));
  out.group = group;
  return out;
}

// Largest force of the records before, as far as it is not forgotten; the lowest of the campaign where there is none.
double largest_before(const CampaignInput& c, const RecordInput& r, double tau_s) {
  double out = c.lowest_N;
  for (const RecordInput& earlier : c.records) {
    if (earlier.start_s >= r.start_s || earlier.recording == r.recording) continue;
    const double ago_s = r.start_s - earlier.start_s - earlier.duration_s;
    const double largest = *std::ranges::max_element(earlier.F_N);
    out = std::max(out, c.lowest_N + (largest - c.lowest_N) * std::exp(-std::max(0.0, ago_s) / tau_s));
  }
  return out;
}

const std::vector<ParameterSpec>& shape_of_largest() {
  static const std::vector<ParameterSpec> shape = {{"tau_s", "s", 1.0, 1e9, 1e9, "time in which the largest force is forgotten"},
                                                   {"kept", "1", 0.0, 1.0, 0.0, "1: over the rests between records"}};
  return shape;
}

Grid grid_of_largest() { return {{1e9, 0.0}, {300.0, 0.0}, {3600.0, 1.0}, {600.0, 1.0}, {1e9, 1.0}}; }

// `visit(row, W, M)`: the base force and the largest of those so far.
template <class Visit>
void with_largest(const CampaignInput& c, const RecordInput& r, std::span<const double> shape, const Visit& visit) {
  double largest = shape[1] > 0.5 ? largest_before(c, r, shape[0]) : c.lowest_N;
  for (std::size_t i = 0; i < r.rows(); ++i) {
    const double W = r.base_force_N(i), dt = i == 0 ? 0.0 : r.t_s[i] - r.t_s[i - 1];
    largest = std::max(W, W + (largest - W) * std::exp(-dt / shape[0]));
    visit(static_cast<Eigen::Index>(i), W, largest);
  }
}

// Softening of filled rubber (Mullins 1969): unloading runs below the first loading, and so does every loading up to the largest force so far.
// dU = g (c1 (M - W) + c2 (M - W) W/R), M the largest base force, forgotten with tau; kept: of the records before as well.
UnnamedDependence largest_force() {
  return dependence("largest_force", "the largest force so far", "history", shape_of_largest(), 2, grid_of_largest(),
                    [](const CampaignInput& c, const RecordInput& r, std::span<const double> shape, ColumnsRef out) {
                      with_largest(c, r, shape, [&](Eigen::Index row, double W, double M) {
                        out(row, 0) = M - W;
                        out(row, 1) = (M - W) * W / c.range_N;
                      });
                    });
}

// Contact that stays where it was pressed: dU = g c W M/R. Its own dependence, for beside the softening it would make any curve, W^2.
UnnamedDependence gain_by_largest_force() {
  return dependence("gain_by_largest_force", "the largest force so far", "history", shape_of_largest(), 1, grid_of_largest(),
                    [](const CampaignInput& c, const RecordInput& r, std::span<const double> shape, ColumnsRef out) {
                      with_largest(c, r, shape, [&](Eigen::Index row, double W, double M) { out(row, 0) = W * M / c.range_N; });
                    });
}

// dU = g (c1 v + c2 v W/R), v = R (|F'| s / R)^power: up and down alike.
UnnamedDependence size_of_rate() {
  return dependence("size_of_rate", "the size of the rate", "rate", {{"power", "1", 0.1, 2.0, 1.0, "of the rate"}}, 2,
                    {{1.0}, {0.5}, {0.25}}, [](const CampaignInput& c, const RecordInput& r, std::span<const double> shape, ColumnsRef out) {
                      r.for_each_wanted([&](std::size_t i) {
                        const double size = c.range_N * std::pow(std::abs(r.rate_N_per_s[i]) / c.range_N, shape[0]);
                        out(static_cast<Eigen::Index>(i), 0) = size;
                        out(static_cast<Eigen::Index>(i), 1) = size * r.base_force_N(i) / c.range_N;
                      });
                    });
}

// A mass on a spring between the reference and the film: y'' + 2 z w y' + w^2 y = w^2 F, dU = g D c (y - F); far below its resonance c F''/w^2.
// One complex pole, exact for a force that is linear between samples and a clock that is even within a row; products are written out, those of
// std::complex look for NaN.
void ring(const RecordInput& r, double f_Hz, double damping, ColumnsRef out) {
  using C = std::complex<double>;
  out.setZero();
  if (r.fast_F_N.empty()) return;
  const double w = 2.0 * std::numbers::pi * f_Hz, wd = w * std::sqrt(1.0 - damping * damping), scale = w * w / wd;
  const C pole{-damping * w, wd}, rest = -r.fast_F_N[0] / pole;  // as after a long rest
  double re = rest.real(), im = rest.imag(), dt_of = 0.0, before = r.fast_F_N[0];
  C keep, to_old, to_new;
  for (std::size_t i = 0; i < r.rows(); ++i) {
    const std::uint32_t begin = r.row_begin[i], end = r.row_begin[i + 1], from = std::max<std::uint32_t>(begin, 1) - 1;
    const double dt = (r.fast_t_s[end - 1] - r.fast_t_s[from]) / std::max<double>(1.0, end - 1 - from);
    if (std::abs(dt - dt_of) > 1e-6 * dt_of) {
      const C h = pole * dt, decayed = std::exp(h), slope = (decayed - 1.0 - h) / (h * pole);
      keep = decayed;
      to_new = slope;
      to_old = (decayed - 1.0) / pole - slope;
      dt_of = dt;
    }
    double sum = 0.0;
    for (std::uint32_t k = begin; k < end; ++k) {
      const double F = r.fast_F_N[k];
      if (k > 0) {
        const double next = keep.real() * re - keep.imag() * im + (to_old.real() * before + to_new.real() * F);
        im = keep.real() * im + keep.imag() * re + (to_old.imag() * before + to_new.imag() * F);
        re = next;
      }
      before = F;
      sum += scale * im - F;
    }
    out(static_cast<Eigen::Index>(i), 0) = r.decay[i] * sum / static_cast<double>(end - begin);
  }
}

UnnamedDependence mass_on_spring() {
  Grid grid;
  for (const double f_Hz : {0.6, 1.2, 2.5, 5.0, 10.0, 16.0, 25.0, 50.0}) grid.push_back({f_Hz, 0.15});
  UnnamedDependence out = dependence(
      "mass_on_spring", "a resonance", "rate",
      {{"f_Hz", "Hz", 0.1, 200.0, 10.0, "resonance"}, {"damping", "1", 0.01, 0.35, 0.1, "of the critical one: more of it is a lag"}}, 1, std::move(grid),
      [](const CampaignInput&, const RecordInput& r, std::span<const double> shape, ColumnsRef columns) { ring(r, shape[0], shape[1], columns); });
  out.kind.forms.front().refine = true;
  out.is_late = true;
  return out;
}

// dU = g D (c1 sin n th + c2 cos n th), n = 2, 3: an eccentric that is not round, a gear.
UnnamedDependence harmonics_of_wheel() {
  return dependence("harmonics_of_wheel", "harmonics of the wheel", "angle", {{"n", "1", 2.0, 12.0, 2.0, "harmonic"}}, 2, {{2.0}, {3.0}},
                    [](const CampaignInput&, const RecordInput& r, std::span<const double> shape, ColumnsRef out) {
                      for (std::size_t i = 0; i < r.rows(); ++i) {
                        const double at = shape[0] * r.theta_rad[i];
                        out(static_cast<Eigen::Index>(i), 0) = r.decay[i] * std::sin(at);
                        out(static_cast<Eigen::Index>(i), 1) = r.decay[i] * std::cos(at);
                      }
                    });
}

// dU = g R (c1 x + c2 x^2), x = t/T: a reference or an amplifier that warms up. It knows nothing of the load, and is preferred to what does
// where it fits as well.
UnnamedDependence zero_with_time() {
  UnnamedDependence out = dependence("zero_with_time", kZeroWithTime, "time", {}, 2, {{}},
                                     [](const CampaignInput& c, const RecordInput& r, std::span<const double>, ColumnsRef columns) {
                                       const double T_s = std::max(1.0, r.t_s.empty() ? 1.0 : r.t_s.back());
                                       r.for_each_wanted([&](std::size_t i) {
                                         const double x = r.t_s[i] / T_s;
                                         columns(static_cast<Eigen::Index>(i), 0) = c.range_N * x;
                                         columns(static_cast<Eigen::Index>(i), 1) = c.range_N * x * x;
                                       });
                                     });
  out.is_simpler = true;
  return out;
}

// dU = g R sum_k c_k (1 - exp(-t / tau_k)), tau_k = T/30, T/10, T/3, T: creep under a constant load looks like that, and so does a zero that knows
// nothing of it.
UnnamedDependence settling_zero() {
  constexpr double kOfRecording[] = {1.0 / 30.0, 0.1, 1.0 / 3.0, 1.0};
  UnnamedDependence out = dependence("settling_zero", "a zero that settles with the time", "time", {}, std::size(kOfRecording), {{}},
                                     [kOfRecording](const CampaignInput& c, const RecordInput& r, std::span<const double>, ColumnsRef columns) {
                                       const double T_s = std::max(1.0, r.t_s.empty() ? 1.0 : r.t_s.back());
                                       r.for_each_wanted([&](std::size_t i) {
                                         for (std::size_t k = 0; k < std::size(kOfRecording); ++k)
                                           columns(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) = -c.range_N * std::expm1(-r.t_s[i] / (kOfRecording[k] * T_s));
                                       });
                                     });
  out.is_blind = true;
  return out;
}

// dU = g W (c1 x + c2 x^2), x = t/T: a supply, an amplifier or a span of the reference that moves.
UnnamedDependence gain_with_time() {
  UnnamedDependence out = dependence("gain_with_time", "a gain that goes with the time", "time", {}, 2, {{}},
                                     [](const CampaignInput&, const RecordInput& r, std::span<const double>, ColumnsRef columns) {
                                       const double T_s = std::max(1.0, r.t_s.empty() ? 1.0 : r.t_s.back());
                                       r.for_each_wanted([&](std::size_t i) {
                                         const double x = r.t_s[i] / T_s, W = r.base_force_N(i);
                                         columns(static_cast<Eigen::Index>(i), 0) = W * x;
                                         columns(static_cast<Eigen::Index>(i), 1) = W * x * x;
                                       });
                                     });
  out.is_simpler = true;
  return out;
}

// dU = g (c1 R + c2 W) [t >= x T]: a reference that was knocked, an amplifier that changed its range.
UnnamedDependence jump() {
  constexpr int kPlaces = 20;
  Grid grid;
  for (int k = 1; k < kPlaces; ++k) grid.push_back({static_cast<double>(k) / kPlaces});
  UnnamedDependence out = dependence("jump", "a jump of zero or gain at one moment", "time", {{"at", "1", 0.02, 0.98, 0.5, "share of the recording"}}, 2, std::move(grid),
                                     [](const CampaignInput& c, const RecordInput& r, std::span<const double> shape, ColumnsRef columns) {
                                       const double at_s = shape[0] * (r.t_s.empty() ? 0.0 : r.t_s.back());
                                       r.for_each_wanted([&](std::size_t i) {
                                         const bool after = r.t_s[i] >= at_s;
                                         columns(static_cast<Eigen::Index>(i), 0) = after ? c.range_N : 0.0;
                                         columns(static_cast<Eigen::Index>(i), 1) = after ? r.base_force_N(i) : 0.0;
                                       });
                                     });
  out.kind.forms.front().refine = true;
  out.tells_when = true;
  out.is_simpler = true;
  return out;
}

}  // namespace

std::vector<UnnamedDependence> unnamed_dependences(const CampaignInput& campaign) {
  std::vector<UnnamedDependence> out;
  if (campaign.single) {
    out.push_back(zero_with_time());
    out.push_back(settling_zero());
    out.push_back(gain_with_time());
    out.push_back(jump());
  }
  if (campaign.generic) {
    out.push_back(mass_on_spring());
    return out;
  }
  out.push_back(largest_force());
  out.push_back(gain_by_largest_force());
  out.push_back(size_of_rate());
  out.push_back(mass_on_spring());
  if (campaign.has_theta && std::ranges::all_of(campaign.records, [](const RecordInput& r) { return r.theta_rad.size() == r.rows(); }))
    out.push_back(harmonics_of_wheel());
  return out;
}

}  // namespace forcegate::diagnose
