#pragma once
// A force profile: a pure function of time in newtons. One file each in stimuli/.

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "hil/base/registry.h"
#include "hil/base/result.h"

namespace forcegate {

/// What every report says about a profile. NaN where the profile has no such number.
struct StimulusFacts {
  double mean_N = 0.0;               ///< m: middle of the settled profile
  double amplitude_N = 0.0;          ///< A: half of the peak-to-peak force of the settled profile
  double lowest_frequency_Hz = 0.0;  ///< f: lowest frequency at the start of the excitation; 0 = none
  double excitation_start_s = 0.0;   ///< end of the ramp-in
  double minimum_N = 0.0;            ///< bounds of the whole profile, ramp-in included
  double maximum_N = 0.0;
  bool dynamic = false;  ///< cyclic loading, to which eq. (3)-(7) apply
};

class Stimulus {
 public:
  virtual ~Stimulus() = default;

  /// Set-point at time t_s in [0, duration_s()], newtons. Pure: same t, same bits, any order of calls.
  virtual double force_N(double t_s) const = 0;
  virtual double duration_s() const = 0;
  virtual StimulusFacts facts() const = 0;

  /// force_N(first_t_s + i * step_s) for i in [0, n); a profile may override it with something faster
  /// that differs by less than 1e-9 N and is itself pure.
  virtual void fill(double first_t_s, double step_s, std::size_t n, double* out_N) const {
    for (std::size_t i = 0; i < n; ++i) out_N[i] = force_N(first_t_s + static_cast<double>(i) * step_s);
  }
};

/// Parameters by name as a plan or a command line gives them ("f_Hz" = 0.5). Lists for multisine.
struct StimulusSpec {
  std::string name;
  std::map<std::string, double> numbers;
  std::map<std::string, std::vector<double>> lists;
  std::map<std::string, std::string> texts;  ///< "path" of a replayed recording
  std::uint64_t seed = 1;
};

struct StimulusParameter {
  std::string name;  ///< with its unit suffix: "A_N", "f_Hz"
  std::string unit;
  double fallback;  ///< NaN: must be given
  double minimum, maximum;
  std::string doc;
  bool is_list = false;
  bool is_text = false;
};

/// Registry entry of a profile.
struct StimulusKind {
  std::string name;
  std::string doc;  ///< one sentence and the formula
  std::vector<StimulusParameter> parameters;
  std::function<Result<std::unique_ptr<Stimulus>>(const StimulusSpec&)> make;
};

/// Fills in fallbacks, refuses unknown names (with a suggestion), values out of range and a record that ends inside
/// its loading ramp, then makes it.
Result<std::unique_ptr<Stimulus>> make_stimulus(StimulusSpec spec);

}  // namespace forcegate
