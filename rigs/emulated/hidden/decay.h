#pragma once
// Loss of the maxima under cyclic loading, in the variants that the truth side draws from. All keep the
// minima and the static law F = G U + F0; they differ in how rate and remaining share depend on the loading.

#include <string>
#include <string_view>
#include <vector>

#include "rigs/emulated/hidden/waves.h"

namespace forcegate::hidden {

enum class DecayLaw {
  ratio,          ///< b = 0.0019 f + 0.0056 1/s, q = 1 / (1 + 1.377 A^2) (Lebosse 2011, eq. 5)
  root_f,         ///< b = 0.0040 + 0.0033 sqrt(f), q as above
  exponential_A,  ///< q = 0.96 exp(-0.80 A), b as eq. (5)
  state_driven,   ///< rate follows the running loading rate, floor the running minimum
  absolute,       ///< a and c in volts of eq. (5): the gain jumps at the start of the excitation
};

std::string_view to_string(DecayLaw law);

/// Writes voltage_V from film_N: U = (W - F0) / G with W = F below Fmin, what the film feels at the lowest force of the settled cycles, and
/// Fmin + g D (F - Fmin) above it; D = (x + q) / (1 + q), x = exp(-b t) from the excitation's start, D = 1 in
/// static records. Time away from contact rewinds x.
void apply_decay(DecayLaw law, Waves& waves, const RecordContext& context);

}  // namespace forcegate::hidden
