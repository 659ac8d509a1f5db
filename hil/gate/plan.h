#pragma once
// What is to be played, on which specimens, and what is required of the firmware. docs/plan.md is the
// reference of the file.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "hil/base/result.h"
#include "hil/gate/rule.h"
#include "hil/interface/calibration.h"
#include "hil/interface/stimulus.h"
#include "hil/rig/safety_gate.h"
#include "hil/rig/self_check.h"

namespace forcegate {

inline constexpr int kPlanFormat = 1;

enum class LoopMode { open, closed };
std::string_view to_string(LoopMode mode);

/// Kinds of check a case can ask for (docs/gate.md, 4).
enum CaseCheck : unsigned {
  kCheckConformance = 1u << 0,  ///< (a) against an independent implementation of the declared algorithm
  kCheckPromise = 1u << 1,      ///< (b) closed loop: ATI against set-point, mean over the panel
  kCheckAccuracy = 1u << 2,     ///< (c) firmware against ATI, limit derived or given by the case
  kCheckHold = 1u << 3,         ///< (f) no amplification of a static hold
  kCheckGolden = 1u << 4,       ///< (e) golden traces: rig truth, and the firmware of the same algorithm
};

struct PlanCase {
  std::string name;  ///< "sine_f0.50_A1.50_m2.70"
  std::string title;
  std::string source;     ///< "Lebosse 2011, Table II" or "ours"
  StimulusSpec stimulus;  ///< its duration is in there, see Stimulus::duration_s
  LoopMode loop = LoopMode::open;
  std::string lane;        ///< "tick", "uart": only for images that run there; "" = the image's own
  std::string controller;  ///< default: "open_loop" or "force_integral"
  unsigned checks = 0;     ///< of CaseCheck; coverage, link, output and rig checks are always made
  std::vector<std::string> specimens;  ///< empty: the panel
  double rest_before_s = 7200.0;
  double prelude_s = 0.0;  ///< of a session with other calibration and hostile codes, ended by RESET; 0: none
  double prominence_N = 0.0;                     ///< of a turning point; 0: a quarter of the amplitude
  double half_width_s = 0.005;                   ///< averaging of an extremum
  double tail_s = 0.0;                           ///< promise and accuracy only over the last tail_s; 0: all
  std::optional<double> maxima_pct, minima_pct;  ///< limits given by the plan
  std::string limit_source;
  std::string where;  ///< position in the file
};

/// Dynamic record from which b and q = c/a of a specimen are identified.
struct PlanIdentification {
  StimulusSpec stimulus;
  std::string source;
};

struct PlanCalibration {
  CalibrationLevel level = CalibrationLevel::identified;
  double sweep_low_N = 0.3, sweep_high_N = 4.0;
  double sweep_s = 60.0;  ///< one sweep up and down
  int sweeps = 2;
  double rest_s = 7200.0;  ///< of the specimen before and after each record
  std::optional<PlanIdentification> identification;
};

struct PlanLimits {
  std::string derived;          ///< path of the limits file, relative to the plan; "" = none
  std::string derived_where;    ///< position of that line in the file
  std::string goldens;          ///< folder of the golden traces, relative to the plan; "" = none
  double learning_s = 20.0;     ///< longest start window
  double lag_s = 0.05;          ///< |lag| of the firmware behind the ATI
  double output_max_N = 10.0;   ///< |F_dut|
  double spike_max_N = 0.5;     ///< one sample beside its neighbours where the code has no spike
  double excursion_max_N = 1.5;  ///< error of one extremum beyond the median of those around it
  double hold_pct = 5.0;        ///< |F_dut| over the static value during a hold, in excess
  double minima_floor_N = 0.5;  ///< below: mean absolute error instead of relative
  double increase_pct = 0.5;    ///< of a mean relative error against the accepted build, percentage points
  double instructions = 0.0;    ///< of one sample, worst case; 0 here and below: reported, not judged
  double stack_bytes = 0.0, ram_bytes = 0.0, flash_bytes = 0.0;  ///< ram: static data and stack
};

/// What the budget of uncertainty takes from elsewhere than the record.
struct PlanUncertainty {
  double reference_rel = 0.0;    ///< relative, k = 1; 0: what the rig declares
  double alignment_rel = 0.002;  ///< sensor axis against ATI axis: 1 - cos 3.6 deg
  /// Standard deviation of the MRE of one specimen from session to session, calibration and identification
  /// included. Emulated rig, level identified: 1.2 over 9 specimens x 15 sessions; 1.3 has a margin.
  double record_repeat_pct = 1.3;
};

/// Only what the rig spoiled is played again, never what the firmware failed.
struct PlanRetry {
  int attempts = 2;  ///< at a record or calibration, the first included
};

struct Plan {
  std::string name, doc;
  std::filesystem::path path;
  std::string sha256;
  std::uint64_t seed = 1;
  DecisionRule rule;
  PlanRetry retry;
  std::vector<std::string> panel;
  PlanCalibration calibration;
  SafetyLimits safety;
  PlanLimits limits;
  PlanUncertainty uncertainty;
  SelfCheckLimits self_check;
  std::vector<PlanCase> cases;
};

/// Reads and checks a plan; stimuli are made once, so that a wrong parameter is found here with its position.
/// Error code config.
Result<Plan> parse_plan(std::string_view text, const std::string& name);
Result<Plan> read_plan(const std::filesystem::path& path);

/// Specimens of a case: its own or the panel's.
const std::vector<std::string>& specimens_of(const Plan& plan, const PlanCase& planned);

}  // namespace forcegate
