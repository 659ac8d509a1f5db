#pragma once
// Whether the records show what was added to a model.

#include <string>
#include <vector>

#include "hil/diagnose/refit/refit.h"

namespace forcegate {

struct WeakAddition {
  bool is_shown = true;               ///< false: of no strength beyond its uncertainty, or no error falls
  std::vector<std::string> warnings;  ///< one sentence each
};

/// `added` empty: a refit, nothing to be said. A strength is none within two of its standard errors of 0 (all of them, where there are several; of an equation each that is none is warned of);
/// errors do not fall where the adapted one keeps 98 % and the plain one all. A shape at an end of its range is warned of, and shown all the same.
WeakAddition weak_addition(const diagnose::Refit& refit, const std::string& added);

/// Sentences on fitted shapes of an equation of the user's own that lie at an end of what they may be.
std::vector<std::string> shapes_at_their_ends(const UserEffect& own);

}  // namespace forcegate
