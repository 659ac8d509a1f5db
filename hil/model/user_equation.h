#pragma once
// The equations of a user's effect, parsed once and evaluated at any instant.

#include <memory>
#include <string>
#include <vector>

#include "hil/base/result.h"
#include "hil/model/model.h"

namespace forcegate {

class UserEquation {
 public:
  /// Error (config) with muparser's message and position when an equation cannot be read; its place is that in the file.
  static Result<std::unique_ptr<UserEquation>> make(const UserEffect& effect);
  ~UserEquation();
  UserEquation(const UserEquation&) = delete;
  UserEquation& operator=(const UserEquation&) = delete;

  /// Inputs: N, N/s, s, degC, rad. They and the states are set by the caller.
  double F = 0.0, dF = 0.0, t = 0.0, T = 0.0, th = 0.0;
  std::vector<double> state;

  /// Newtons added.
  double output() const;
  /// Derivative of a state, per second.
  double derivative(std::size_t k) const;
  /// True when one of the equations reads this input.
  bool uses(const std::string& name) const;

 private:
  struct Parsers;  // which refer to the inputs and states above
  UserEquation();
  std::unique_ptr<Parsers> parsers_;
};

/// Names that the equations know: a parameter or a state cannot have them.
const std::vector<std::string>& user_inputs();

}  // namespace forcegate
