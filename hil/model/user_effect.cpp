#include <cmath>
#include <muParser.h>

#include "hil/model/model.h"

namespace forcegate {

Result<std::vector<double>> user_effect_N(const UserEffect& effect, const RecordInput& record) {
  double F = 0.0, dF = 0.0, t = 0.0, T = 0.0, th = 0.0;
  std::vector<double> state(effect.states.size(), 0.0), parameter;
  for (const ModelParameter& p : effect.parameters) parameter.push_back(p.value);
  const auto prepare = [&](mu::Parser& parser, const std::string& expression) {
    parser.DefineVar("F", &F);
    parser.DefineVar("dF", &dF);
    parser.DefineVar("t", &t);
    parser.DefineVar("T", &T);
    parser.DefineVar("th", &th);
    for (std::size_t k = 0; k < state.size(); ++k) parser.DefineVar(effect.states[k].first, &state[k]);
    for (std::size_t k = 0; k < parameter.size(); ++k)
      parser.DefineVar(effect.parameters[k].name, &parameter[k]);
    parser.SetExpr(expression);
    parser.Eval();
  };
  std::string now = effect.output;
  try {
    mu::Parser output;
    std::vector<mu::Parser> derivative(state.size());
    const auto set_input = [&](double row, double share) {
      const auto i = static_cast<std::size_t>(row);
      const std::size_t j = std::min(i + 1, record.rows() - 1);
      const auto between = [&](const std::vector<double>& x) {
        return x.empty() ? 0.0 : x[i] + share * (x[j] - x[i]);
      };
      F = between(record.F_N);
      dF = between(record.rate_N_per_s);
      t = between(record.t_s);
      T = between(record.temp_C);
      th = between(record.theta_rad);
    };
    set_input(0.0, 0.0);
    prepare(output, effect.output);
    for (std::size_t k = 0; k < state.size(); ++k) {
      now = effect.states[k].second;
      prepare(derivative[k], now);
    }
    std::vector<double> out(record.rows()), start(state.size()), slope(state.size());
    for (std::size_t i = 0; i < record.rows(); ++i) {
      set_input(static_cast<double>(i), 0.0);
      out[i] = output.Eval();
      if (!std::isfinite(out[i]))
        return fail(ErrorCode::config, "the effect \"" + effect.name + "\" gives a value that is not finite",
                    record.name, "check divisions and bounds of its equations");
      if (i + 1 == record.rows()) break;
      const double dt = record.t_s[i + 1] - record.t_s[i];
      start = state;
      for (std::size_t k = 0; k < state.size(); ++k) slope[k] = derivative[k].Eval();
      for (std::size_t k = 0; k < state.size(); ++k) state[k] = start[k] + 0.5 * dt * slope[k];
      set_input(static_cast<double>(i), 0.5);
      for (std::size_t k = 0; k < state.size(); ++k) slope[k] = derivative[k].Eval();
      for (std::size_t k = 0; k < state.size(); ++k) state[k] = start[k] + dt * slope[k];
    }
    return out;
  } catch (const mu::Parser::exception_type& error) {
    return fail(ErrorCode::config, "the equation cannot be read: " + error.GetMsg(), effect.name + ": " + now,
                "known names: F, dF, t, T, th, the states and the parameters");
  }
}

}  // namespace forcegate
