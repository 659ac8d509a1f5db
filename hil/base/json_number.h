#pragma once
// A number of a JSON document. The type of the document is the caller's: hil/base knows no JSON library.

#include <cmath>

namespace forcegate {

/// null where the number is none.
template <class Json>
Json json_number(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

}  // namespace forcegate
