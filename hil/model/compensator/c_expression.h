#pragma once
// Equations of a user's effect as C: the grammar of muParser that a microcontroller can evaluate without libm.

#include <map>
#include <set>
#include <string>
#include <string_view>

#include "hil/base/result.h"

namespace forcegate {

struct CExpression {
  std::string text;  ///< C11, single precision
  std::set<std::string>
      functions;       ///< of fg_exp, fg_ln, fg_sqrt, fg_tanh, fg_pow, fg_power: what the text calls besides fg_min, fg_max
  int operations = 0;  ///< floating-point operations of one evaluation, an upper bound
};

/// `names`: identifiers allowed, each with what stands for it in C ("tau" -> "kUser0_tau"). Known: + - * / ^ with
/// parentheses, comparisons, && ||, ?:, exp ln sqrt abs min max sign tanh. A whole power is a product, of
/// negative numbers too; another one is refused where its base may be negative. Errors (config) name the function or the
/// identifier that cannot go on a microcontroller, and its place in the equation.
Result<CExpression> c_expression(std::string_view equation, const std::string& where,
                                 const std::map<std::string, std::string>& names);

/// "0.25f", "1.0e-06f": the shortest text that gives this float; never an integer.
std::string c_float(double value);

}  // namespace forcegate
