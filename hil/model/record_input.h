#pragma once
// One recording as models and effects see it: rows (block means, at most 50 a second) beside the full-rate force
// for the fast effects, and what the campaign knows about it. Built once by make_campaign_input (hil/model/rows.h).

#include <cstdint>
#include <string>
#include <vector>

#include "hil/trace/campaign.h"

namespace forcegate {

constexpr double kLateAngle_s = 0.005;

/// From an instant on a record lacks so many blocks of samples of the output, counted from its start.
struct LostBlocks {
  double from_s = 0.0, blocks = 0.0;
};

struct RecordInput {
  std::string name, kind;
  bool heldout = false;
  std::size_t index = 0;      ///< place in campaign time
  std::size_t recording = 0;  ///< the same for all blocks of one recording: they share its history

  // rows; a channel that the record does not have is empty
  double row_step_s = 0.02;
  std::vector<double> t_s;           ///< from the start of the record
  std::vector<double> F_N, U_V;      ///< reference force and sensor output
  std::vector<double> rate_N_per_s;  ///< central difference of F_N
  std::vector<double> theta_rad, temp_C, humidity, C_F, F_cmd_N, drive_V;  ///< the angle goes on over a full turn
  /// Means of sin th and cos th over each row, and of cos th behind a pole of kLateAngle_s: an angle turns within a row, and wraps
  std::vector<double> sin_theta, cos_theta, late_cos_theta;
  std::vector<std::uint8_t> ok;  ///< 0: the row touches a gap, a missing or a masked sample

  // full rate, for delay, lag, RC
  std::vector<double> fast_t_s, fast_F_N;
  std::vector<std::uint32_t> row_begin;  ///< first fast sample of each row, and the end

  // excitation
  bool dynamic = false;          ///< cyclic loading, to which the decay applies
  bool dynamic_assumed = false;  ///< nobody declared it: the base fit decides from the output
  bool found_static = false;     ///< it moves to and fro, nobody declared it, and its swing does not decay
  double onset_s = 0.0;          ///< start of the excitation
  double clock_start_s = 0.0;    ///< what the record's clock showed at its first sample; t_s begins at 0
  double f_Hz = 0.0, A_N = 0.0;  ///< lowest frequency at the start; half the peak-to-peak force
  double F_min_N = 0.0;          ///< lowest settled force
  /// What else may be meant by it: the lowest force that was touched at all, m - A as declared; those that agree with it are not here
  std::vector<double> other_F_min_N;
  std::vector<double> frequency_jumps_s, jump_log_ratio;  ///< where the cycle frequency changes, ln(f2/f1)
  double jumps_F_min_N = 0.0;                             ///< lowest settled force of a record with such jumps that is not `dynamic`
  std::vector<LostBlocks> lost_blocks;  ///< in rising order, as the output shows them (set before the fits)

  // campaign
  double start_s = 0.0, duration_s = 0.0, rest_before_s = 0.0;
  double cycles_before = 0.0;  ///< since the record before, not recorded
  double drive_mean_V = kMissing;
  std::string mounting_name;  ///< as declared
  int mounting = -1;          ///< number in the order of the records; -1: not declared
  double travel_before_N = 0.0;  ///< sum |dF| of all earlier records, and of the cycles between them that nobody recorded
  std::vector<double> travel_N;  ///< the same continued through this record, per row

  // state of the base law at the current parameters (set by the base fit)
  std::vector<double> decay;  ///< D(t), 1 in static records

  // rig channel: force that the linear rig law predicts from angle or command; empty without a witness
  std::vector<double> rig_force_N;
  /// What the zero of the reference is above the rig's law, its mean over the record and slow waves; empty where the rig does not tell
  std::vector<double> rig_zero_N;
  double eccentricity_mm = kMissing, preload_mm = kMissing;

  /// Rows whose entries in an effect's columns are read, in rising order; empty: all. Effects that keep no memory pass over
  /// the others.
  std::vector<std::uint32_t> wanted;

  std::size_t rows() const { return t_s.size(); }
  /// Calls `visit(row)` for the wanted rows.
  template <class Visit>
  void for_each_wanted(const Visit& visit) const {
    if (wanted.empty())
      for (std::size_t i = 0; i < rows(); ++i) visit(i);
    else
      for (const std::uint32_t i : wanted) visit(std::size_t{i});
  }
  /// Base force F_min + D (F - F_min), newtons.
  double base_force_N(std::size_t row) const { return F_min_N + decay[row] * (F_N[row] - F_min_N); }
};

/// Force at which the film is unloaded: 0, unless the reference was tared under load and reads below zero by more than a zero that drifts does.
inline double no_load_N(double lowest_N, double span_N) {
  constexpr double kDrift = 0.05;  // of the span
  return lowest_N < -kDrift * span_N ? lowest_N : 0.0;
}

struct CampaignInput {
  std::string name;
  BenchFacts bench;
  std::vector<RecordInput> records;  ///< in campaign time
  double range_N = 5.0;              ///< span of the force, 0.1 to 99.9 %
  double lowest_N = 0.0;
  double U_range_V = 10.0;  ///< span of the output, same quantiles
  double U_step_V = 0.0;    ///< step of the output's values where all records show the same; 0: none is visible
  double travel_total_N = 1.0;
  /// Where the effects of the air and of the drive are zero; missing: at the mean of the records (hil/model/model_frame.h)
  double reference_temp_C = kMissing, reference_humidity_pct = kMissing, reference_drive_V = kMissing;
  bool in_counts = false;   ///< the output is codes of its converter: V stands for one of them
  bool has_theta = false, has_temp = false, has_humidity = false, has_drive = false, has_command = false,
       has_capacitance = false;
  bool has_spindle = false;  ///< theta_rad is the way of a spindle: there is no wheel, and has_theta is false (hil/model/spindle.h)
  double block_s = 0.0;  ///< time that the output is behind the reference for each of RecordInput::lost_blocks; negative: before it; 0: none
  int mountings = 0;     ///< how many were declared; 0: some record does not say and its neighbours do not tell
  bool has_start_times = true;  ///< false: nobody wrote down when the records were taken
  bool single = false;   ///< one recording, its records are blocks of it
  bool generic = false;  ///< not a force sensor's campaign: plain input and output columns
  bool undeclared = false;  ///< nobody wrote down what any record is: it may be another machine's, slow or late by much
  std::vector<std::string> notes;

  double no_load_N() const { return forcegate::no_load_N(lowest_N, range_N); }
};

}  // namespace forcegate
