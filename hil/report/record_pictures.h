#pragma once
// What the residual of the model shows that a thinned overlay cannot: its spectrum, what becomes of maxima and minima, the gain and the zero
// of every record, and drift without an input. Where the records cannot show one of them a sentence says why.

#include <string>
#include <vector>

#include "hil/report/figures/figure.h"

namespace forcegate {

/// Amplitude spectral density of the residual (Welch 1967: Hann windows, half overlapped, stretches without samples left out).
struct ResidualSpectrum {
  std::string record;
  std::vector<double> f_Hz, residual;  ///< residual in unit/sqrt(Hz)
  std::vector<double> load;            ///< of the modelled output, same unit: what the load has
  double noise = 0.0;                  ///< what white noise of the row noise would give; 0: not known
  std::vector<double> after{};         ///< residual of the model with what was found or added; empty: nothing was
  /// Of the command, or of what the angle makes of it: what the load has where the reference's steps look like lines. Its own unit; empty: not recorded.
  std::vector<double> command{};
};

/// Output at the turning points of the force; modelled with the record's own gain and zero, `after` with what was found or added (empty:
/// nothing was).
struct TurningSeries {
  std::vector<double> t_s, measured, modelled, after;
};
struct ExtremaDecay {
  std::string record;
  TurningSeries maxima, minima;
};

/// One number for each record, with its standard uncertainty from tenths of the record.
struct RecordLevel {
  std::string record;
  double start_s = 0.0;                      ///< in campaign time
  double zero = 0.0, u_zero = 0.0;           ///< mean residual with the gain of all records, unit of the output
  double gain_pct = 0.0, u_gain_pct = 0.0;   ///< departure of the gain from the median; NaN where the load hardly moves
  double reference_N = 0.0, u_reference_N = 0.0;  ///< mean of reference less rig law; NaN without a rig law
};

/// Output of one recording without an input, with the law of time that was fitted.
struct DriftCourse {
  std::string record, form;
  std::vector<double> t_s, measured, modelled;  ///< means of blocks
  double noise = 0.0;                           ///< standard uncertainty of one
};

struct RecordPictures {
  std::string unit = "V";
  std::vector<ResidualSpectrum> spectra;
  std::vector<ExtremaDecay> extrema;
  std::vector<RecordLevel> levels;
  bool levels_over_time = false;  ///< start times are known; else the order of the records is all there is
  std::vector<DriftCourse> drift;
  std::vector<std::string> missing;  ///< "No spectrum: ..."
};

/// `mains`: hum is claimed. The rows are means over their step and fold a line of 50 or 60 Hz below their highest frequency; the summary then
/// says which line that is.
figures::Figure spectrum_figure(const ResidualSpectrum& spectrum, const std::string& unit, bool mains = false);
figures::Figure extrema_figure(const ExtremaDecay& extrema, const std::string& unit);
/// Zero, gain and, where the rig tells, zero of the reference of every record; whiskers are U, k = 2.
figures::Figure levels_figure(const RecordPictures& pictures);
figures::Figure drift_figure(const DriftCourse& course, const std::string& unit);

}  // namespace forcegate
