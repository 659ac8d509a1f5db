#include "hil/model/compensator/c_term_parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "hil/model/compensator/c_expression.h"
#include "hil/model/play.h"
#include "hil/model/states.h"

namespace forcegate {

LowPassWeights low_pass_weights(double tau_s, double rate_Hz) {
  const double h = 1.0 / (rate_Hz * tau_s);
  const double keep = std::exp(-h), mean = h > 1e-6 ? -std::expm1(-h) / h : 1.0 - 0.5 * h;
  return {mean - keep, 1.0 - mean};
}

namespace c_terms {

std::string prepare_pole(const std::string& id, const std::string& to_old, const std::string& to_new, const std::string& before) {
  return fmt::format(
      "  if (c->running) {{\n"
      "{3}"
      "    c->{0}_b = {2};\n"
      "    c->{0}_a = c->{0}_y + ({1} * (c->{0}_x - c->{0}_y) - c->{0}_b * c->{0}_y);\n"
      "  }} else {{\n"
      "    c->{0}_a = 0.0f;\n"
      "    c->{0}_b = 1.0f;\n"
      "  }}\n",
      id, to_old, to_new, before);
}

std::string add_to_pair(const std::string& id, const std::string& index, const std::string& step, const std::string& indent) {
  return fmt::format(
      "{3}const float step = {2} + c->{0}_lo{1};\n"
      "{3}const float sum = c->{0}_hi{1} + step;\n"
      "{3}c->{0}_lo{1} = step - (sum - c->{0}_hi{1});\n"
      "{3}c->{0}_hi{1} = sum;\n",
      id, index, step, indent);
}

namespace {

// Relaxations in parallel: sum_k c_k L_k[drive].
CTerm relaxations(const std::string& id, const std::vector<double>& tau_s, const std::vector<double>& weight,
                  bool decayed, bool settled, double rate_Hz) {
  CTerm t;
  std::vector<double> c, keep_old, keep_new;
  double first = 0.0, direct = 0.0;
  for (std::size_t k = 0; k < tau_s.size(); ++k) {
    if (weight[k] == 0.0) continue;
    const LowPassWeights w = low_pass_weights(tau_s[k], rate_Hz);
    c.push_back(weight[k]);
    keep_old.push_back(w.to_old);
    keep_new.push_back(w.to_new);
    first += settled ? weight[k] : 0.0;
    direct += weight[k] * w.to_new;
  }
  const std::size_t n = c.size();
  if (n == 0) return t;
  t.constants = array("k_" + id + "_c", c) + array("k_" + id + "_old", keep_old) +
                array("k_" + id + "_new", keep_new) + constant("k_" + id + "_first", first) +
                constant("k_" + id + "_direct", direct);
  t.state = fmt::format("  float {0}_hi[{1}], {0}_lo[{1}], {0}_x, {0}_a, {0}_b;\n", id, n);
  t.prepare = fmt::format(
      "  if (c->running) {{\n"
      "    float a = 0.0f;\n"
      "    for (int k = 0; k < {1}; ++k) {{\n"
      "      const float y = c->{0}_hi[k];\n"
      "      a += k_{0}_c[k] * (y + (k_{0}_old[k] * (c->{0}_x - y) - k_{0}_new[k] * y));\n"
      "    }}\n"
      "    c->{0}_a = a;\n"
      "    c->{0}_b = k_{0}_direct;\n"
      "  }} else {{\n"
      "    c->{0}_a = 0.0f;\n"
      "    c->{0}_b = k_{0}_first;\n"
      "  }}\n",
      id, n);
  const char* drive = decayed ? "W" : "F";
  t.value = fmt::format("c->{0}_a + c->{0}_b * {1}", id, drive);
  t.commit = fmt::format(
      "  for (int k = 0; k < {1}; ++k) {{\n"
      "    if (c->running) {{\n"
      "      const float y = c->{0}_hi[k];\n"
      "{4}"
      "    }} else {{\n"
      "      c->{0}_hi[k] = {3};\n"
      "    }}\n"
      "  }}\n"
      "  c->{0}_x = {2};\n",
      id, n, drive, settled ? drive : "0.0f",
      add_to_pair(id, "[k]", fmt::format("(k_{0}_old[k] * (c->{0}_x - y) + k_{0}_new[k] * ({1} - y))", id, drive), "      "));
  t.slope_min = std::min(0.0, direct);
  t.once = static_cast<int>(n) * 16;
  t.each = 2;
  t.bytes = 8 * n + 12;
  return t;
}

CTerm stress_activated_creep(const ModelEffect& e, const CTermContext& x) {
  const double tau_s = shape_of(e, 0), F0_N = shape_of(e, 1), k = strength_of(e, 0), faded = -std::expm1(-1.0 / (tau_s * x.rate_Hz));
  const bool settled = e.form.ends_with("_settled");
  const std::string& id = x.id;
  CTerm t;
  t.title = fmt::format("creep: y' = (F0/tau) sinh((F - y)/F0), tau {:g} s, F0 {:g} N, share {:g}", tau_s, F0_N, k);
  t.constants = constant("k_" + id + "_k", k) + constant("k_" + id + "_F0", F0_N) + constant("k_" + id + "_per_F0", 1.0 / F0_N) + constant("k_" + id + "_faded", faded);
  t.state = fmt::format("  float {0}_hi, {0}_lo, {0}_x;\n", id);
  t.constants += fmt::format(
      "static inline float {0}_flow(float gap) {{\n"
      "  const float q = fg_exp(-fg_min(fg_abs(gap) * k_{0}_per_F0, 60.0f));\n"
      "  const float u = k_{0}_faded * (1.0f / q - q) / ((2.0f - k_{0}_faded) + k_{0}_faded * q);\n"
      "  const float z = u < 0.01f ? u * (1.0f - u * (0.5f - u * (1.0f / 3.0f))) : fg_ln(1.0f + u);\n"
      "  return gap < 0.0f ? -(k_{0}_F0 * z) : k_{0}_F0 * z;\n"
      "}}\n",
      id);
  t.value = fmt::format("k_{0}_k * (c->running ? c->{0}_hi + {0}_flow(0.5f * (c->{0}_x + F) - c->{0}_hi) : {1})", id, settled ? "F" : "0.0f");
  t.commit = fmt::format(
      "  if (c->running) {{\n"
      "{2}"
      "  }} else {{\n"
      "    c->{0}_hi = {1};\n"
      "  }}\n"
      "  c->{0}_x = F;\n",
      id, settled ? "F" : "0.0f", add_to_pair(id, "", fmt::format("{0}_flow(0.5f * (c->{0}_x + F) - c->{0}_hi)", id), "    "));
  t.slope_min = std::min(0.0, k);
  t.once = t.each = 130;
  t.bytes = 12;
  t.needs_exp = t.needs_ln = true;
  return t;
}

}  // namespace

Result<CTerm> creep(const ModelEffect& e, const CTermContext& x) {
  const bool decayed = e.form.ends_with("_decayed"), settled = e.form.ends_with("_settled");
  if (e.form == "carried")
    return refuse("creep of form carried", "it begins with what loads and rests before a reset left behind",
                  "--fit CAMPAIGN fits a form that begins anew");
  if (e.form.starts_with("stress_activated")) return stress_activated_creep(e, x);
  std::vector<double> tau, weight;
  if (e.form.starts_with("prony")) {
    tau = {1.0, 3.0, 10.0, 30.0, 100.0, 300.0, 1000.0};
    for (std::size_t k = 0; k < tau.size(); ++k) weight.push_back(strength_of(e, k));
  } else {
    for (int k = 0; k < 9; ++k) {
      tau.push_back(0.3 * std::pow(10.0, 0.5 * k));
      weight.push_back(strength_of(e, 0) * 0.5 * std::pow(tau.back() / 10.0, shape_of(e, 0)));
    }
  }
  CTerm t = relaxations(x.id, tau, weight, decayed, settled, x.rate_Hz);
  t.title = fmt::format("creep: dU = g sum c_k L_k[{}], {} relaxations", decayed ? "W" : "F",
                        t.bytes > 12 ? (t.bytes - 12) / 8 : 0);
  return t;
}

namespace {

CTerm bouc_wen(const ModelEffect& e, const CTermContext& x) {
  const double z0 = shape_of(e, 0), c = strength_of(e, 0);
  const std::string& id = x.id;
  CTerm t;
  t.title = "hysteresis: Bouc-Wen loop, dU = -g D c z";
  t.constants = constant("k_" + id + "_z0", z0) + constant("k_" + id + "_rate", 1.0 / z0) +
                constant("k_" + id + "_c", c);
  t.state = fmt::format("  float {0}_z, {0}_x;\n", id);
  t.constants += fmt::format(
      "static inline float {0}_next(float z, float from, float F, int running) {{\n"
      "  if (!running) return F >= k_{0}_z0 ? k_{0}_z0 : F;\n"
      "  if (F == from) return z;\n"
      "  const float target = F > from ? k_{0}_z0 : -k_{0}_z0;\n"
      "  const float way = F > from ? F - from : from - F;\n"
      "  return target + (z - target) * fg_exp(-(way * k_{0}_rate));\n"
      "}}\n",
      id);
  t.value = fmt::format("-(c->shrink * k_{0}_c * {0}_next(c->{0}_z, c->{0}_x, F, c->running))", id);
  t.commit =
      fmt::format("  c->{0}_z = {0}_next(c->{0}_z, c->{0}_x, F, c->running);\n  c->{0}_x = F;\n", id);
  t.slope_min = std::min(0.0, -2.0 * c);
  t.once = t.each = 32;
  t.bytes = 8;
  t.needs_exp = true;
  return t;
}

// Plays that the fit left anything for, in newtons.
struct PlayBank {
  std::vector<double> radius, weight, curvature;
};

PlayBank play_bank_of(const ModelEffect& e, double span_N, bool curved) {
  PlayBank out;
  for (std::size_t k = 0; k < kPlayRadii.size(); ++k) {
    const bool bends = curved && k >= kFirstCurved && k <= kLastCurved;
    const double w = strength_of(e, k), v = bends ? strength_of(e, kPlayRadii.size() + k - kFirstCurved) : 0.0;
    if (w == 0.0 && v == 0.0) continue;
    out.radius.push_back(kPlayRadii[k] * span_N);
    out.weight.push_back(w);
    out.curvature.push_back(v / span_N);
  }
  return out;
}

// A play that is pushed along takes all narrower ones with it: those that are stuck are the widest.
double least_slope_of(const PlayBank& bank, double highest_N) {
  double stuck = 0.0, least = 0.0;
  for (std::size_t k = bank.radius.size(); k-- > 0;) {
    stuck += bank.weight[k] + std::max(0.0, 2.0 * bank.curvature[k] * highest_N);
    least = std::min(least, -stuck);
  }
  return least;
}

CTerm play_bank(const ModelEffect& e, const CTermContext& x) {
  const bool decayed = e.form != "play_bank_undecayed", curved = e.form == "play_bank_curved";
  const PlayBank bank = play_bank_of(e, x.span_N, curved);
  const std::size_t n = bank.radius.size();
  const std::string& id = x.id;
  CTerm t;
  if (n == 0) return t;
  t.title = fmt::format("hysteresis: {} play operators{}, dU = g {}sum w_k (P_k[F] - F)", n,
                        curved ? " with curved parts" : "", decayed ? "D " : "");
  t.constants = array("k_" + id + "_r", bank.radius) + array("k_" + id + "_w", bank.weight) +
                (curved ? array("k_" + id + "_v", bank.curvature) : "");
  t.state = fmt::format("  float {}_p[{}];\n", id, n);
  t.constants += fmt::format(
      "static inline float {0}_sum(const float* p, float F) {{\n"
      "  float sum = 0.0f;\n"
      "  for (int k = 0; k < {1}; ++k) {{\n"
      "    const float q = fg_clamp(p[k], F - k_{0}_r[k], F + k_{0}_r[k]);\n"
      "    sum += {2};\n"
      "  }}\n"
      "  return sum;\n"
      "}}\n",
      id, n,
      curved ? fmt::format("(k_{0}_w[k] + k_{0}_v[k] * (q + F)) * (q - F)", id)
             : fmt::format("k_{0}_w[k] * (q - F)", id));
  t.value = fmt::format("{}{}_sum(c->{}_p, F)", decayed ? "c->shrink * " : "", id, id);
  t.commit = fmt::format(
      "  for (int k = 0; k < {1}; ++k) c->{0}_p[k] = fg_clamp(c->{0}_p[k], F - k_{0}_r[k], F + k_{0}_r[k]);\n",
      id, n);
  t.slope_min = std::min(t.slope_min, least_slope_of(bank, x.lowest_N + x.span_N));
  t.each = static_cast<int>(n) * (curved ? 9 : 7);
  t.once = static_cast<int>(n) * 4;
  t.bytes = 4 * n;
  return t;
}

}  // namespace

Result<CTerm> hysteresis(const ModelEffect& e, const CTermContext& x) {
  if (e.form == "bouc_wen") return bouc_wen(e, x);
  if (e.form.starts_with("play_bank")) return play_bank(e, x);
  return refuse(e.effect, "the form " + e.form + " is a bank for the diagnosis, not a law",
                "add hysteresis in another of its forms, or let --fit CAMPAIGN choose one (forcegate explain hysteresis lists them)");
}

namespace {

// State y, last drive x and share k_<id>_c of one pole, whose weights prepare_pole() leaves in a and b.
void put_lag_behind(const std::string& id, CTerm& t) {
  t.state = fmt::format("  float {0}_y, {0}_x, {0}_a, {0}_b;\n", id);
  t.value = fmt::format("c->shrink * k_{0}_c * (c->{0}_a + (c->{0}_b - 1.0f) * F)", id);
  t.commit = fmt::format(
      "  c->{0}_y = c->{0}_a + c->{0}_b * F;\n"
      "  c->{0}_x = F;\n",
      id);
  t.each = 4;
  t.bytes = 16;
}

CTerm lag_of_two_speeds(const ModelEffect& e, const CTermContext& x) {
  const double tau_s = shape_of(e, 0), ratio = shape_of(e, 1), c = strength_of(e, 0);
  const std::string& id = x.id;
  const LowPassWeights up = low_pass_weights(tau_s, x.rate_Hz), down = low_pass_weights(tau_s * ratio, x.rate_Hz);
  CTerm t;
  t.title = fmt::format("lag: one pole of {:g} s up and {:g} s down, share {:g}", tau_s, tau_s * ratio, c);
  t.constants = constant("k_" + id + "_c", c) + constant("k_" + id + "_up_old", up.to_old) + constant("k_" + id + "_up_new", up.to_new) +
                constant("k_" + id + "_down_old", down.to_old) + constant("k_" + id + "_down_new", down.to_new);
  t.prepare = prepare_pole(id, fmt::format("(falls ? k_{0}_down_old : k_{0}_up_old)", id), fmt::format("falls ? k_{0}_down_new : k_{0}_up_new", id),
                           fmt::format("    const int falls = c->{0}_x < c->{0}_y - {1} * (c->{0}_y < 0.0f ? -c->{0}_y : c->{0}_y);\n", id, c_float(kSettled)));
  put_lag_behind(id, t);
  t.slope_min = -c * (1.0 - std::min(up.to_new, down.to_new));
  t.once = 15;
  return t;
}

Result<CTerm> lag_sooner_under_load(const ModelEffect& e, const CTermContext& x) {
  if (!x.knows_lowest)
    return refuse("lag of form " + e.form, "the model file does not say at which force its time constant is what it says",
                  "lowest_N under [law] says it, which forcegate fit writes; or give the campaign with --fit");
  const double tau_s = shape_of(e, 0), unloaded = shape_of(e, 1), c = strength_of(e, 0);
  const std::string& id = x.id;
  const double zero_N = x.no_load_N(), floor_N = unloaded * x.span_N, middle_N = x.lowest_N - zero_N + 0.5 * x.span_N + floor_N;
  const double per_N = 1.0 / (tau_s * middle_N * x.rate_Hz);
  CTerm t;
  t.title = fmt::format("lag: one pole of {:g} s at {:g} N and sooner above, share {:g}", tau_s, middle_N - floor_N + zero_N, c);
  t.constants = constant("k_" + id + "_c", c) + constant("k_" + id + "_zero", zero_N) + constant("k_" + id + "_floor", floor_N) + constant("k_" + id + "_per", per_N);
  t.prepare = prepare_pole(id, "half", "half",
                           fmt::format("    const float h = (fg_max(c->{0}_x - k_{0}_zero, 0.0f) + k_{0}_floor) * k_{0}_per;\n"
                                       "    const float half = h < 0.25f ? 0.5f * h / (1.0f + h * (0.5f + h * (1.0f / 12.0f))) : 0.5f - 0.5f * fg_exp(-h);\n",
                                       id));
  put_lag_behind(id, t);
  t.slope_min = -c * (1.0 + 0.5 * std::expm1(-floor_N * per_N));
  t.once = 70;
  t.needs_exp = true;
  return t;
}

CTerm lag_of_two_poles(const ModelEffect& e, const CTermContext& x) {
  const double tau_s = 0.5 * shape_of(e, 0), c = strength_of(e, 0);
  const std::string& id = x.id;
  const LowPassWeights w = low_pass_weights(tau_s, x.rate_Hz);
  CTerm t;
  t.title = fmt::format("lag: two poles of {:g} s, share {:g}", tau_s, c);
  t.constants = constant("k_" + id + "_c", c) + constant("k_" + id + "_old", w.to_old) +
                constant("k_" + id + "_new", w.to_new);
  t.state = fmt::format("  float {0}_y, {0}_z, {0}_x, {0}_a, {0}_b;\n", id);
  t.prepare = fmt::format(
      "  if (c->running) {{\n"
      "    const float a = c->{0}_y + (k_{0}_old * (c->{0}_x - c->{0}_y) - k_{0}_new * c->{0}_y);\n"
      "    c->{0}_a = c->{0}_z + (k_{0}_old * (c->{0}_y - c->{0}_z) + k_{0}_new * (a - c->{0}_z));\n"
      "    c->{0}_b = k_{0}_new * k_{0}_new;\n"
      "  }} else {{\n"
      "    c->{0}_a = 0.0f;\n"
      "    c->{0}_b = 1.0f;\n"
      "  }}\n",
      id);
  t.value = fmt::format("c->shrink * k_{0}_c * (c->{0}_a + (c->{0}_b - 1.0f) * F)", id);
  t.commit = fmt::format(
      "  if (c->running) {{\n"
      "    const float y = c->{0}_y + (k_{0}_old * (c->{0}_x - c->{0}_y) + k_{0}_new * (F - c->{0}_y));\n"
      "    c->{0}_z += k_{0}_old * (c->{0}_y - c->{0}_z) + k_{0}_new * (y - c->{0}_z);\n"
      "    c->{0}_y = y;\n"
      "  }} else {{\n"
      "    c->{0}_y = c->{0}_z = F;\n"
      "  }}\n"
      "  c->{0}_x = F;\n",
      id);
  t.slope_min = -c * (1.0 - w.to_new * w.to_new);
  t.once = 24;
  t.each = 4;
  t.bytes = 20;
  return t;
}

}  // namespace

Result<CTerm> lag(const ModelEffect& e, const CTermContext& x) {
  constexpr std::string_view kSlow = "slow_";  // the same kernel, with time constants of seconds and more
  const std::string form = e.form.starts_with(kSlow) ? e.form.substr(kSlow.size()) : e.form;
  if (form == "two_poles") return lag_of_two_poles(e, x);
  if (form == "two_speeds") return lag_of_two_speeds(e, x);
  if (form == "sooner_under_load") return lag_sooner_under_load(e, x);
  const double tau = shape_of(e, 0), c = strength_of(e, 0);
  const std::string& id = x.id;
  std::vector<double> taus{tau}, weights{c};
  double through = 1.0;  // share of F that the modes carry
  if (form == "diffusive") {
    taus.clear();
    weights.clear();
    double total = 0.0;
    for (int k = 0; k < 4; ++k) {
      const double odd = 2.0 * k + 1.0, w = 8.0 / (std::numbers::pi * std::numbers::pi * odd * odd);
      taus.push_back(tau / (odd * odd));
      weights.push_back(c * w);
      total += w;
    }
    through = total;
  }
  CTerm t = relaxations(id, taus, weights, false, true, x.rate_Hz);
  if (t.bytes == 0) return t;
  t.constants += constant("k_" + id + "_share", c * through);
  t.value = fmt::format("c->shrink * ({} - k_{}_share * F)", t.value, id);
  double direct = 0.0;
  for (std::size_t k = 0; k < taus.size(); ++k)
    direct += weights[k] * low_pass_weights(taus[k], x.rate_Hz).to_new;
  t.slope_min = direct - c * through;
  t.each += 3;
  t.title = fmt::format("lag: {}, tau {:g} s, share {:g}", e.form, tau, c);
  return t;
}

}  // namespace c_terms
}  // namespace forcegate
