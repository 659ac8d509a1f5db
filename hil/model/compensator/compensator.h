#pragma once
// The inverse of a fitted model as one C11 header for a microcontroller: voltage (or whatever the model takes, output_unit) in, force out. No heap, no libm, no
// double, a fixed bound on the work of a sample. The model in newtons, u = G U + F0:
//
//   u = F_low + D (F - F_low) + sum_j e_j(F, history)
//
// is solved for F by at most 12 evaluations of its right side (Illinois variant of regula falsi, Dowell and Jarratt 1971);
// the right side grows with F, which is checked when the header is made (of a user's equation by trying it, user_slope.h). F_low follows from the lowest settled u less what
// the effects added there. What a calibration by straight line and decay makes of a sensor that has these effects is known
// from the model and taken back (CalibrationMap).

#include <string>
#include <vector>

#include "hil/model/compensator/c_term.h"
#include "hil/model/model.h"

namespace forcegate {

/// Calibration values as measured by a protocol that knows nothing of the effects -> those of the model's law.
///   G = G'/alpha,  F0 = (F0' - beta)/alpha,  b = b0 + b1 b' + b2 q',  q = q0 + q1 b' + q2 q'   (b, q: scales of eq. 5)
struct CalibrationMap {
  bool known = false;
  double alpha = 1.0, beta_N = 0.0;
  double b[3] = {0.0, 1.0, 0.0}, q[3] = {0.0, 0.0, 1.0};
  double residual_pct = 0.0;  ///< largest misfit of the affine map over the range it was made for
  std::string protocol;       ///< one line: sweeps, identification record
};

struct CompensatorOptions {
  double rate_Hz = 1000.0;
  double reference_temperature_C = kMissing;  ///< where a thermal effect is zero, of a model that does not say
  CalibrationMap calibration;
  std::vector<std::string> provenance;  ///< lines for the header comment
};

struct Compensator {
  std::string header;
  std::string id;                    ///< "creep+lag", at most 17 characters: becomes part of the algorithm id
  std::vector<std::string> effects;  ///< titles
  int operations = 0;                ///< floating-point operations of one sample, at most
  std::size_t state_bytes = 0;
  double noise_gain = 1.0;  ///< how much one sample's noise is amplified at rest, at most
  bool needs_temperature = false;
};

/// What U is where the model does not take volts: "the conductance in S, 1/R"; "" for volts.
std::string input_in_words(const Model& model);

/// Errors (config): an effect that cannot be inverted, by name and with the reason.
Result<Compensator> make_compensator(const Model& model, const CompensatorOptions& options);

}  // namespace forcegate
