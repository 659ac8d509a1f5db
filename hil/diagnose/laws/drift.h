#pragma once
// Recordings without an input: nothing to regress on, but the output may still drift. Which law of time?

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "hil/base/result.h"
#include "hil/diagnose/diagnosis.h"
#include "hil/diagnose/laws/no_input.h"
#include "hil/trace/campaign.h"

namespace forcegate::diagnose {

/// Means that a law is fitted to.
inline constexpr std::size_t kDriftBlocks = 200;

struct DriftFit;

/// A law of time: U = c + a course(t - t0), and how it is told. A further law is a row of drift_laws().
struct DriftLaw {
  std::string_view name;
  double (*course)(double since_s, double shape);     ///< since_s >= 0
  double (*primitive)(double since_s, double shape);  ///< its integral from 0 to since_s > 0
  double (*shape_low)(double record_s);               ///< bounds of the shape in a record of this length; null: it has none
  double (*shape_high)(double record_s);
  const char* shape_name;  ///< as a parameter of the finding
  const char* shape_unit;
  const char* per;  ///< behind the output's unit in that of a
  /// "the output creeps ..."; `from`: "" or " from 12 s on"
  std::string (*sentence)(const DriftFit& fit, const std::string& from, const std::string& unit);
};

///   constant     U = c
///   line         U = c + k t
///   exponential  U = c + a (1 - exp(-(t - t0) / tau)), t > t0    (a leak, a relaxation with one time constant)
///   logarithm    U = c + a log10(1 + (t - t0) / t1)              (creep; t1 at most a tenth of the record)
///   power        U = c + a ((t - t0) / 1 s)^p, 0.02 <= p <= 0.9  (fractional creep)
/// with U constant before t0 >= 0 where the drift sets in later than the record; k and a are positive where the output rises. The constant is the first.
const std::array<DriftLaw, 5>& drift_laws();

/// One law for one record, fitted by least squares on block means.
struct DriftFit {
  const DriftLaw* law = &drift_laws().front();
  double onset_s = 0.0;
  double constant = 0.0, size = 0.0, shape = 0.0;  ///< c; k or a; tau, t1 or p
  double u_size = 0.0, u_shape = 0.0, u_onset_s = 0.0;  ///< standard uncertainties: jackknife over tenths of the record
  double rms = 0.0;                                ///< of the residual of the block means
  double left_out_rms = 0.0;                       ///< of tenths of the record predicted from the other nine
};

/// U of the law at a time since the record's first finite sample.
double value_at(const DriftFit& fit, double t_s);

/// Means of the finite samples in at most kDriftBlocks stretches; times since the first of them.
struct DriftBlocks {
  std::vector<double> begin_s, end_s, t_s, y;  ///< t_s: mean of the samples' times
  double length_s() const { return 0.5 * (begin_s.back() + end_s.back()); }
};
DriftBlocks drift_blocks(const std::vector<double>& t_s, const std::vector<double>& y);

struct RecordDrift {
  std::string record;
  double span = 0.0;           ///< 0.1 to 99.9 % of the block means, in the channel's unit
  double noise = 0.0;          ///< of a block mean
  std::vector<DriftFit> fits;  ///< smallest left_out_rms first
};

/// t_s ascending, y the same length. Errors: fewer than 40 finite samples.
Result<RecordDrift> fit_drift(const std::string& record, const std::vector<double>& t_s,
                              const std::vector<double>& y);

/// Verdict "none" when nothing drifts; "known", finding "drift" with its law, when one law predicts the parts that were
/// left out clearly better than the others; else "unknown", depends on time. The side cannot be told: it is "unknown". Each record has its error
/// with the constant and with the law on tenths that were left out. All errors and floors are of block means, which a note says.
/// Errors: a record has no output channel (its columns are listed).
Result<Diagnosis> diagnose_drift(const Campaign& campaign);

}  // namespace forcegate::diagnose
