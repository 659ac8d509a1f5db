#include <fmt/format.h>

#include <cmath>

#include "hil/model/user_equation.h"

namespace forcegate {

namespace {

// A power that is not whole, a root and a logarithm have no value below zero, where a reference's zero or its noise easily is.
std::string why_without_value(const UserEffect& effect, double value, double F_N, double dF_N_per_s) {
  const auto has = [&](const char* word) { return effect.output.find(word) != std::string::npos; };
  const std::string general = "check divisions and bounds of its equations";
  if (!has("^") && !has("sqrt") && !has("ln") && !has("log")) return general;
  bool has_force = false;
  for (std::size_t at = 0; (at = effect.output.find('F', at)) != std::string::npos; ++at) has_force = has_force || at == 0 || effect.output[at - 1] != 'd';
  if (F_N <= 0.0 && has_force)
    return fmt::format("F is {:.3g} N there: a power that is not whole, a root or a logarithm of it has no value; write abs(F)^1.5 or max(F, 0)^1.5 for F^1.5", F_N);
  if (dF_N_per_s <= 0.0 && has("dF"))
    return fmt::format("dF is {:.3g} N/s there: a power that is not whole, a root or a logarithm of it has no value; write abs(dF)^1.5 for dF^1.5", dF_N_per_s);
  if (std::isnan(value)) return "what stands under a power that is not whole, a root or a logarithm is below 0 there, and has none: write abs(..)^1.5 or max(.., 0)^1.5 for (..)^1.5";
  return general;
}

}  // namespace

Result<std::vector<double>> user_effect_N(const UserEffect& effect, const RecordInput& record) {
  FORCEGATE_TRY(const std::unique_ptr<UserEquation> equation, UserEquation::make(effect));
  UserEquation& e = *equation;
  const auto place = [&](std::size_t of) { return of < effect.places.size() ? effect.places[of] + ", record " + record.name : record.name; };
  const auto needs = [&](const char* name, const char* what, const char* column, const std::vector<double>& channel) -> Result<void> {
    if (!channel.empty() || !e.uses(name)) return {};
    return fail(ErrorCode::config, fmt::format("the effect \"{}\" uses {}, and the record has no {}", effect.name, name, what), place(0),
                fmt::format("record a column {}, or name the one that holds it with --map COLUMN={}", column, column));
  };
  FORCEGATE_CHECK_OK(needs("T", "temperature", "temp_C", record.temp_C));
  FORCEGATE_CHECK_OK(needs("th", "angle", "theta_rad", record.theta_rad));
  const auto set_input = [&](std::size_t i, double share) {
    const std::size_t j = std::min(i + 1, record.rows() - 1);
    const auto between = [&](const std::vector<double>& x) { return x.empty() ? 0.0 : x[i] + share * (x[j] - x[i]); };
    e.F = between(record.F_N);
    e.dF = between(record.rate_N_per_s);
    e.t = between(record.t_s);
    e.T = between(record.temp_C);
    e.th = between(record.theta_rad);
  };
  const std::size_t states = effect.states.size();
  std::vector<double> first_slope(states);
  const auto diverged = [&](std::size_t i) {
    for (std::size_t k = 0; k < states; ++k)
      if (!std::isfinite(first_slope[k]))
        return fail(ErrorCode::config, fmt::format("the derivative of the state {} of the effect \"{}\" has no value at the values written", effect.states[k].first, effect.name),
                    place(k + 1), "nothing may be divided by 0 there, and no root or logarithm be taken of less");
      else if (!std::isfinite(e.state[k]))
        return fail(ErrorCode::config,
                    fmt::format("the state {} of the effect \"{}\" runs away: it is not finite at {:.4g} s", effect.states[k].first, effect.name,
                                record.t_s[i]),
                    place(k + 1), "its derivative must pull it back; a time constant must be longer than a row of the record");
    return fail(ErrorCode::config, fmt::format("the effect \"{}\" gives a value that is not finite at {:.4g} s", effect.name, record.t_s[i]),
                place(0), why_without_value(effect, e.output(), e.F, e.dF));
  };
  std::vector<double> out(record.rows()), start(states), slope(states);
  for (std::size_t i = 0; i < record.rows(); ++i) {
    set_input(i, 0.0);
    out[i] = e.output();
    if (!std::isfinite(out[i])) return diverged(i);
    if (i + 1 == record.rows()) break;
    const double dt = record.t_s[i + 1] - record.t_s[i];
    start = e.state;
    for (std::size_t k = 0; k < states; ++k) slope[k] = e.derivative(k);
    if (i == 0) first_slope = slope;
    for (std::size_t k = 0; k < states; ++k) e.state[k] = start[k] + 0.5 * dt * slope[k];
    set_input(i, 0.5);
    for (std::size_t k = 0; k < states; ++k) slope[k] = e.derivative(k);
    for (std::size_t k = 0; k < states; ++k) e.state[k] = start[k] + dt * slope[k];
  }
  return out;
}

}  // namespace forcegate
