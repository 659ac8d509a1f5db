// Creep under load: U goes on growing at constant force.
//   dU = g sum_k c_k L_k[F],  tau_k L' + L = F                     (Prony series; Burgers body, PM17b)
//   dU/U = k log10(1 + t/t0) after a step: equal weights on a logarithmic grid of tau
//   dU/U = (1 + t/t0)^p - 1 after a step: weights growing as tau^p
//   stress_activated: y' = (F0/tau) sinh((F - y)/F0), dU = g k y      barriers that the stress lowers (Eyring 1936; Ward and Hine 2004)
// An output that grows to more than twice what the load gave at once follows it late: that is a lag (ours).
// Less than 5 % a decade of time (Interlink FSR 400 data sheet), below 6 % in 20 min at rest load (Lebosse 2011).

#include <cmath>
#include <iterator>

#include "hil/model/effect.h"
#include "hil/model/states.h"

namespace forcegate {
namespace {

constexpr double kTau_s[] = {1.0, 3.0, 10.0, 30.0, 100.0, 300.0, 1000.0};
constexpr double kLeastGrowth = -0.75, kMostGrowth = 1.0;  // of the load
constexpr double kDecades = 4.5;                           // of the spectrum

std::vector<double> drive_of(const RecordInput& r, bool decayed) {
  if (!decayed) return r.F_N;
  std::vector<double> W(r.rows());
  for (std::size_t i = 0; i < r.rows(); ++i) W[i] = r.base_force_N(i);
  return W;
}

void prony(const RecordInput& r, ColumnsRef out, bool decayed, bool settled) {
  const std::vector<double> x = drive_of(r, decayed);
  for (int k = 0; k < 7; ++k) {
    const auto y = low_pass_channel(r, x, kTau_s[k], settled ? x[0] : 0.0);
    for (std::size_t i = 0; i < y.size(); ++i) out(static_cast<Eigen::Index>(i), k) = y[i];
  }
}

// Response whose step is a sum of exponentials with weights tau^p, scaled to 1 per decade of time at p = 0.
void spectrum(const RecordInput& r, double p, bool decayed, bool settled, ColumnsRef out) {
  std::vector<double> tau, weight;
  for (int k = 0; k < 9; ++k) {
    tau.push_back(0.3 * std::pow(10.0, 0.5 * k));
    weight.push_back(0.5 * std::pow(tau.back() / 10.0, p));
  }
  const std::vector<double> x = drive_of(r, decayed);
  const auto y = spectrum_response(r, x, tau, weight, settled ? x[0] : 0.0);
  for (std::size_t i = 0; i < y.size(); ++i) out(static_cast<Eigen::Index>(i), 0) = y[i];
}

// With z = |F - y|/F0 and q = e^-z, tanh(z/2) falls by e^(-dt/tau) under a load that stays: exact, and without a difference of near numbers.
double flow(double gap_N, double F0_N, double faded) {
  constexpr double kFarthest = 500.0;  // of F0: e^z stays finite
  const double q = std::exp(-std::min(std::abs(gap_N) / F0_N, kFarthest));
  return std::copysign(F0_N * std::log1p(faded * (1.0 / q - q) / (2.0 - faded + faded * q)), gap_N);
}

void stress_activated(const RecordInput& r, double tau_s, double F0_N, bool settled, ColumnsRef out) {
  double y = settled ? r.F_N[0] : 0.0, dt_s = -1.0, faded = 0.0;
  for (std::size_t i = 0; i < r.rows(); ++i) {
    if (i > 0) {
      if (const double step_s = r.t_s[i] - r.t_s[i - 1]; std::abs(step_s - dt_s) > 1e-9 * step_s) dt_s = step_s, faded = -std::expm1(-dt_s / tau_s);
      y += flow(0.5 * (r.F_N[i - 1] + r.F_N[i]) - y, F0_N, faded);
    }
    out(static_cast<Eigen::Index>(i), 0) = y;
  }
}

// Of one pole where a record begins: what the loads of the earlier ones and the rests without load between them left. A record that is none of
// the campaign's begins without.
double left_behind(const CampaignInput& c, const RecordInput& record, double tau_s) {
  constexpr double kForgotten = 40.0;  // time constants
  double state = 0.0, clock_s = record.start_s;
  for (const RecordInput& r : c.records) {
    if (r.index >= record.index) break;
    if (r.start_s + r.duration_s < record.start_s - kForgotten * tau_s || r.rows() == 0) continue;
    state = state * std::exp(-std::max(0.0, r.start_s - clock_s) / tau_s);
    state = low_pass_channel(r, r.F_N, tau_s, state).back();
    clock_s = r.start_s + r.duration_s;
  }
  return state * std::exp(-std::max(0.0, record.start_s - clock_s) / tau_s);
}

void carried(const CampaignInput& c, const RecordInput& record, double tau_s, ColumnsRef out) {
  const auto y = low_pass_channel(record, record.F_N, tau_s, left_behind(c, record, tau_s));
  for (std::size_t i = 0; i < y.size(); ++i) out(static_cast<Eigen::Index>(i), 0) = y[i];
}

EffectForm carried_form() {
  return {.name = "carried",
          .shape = {{"tau_s", "s", 30.0, 1e5, 1000.0, "time constant of growth and recovery"}},
          .strength = {{"k", "1", -2.0, 2.0, 0.0, "growth, share of the load"}},
          .sign = StrengthSign::positive,
          .grid = [](const CampaignInput& c) {
            return c.has_start_times && !c.single && c.records.size() > 1 ? std::vector<std::vector<double>>{{100.0}, {300.0}, {1000.0}, {3000.0}, {10000.0}} : std::vector<std::vector<double>>{};
          },
          .columns = [](const CampaignInput& c, const RecordInput& r, std::span<const double> shape, ColumnsRef out) { carried(c, r, shape[0], out); },
          .least = kLeastGrowth,
          .most = kMostGrowth,
          .refine = false,  // the rows within the records alone would move it away from what the levels tell
          .outlasts = true};
}

std::vector<ParameterSpec> prony_strengths() {
  std::vector<ParameterSpec> out;
  for (int k = 0; k < 7; ++k)
    out.push_back({"k_" + std::to_string(static_cast<int>(kTau_s[k])) + "s", "1", -2.0, 2.0, 0.0,
                   "relative growth with the time constant in the name"});
  return out;
}

EffectForm prony_form(const char* name, bool decayed, bool settled, bool bank) {
  return {.name = name,
          .shape = {},
          .strength = prony_strengths(),
          .memory_s = {std::begin(kTau_s), std::end(kTau_s)},
          .sign = StrengthSign::positive,
          .grid = [](const CampaignInput&) { return std::vector<std::vector<double>>{{}}; },
          .columns = [=](const CampaignInput&, const RecordInput& r, std::span<const double>,
                         ColumnsRef out) { prony(r, out, decayed, settled); },
          .least = kLeastGrowth,
          .most = kMostGrowth,
          .singles = true,
          .bank = bank};
}

EffectForm spectrum_form(const char* name, bool decayed, bool settled) {
  return {.name = name,
          .shape = {{"p", "1", 0.0, 0.3, 0.0, "exponent of the growth; 0 is logarithmic"}},
          .strength = {{"k_per_decade", "1", -1.0, 1.0, 0.0, "relative growth per decade of time"}},
          .sign = StrengthSign::positive,
          .grid =
              [](const CampaignInput&) {
                return std::vector<std::vector<double>>{{0.0}, {0.15}};
              },
          .columns = [=](const CampaignInput&, const RecordInput& r, std::span<const double> shape,
                         ColumnsRef out) { spectrum(r, shape[0], decayed, settled, out); },
          .least = kLeastGrowth / kDecades,
          .most = kMostGrowth / kDecades};
}

EffectForm stress_activated_form(const char* name, bool settled) {
  return {.name = name,
          .shape = {{"tau_s", "s", 0.5, 1e5, 100.0, "time constant near the end, where the stress that is left hastens nothing"},
                    {"F0_N", "N", 1e-3, 1e3, 1.0, "load that hastens the growth about threefold"}},
          .strength = {{"k", "1", -2.0, 2.0, 0.0, "growth, share of the load"}},
          .sign = StrengthSign::positive,
          .grid =
              [](const CampaignInput& c) {
                std::vector<std::vector<double>> out;
                for (const double tau_s : {15.0, 60.0, 250.0, 1000.0})
                  for (const double share : {0.07, 0.2}) out.push_back({tau_s, share * c.range_N});
                return out;
              },
          .columns = [settled](const CampaignInput&, const RecordInput& r, std::span<const double> shape, ColumnsRef out) { stress_activated(r, shape[0], shape[1], settled, out); },
          .least = kLeastGrowth,
          .most = kMostGrowth,
          .one_law = true};
}

const Registration<EffectKind> kRegistered{EffectKind{
    .name = "creep",
    .side = "sensor",
    .summary = "the output goes on growing under constant load and sinks back slowly after unloading",
    .equation = "dU = g sum_k c_k L_k[F], tau_k L_k' + L_k = F; stress_activated: dU = g k y, y' = (F0/tau) sinh((F - y)/F0)",
    .source = "Paredes-Madrid et al., Materials 10 (2017) 1334; Interlink FSR 400 data sheet; Eyring, J. Chem. Phys. 4 (1936) 283",
    .look_alikes = {"thermal", "self_heating", "hysteresis", "reference_drift", "lag"},
    .separates =
        "long holds at two levels, a step up, then down: creep restarts at each step and mirrors itself",
    .needs = {},
    .forms = {prony_form("prony", false, false, true), prony_form("prony_settled", false, true, false),
              prony_form("prony_decayed", true, false, false), spectrum_form("power_law", false, false),
              spectrum_form("power_law_settled", false, true),
              spectrum_form("power_law_decayed", true, false), stress_activated_form("stress_activated", false),
              stress_activated_form("stress_activated_settled", true), carried_form()}}};

}  // namespace
}  // namespace forcegate
