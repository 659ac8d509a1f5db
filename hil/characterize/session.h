#pragma once
// What one specimen in one session gave: named values, decays, curves for pictures; and how procedures get at it.

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hil/base/registry.h"
#include "hil/base/result.h"
#include "hil/characterize/bench.h"
#include "hil/characterize/maxima.h"
#include "hil/characterize/study_plan.h"
#include "hil/interface/calibration.h"

namespace forcegate::characterize {

/// One number of the data sheet. `key` is stable ("static.gain"), the title is for people.
struct Measurement {
  std::string key, title, unit;
  double value = 0.0;
};

/// Columns of equal length over time or force, reduced for pictures and golden traces.
struct Curve {
  std::string name;                      ///< "fig6"
  std::vector<std::string> columns;      ///< "t_s", "setpoint_N", "ati_N", "sensor_V", "estimate_N"
  std::vector<std::vector<float>> data;  ///< one a column
  double zero_s = 0.0;                   ///< t_s from which a picture counts
  const std::vector<float>* find(std::string_view column) const;
};

struct SessionSheet {
  std::string specimen;
  std::uint64_t session = 0;
  std::optional<Error> failure;  ///< of the rig; the values up to then stand
  std::vector<Measurement> values;
  std::vector<DecayRecord> decays;
  std::vector<Curve> curves;  ///< only where wanted
  Calibration calibration;    ///< G and F0; b_scale and q_scale where identified
  std::string assumed_converter;  ///< "adc_bits = 16, v_range_V = 10": what of the calibration nobody stated
  double calibration_rmse_N = 0.0;
  std::uint64_t samples = 0;
  std::vector<std::string> notes;  ///< what a reader of the values must know, one sentence each

  const Measurement* find(std::string_view key) const;
  double value(std::string_view key) const;  ///< NaN when not measured
};

/// Compensation that force control uses: makes an estimator for a calibration. The flag tells that the start window
/// (f_min and A not yet frozen) is open after the latest sample.
struct Compensation {
  Estimator estimate;
  std::function<bool()> learning;
};
using CompensationMaker = std::function<Compensation(const Calibration&)>;

class Session {
 public:
  Session(Bench& on_bench, const StudyPlan& of_plan, std::string of_sensor, const CompensationMaker& by,
          bool with_curves)
      : bench(on_bench), plan(of_plan), sensor(std::move(of_sensor)), compensation(by), curves(with_curves) {}

  void add(std::string key, std::string title, std::string unit, double value) {
    sheet.values.push_back({std::move(key), std::move(title), std::move(unit), value});
  }
  bool fsr() const { return sensor == "fsr"; }
  /// Force by eq. (1) with this session's calibration.
  double force_N(double sensor_V) const {
    return sheet.calibration.gain_N_per_V * sensor_V + sheet.calibration.offset_N;
  }

  Bench& bench;
  const StudyPlan& plan;
  std::string sensor;  ///< "flexiforce" or "fsr"
  const CompensationMaker& compensation;
  bool curves;
  bool calibrated = false;
  SessionSheet sheet;
};

/// Keys of what a procedure measures on "flexiforce" or "fsr" in a session of a plan: what a limit can be set on.
using KeysOfProcedure = std::function<std::vector<std::string>(const StudyPlan&, std::string_view sensor)>;
inline KeysOfProcedure always(std::vector<std::string> keys) {
  return [keys = std::move(keys)](const StudyPlan&, std::string_view) { return keys; };
}

/// A procedure of the paper: one file each in procedures/.
struct ProcedureKind {
  std::string name;  ///< as the plan lists it
  std::string doc;   ///< what it plays and measures, and where the paper says so
  bool needs_calibration = true;
  std::function<Result<void>(Session&)> run;
  KeysOfProcedure keys = always({});
};

/// All listed procedures in their order, those of StudyPlan::once only in session 0. Never fails: see
/// SessionSheet::failure.
SessionSheet run_session(Session& session, const std::vector<std::string>& procedures);

/// M4-reduced curve of a record: feed it as a sink, then take it. Columns t_s, setpoint_N, ati_N, sensor_V and, in
/// closed loop, estimate_N.
class CurveSink {
 public:
  CurveSink(std::string name, double first_s, double last_s, double volts_per_code, bool closed_loop = false,
            std::size_t columns = 720);
  ~CurveSink();
  void operator()(const RigBlock& block, std::size_t n, std::span<const float> estimate_N);
  Curve finish();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Extrema as a curve: maxima then minima, column "maximum" 1 or 0.
Curve extrema_curve(std::string name, const Extrema& extrema);

/// measure_decay on the session's bench; the exemplar keeps the extrema as curve "extrema/SET_NN".
Result<DecayRecord> play_decay(Session& session, const std::string& set, const StimulusSpec& spec,
                               double prominence = 0.5, const BlockSink& also = {}, Extrema* keep = nullptr);

}  // namespace forcegate::characterize
