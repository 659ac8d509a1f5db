#include "hil/model/user_equation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <muParser.h>
#include <string_view>
#include <vector>

namespace forcegate {

const std::vector<std::string>& user_inputs() {
  static const std::vector<std::string> kNames = {"F", "dF", "t", "T", "th"};
  return kNames;
}

struct UserEquation::Parsers {
  std::vector<double> parameter;
  mu::Parser output;
  std::vector<mu::Parser> derivative;
};

UserEquation::UserEquation() : parsers_(std::make_unique<Parsers>()) {}
UserEquation::~UserEquation() = default;
double UserEquation::output() const { return parsers_->output.Eval(); }
double UserEquation::derivative(std::size_t k) const { return parsers_->derivative[k].Eval(); }

namespace {

// The parser's own '=' would write into the input or parameter that it names.
bool assigns(const std::string& expression) {
  for (std::size_t i = 0; i < expression.size(); ++i) {
    if (expression[i] != '=') continue;
    if (i + 1 < expression.size() && expression[i + 1] == '=') {
      ++i;
      continue;
    }
    if (i == 0 || std::string_view("<>!").find(expression[i - 1]) == std::string_view::npos) return true;
  }
  return false;
}

// Beside the arguments of a function a comma parts expressions, of which the parser takes the last.
bool parts_expressions(const std::string& expression) {
  std::vector<bool> of_call;  // of the brackets that are open
  for (std::size_t i = 0; i < expression.size(); ++i) {
    if (expression[i] == '(') of_call.push_back(i > 0 && (std::isalnum(static_cast<unsigned char>(expression[i - 1])) != 0 || expression[i - 1] == '_'));
    if (expression[i] == ')' && !of_call.empty()) of_call.pop_back();
    if (expression[i] == ',' && (of_call.empty() || !of_call.back())) return true;
  }
  return false;
}

}  // namespace

Result<std::unique_ptr<UserEquation>> UserEquation::make(const UserEffect& effect) {
  std::unique_ptr<UserEquation> out(new UserEquation);
  Parsers& p = *out->parsers_;
  out->state.assign(effect.states.size(), 0.0);
  for (const ModelParameter& parameter : effect.parameters) p.parameter.push_back(parameter.value);
  p.derivative.resize(effect.states.size());
  const auto prepare = [&](mu::Parser& parser, const std::string& expression) {
    parser.DefineVar("F", &out->F);
    parser.DefineVar("dF", &out->dF);
    parser.DefineVar("t", &out->t);
    parser.DefineVar("T", &out->T);
    parser.DefineVar("th", &out->th);
    for (std::size_t k = 0; k < effect.states.size(); ++k) parser.DefineVar(effect.states[k].first, &out->state[k]);
    for (std::size_t k = 0; k < effect.parameters.size(); ++k) parser.DefineVar(effect.parameters[k].name, &p.parameter[k]);
    if (assigns(expression)) throw mu::Parser::exception_type("it assigns; a comparison is ==");
    if (parts_expressions(expression)) throw mu::Parser::exception_type("a comma stands between numbers; decimals have a point");
    parser.SetExpr(expression);
    parser.Eval();
  };
  std::string now = effect.output;
  std::size_t number = 0;
  try {
    prepare(p.output, now);
    for (std::size_t k = 0; k < effect.states.size(); ++k) {
      now = effect.states[k].second;
      number = k + 1;
      prepare(p.derivative[k], now);
    }
  } catch (const mu::Parser::exception_type& error) {
    constexpr std::size_t kShown = 120;
    const std::string equation = effect.name + ": " + (now.size() > kShown ? fmt::format("{}... ({} characters)", now.substr(0, kShown), now.size()) : now);
    const bool from_file = number < effect.places.size();
    return fail(ErrorCode::config, "the equation cannot be read: " + error.GetMsg() + (from_file ? " (" + equation + ")" : ""),
                from_file ? effect.places[number] : equation,
                "known names: F, dF, t, T, th, the states and the parameters; functions: exp, ln, log10, sqrt, abs, sign, min, max, "
                "sin, cos, tan, asin, acos, atan, sinh, cosh, tanh, rint; a power is x^y, a case is condition ? x : y");
  }
  return out;
}

bool UserEquation::uses(const std::string& name) const {
  const auto reads = [&](const mu::Parser& parser) { return parser.GetUsedVar().count(name) > 0; };
  return reads(parsers_->output) || std::any_of(parsers_->derivative.begin(), parsers_->derivative.end(), reads);
}

}  // namespace forcegate
