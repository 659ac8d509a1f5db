#pragma once
// One effect of a model as C: what stands in the compensator's state, what is prepared once a sample, what the effect adds
// for a candidate force F, and what is kept once the force is found.

#include <cstddef>
#include <string>

#include "hil/base/result.h"
#include "hil/model/model.h"
#include "hil/trace/campaign.h"

namespace forcegate {

struct CTerm {
  std::string title;       ///< for the header comment
  std::string constants;   ///< definitions, file scope
  std::string state;       ///< members of the struct; zero after a reset
  std::string prepare;     ///< statements; may write to the state's scratch members
  std::string value;       ///< expression in F (candidate), W (decayed), c->shrink: newtons
  std::string commit;      ///< statements in F, W
  std::string start;       ///< expression for a force to search from, better than the one before; empty: none
  double slope_min = 0.0;  ///< lower bound of d value / dF without decay
  double margin = 0.0;     ///< of it: what was found lies higher by so much
  std::string falls;       ///< where the output falls or stands as the force rises, in words; empty: nowhere, or not looked for
  int once = 0;            ///< floating-point operations of prepare and commit
  int each = 0;            ///< of value
  std::size_t bytes = 0;   ///< of state
  bool needs_temperature = false;
  bool needs_exp = false, needs_ln = false, needs_sqrt = false, needs_tanh = false,
       needs_pow = false, needs_power = false;
};

struct CTermContext {
  std::string id;  ///< "e0": prefix of members and constants
  double rate_Hz = 1000.0;
  double span_N = 5.0;  ///< what the shares in the shapes refer to
  double lowest_N = 0.0;      ///< 0 where the model does not say it
  bool knows_lowest = false;
  double reference_temperature_C = kMissing;  ///< temperature at which a thermal effect is zero

  double no_load_N() const { return forcegate::no_load_N(lowest_N, span_N); }
};

/// Errors (config): the effect cannot be inverted on a microcontroller, with the reason and what to do instead.
Result<CTerm> c_term(const ModelEffect& effect, const CTermContext& context);
Result<CTerm> c_term(const UserEffect& effect, const CTermContext& context);

/// Weights of the linear pieces of a low pass: y += to_old (x_before - y) + to_new (x - y), exact for x linear between
/// samples (hil/model/states.h).
struct LowPassWeights {
  double to_old = 0.0, to_new = 1.0;
};
LowPassWeights low_pass_weights(double tau_s, double rate_Hz);

}  // namespace forcegate
