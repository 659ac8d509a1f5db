#pragma once
// What the truth side knows of one record while it is being made: the plan, the hidden conditions and every
// physical quantity on a fine internal clock. Nothing here is visible to a model of the sensor.

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "rigs/emulated/hidden/climate.h"

namespace forcegate::hidden {

/// One record as the protocol plans it.
struct RecordPlan {
  std::string kind;  ///< "ramp", "staircase", "sine", ... as CAMPAIGN files name them
  double duration_s = 0.0;
  double rate_Hz = 200.0;  ///< of the logged samples
  double start_s = 0.0;    ///< campaign time of the first sample
  double rest_before_s = 0.0;
  double excitation_start_s = 0.0;
  bool dynamic = false;              ///< cyclic loading: the sensor's decay of the maxima acts
  bool wheel = false;                ///< the wheel turns through; otherwise it servoes within half a turn
  double low_N = 0.0, high_N = 0.0;  ///< range of the profile
  double f_min_Hz = 0.0;             ///< lowest frequency at the start of the excitation
  std::vector<double> frequencies_Hz, weights;  ///< of the sines; of a jump, the successive frequencies
  std::vector<double> event_s;                  ///< instants of frequency jumps
  double dwell_s = 0.0;                         ///< of staircase, PRBS and steps
  int repeats = 2;                              ///< triangles of a ramp
  std::vector<double> point_s, point_N;  ///< of a force that was asked for from outside; empty: by the kind
  double drive_V = 5.0;
  int mounting = 0;  ///< counts how often the sensor has been taken off and put back
  std::uint64_t seed = 0, session_seed = 0;
  bool heldout = false;

  double amplitude_N() const { return 0.5 * (high_N - low_N); }
  double mean_N() const { return 0.5 * (high_N + low_N); }
};

/// Sensor, bench and instruments of one record as they truly are.
struct RecordTruth {
  double gain_N_per_V = 0.5, offset_N = -0.1;  ///< F = G U + F0 on static loading
  double b_scale = 1.0, q_scale = 1.0;         ///< of the decay law
  double spring_N_per_mm = 0.25, eccentricity_mm = 10.0, preload_mm = 0.0;
  double wheel_radius_mm = 30.0;
  double reached_low_N = 0.0, reached_high_N = 0.0;  ///< of the settled loading
};

/// What an effect may look at.
struct RecordContext {
  const RecordPlan& plan;
  const RecordTruth& truth;
  const Climate& climate;
  std::size_t index = 0;  ///< in the campaign
  double force_range_N = 5.0;
  double voltage_range_V = 10.0;
};

/// Signals of one record on the internal clock, t = i * step_s.
struct Waves {
  double step_s = 0.001;
  std::vector<double> setpoint_N;       ///< what the controller asks for
  std::vector<double> theta_rad;        ///< true wheel angle
  std::vector<double> travel_mm;        ///< compression of the spring
  std::vector<double> force_N;          ///< true contact force
  std::vector<double> film_N;           ///< force as the film feels it
  std::vector<double> voltage_V;        ///< output of the conditioning circuit
  std::vector<double> reference_N;      ///< force as the reference cell feels it, before its noise
  std::vector<unsigned char> airborne;  ///< 1 while the trolley has left the sensor; empty = never

  std::size_t size() const { return setpoint_N.size(); }
};

/// Logged columns before they are rounded by converters (voltage) or by the reference (force).
struct Samples {
  std::vector<double> instant_s;  ///< when the sample was truly taken
  std::vector<double> stamp_s;    ///< what the recorder wrote
  std::vector<double> voltage_V, reference_N, theta_rad, setpoint_N;

  std::size_t size() const { return instant_s.size(); }
};

}  // namespace forcegate::hidden
