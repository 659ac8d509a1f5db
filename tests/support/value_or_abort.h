#pragma once

#include <cstdlib>
#include <iostream>
#include <utility>

#include "hil/base/result.h"

namespace forcegate::test {

/// For what a test cannot go on without.
template <class T>
T value_or_abort(Result<T> result) {
  if (!result) {
    std::cerr << result.error().to_text() << '\n';
    std::abort();
  }
  return std::move(*result);
}

}  // namespace forcegate::test
