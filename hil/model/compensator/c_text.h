#pragma once
// The parts of the exported header that every model shares.

#include <string>

namespace forcegate::c_text {

/// fg_min, fg_max, fg_clamp ... and those of exp, ln, sqrt, tanh that are needed (relative error below 5e-7).
std::string elementary(bool exponential, bool logarithm, bool root, bool tangent);

/// fg_pow(x, y) of real y and x >= 0 (it calls fg_exp and fg_ln); fg_power(x, n) of whole n > 0 and any x.
std::string powers(bool real, bool whole);

/// fg_comp_residual(c, F): right side less u.
std::string residual();

/// fg_comp_step. `start`: expression for a force to search from while it runs; `reach`: reciprocal of the least slope of the right side at rest.
std::string step(const std::string& prepare, const std::string& commit, const std::string& start, double reach, double step_s,
                 int iterations);

}  // namespace forcegate::c_text
