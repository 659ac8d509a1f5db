#pragma once
// Constants of a law that no sensor has: the maxima would grow without end, or the output turn over.

#include <optional>
#include <string>
#include <vector>

#include "hil/model/base_law.h"

namespace forcegate {

struct NoDecay {
  std::string text, hint;
  std::vector<const char*> keys;  ///< of [law], that which is to blame first
};

/// A law that decays has b >= 0 from 0 to 25 Hz, above 0 somewhere, and q > 0 at a swing over the whole span. nullopt: it has, or it is static.
std::optional<NoDecay> no_decay(const BaseLaw& law, double span_N);

}  // namespace forcegate
