#pragma once
// Every specimen in every session through the same procedures, in parallel, and what the population looks like.

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "hil/characterize/laws.h"
#include "hil/characterize/session.h"

namespace forcegate::characterize {

/// One measurement over the population. Spread between specimens: of their means over sessions; within: of the
/// sessions of one specimen, pooled.
struct Spread {
  std::string key, title, unit;
  double mean = 0, sd_specimens = 0, sd_sessions = 0;
  double lowest = 0, q05 = 0, median = 0, q95 = 0, largest = 0;
  std::size_t specimens = 0, n = 0;  ///< n: finite values; a session without one is left out
};

struct SensorStudy {
  std::string sensor;                ///< "flexiforce", "fsr", "recording"
  bool of_recordings = false;        ///< a sheet is a recording, of which nothing says whose it is: no specimen, no session
  std::vector<SessionSheet> sheets;  ///< specimen by specimen, session by session
  SessionSheet exemplar;             ///< with curves; in no statistic, or a copy of the sheet of StudyRequest::first_is_exemplar
  std::vector<Spread> spreads;       ///< in the order in which the procedures measured
  LawStudy laws;
  double rig_time_s = 0.0;
  std::uint64_t samples = 0;

  const Spread* find(std::string_view key) const;
  /// Share of the sessions that measured `key` for which test(value) holds, and how many there were.
  struct Share {
    double share = 0.0;
    std::size_t n = 0;
  };
  Share share_where(std::string_view key, const std::function<bool(double)>& test) const;
};

struct StudyRequest {
  StudyPlan plan;
  std::vector<std::string> sensors;
  bool first_is_exemplar = false;  ///< no exemplar of the plan is played: the first session of the first specimen gives the curves
  std::function<Result<std::unique_ptr<Rig>>(const std::string& sensor)> make_rig;
  CompensationMaker compensation;
  unsigned threads = 0;
  std::function<void(double fraction, std::string_view now)> progress;
};

/// The same answer whatever the number of threads. Errors: a rig cannot be made, cancelled. What a rig does during a
/// session is in SessionSheet::failure; sessions that failed are in no statistic.
Result<std::vector<SensorStudy>> run_study(const StudyRequest& request, BenchProgress& progress);

/// A limit of the plan on the worst session of a sensor.
struct LimitResult {
  StudyLimit limit;
  std::string sensor, title, unit;
  double worst = 0.0;    ///< farthest towards the bound, or beyond it
  std::string specimen;  ///< whose it was
  std::size_t sessions = 0, outside = 0;
  bool kept = false;  ///< every session measured it and kept it; nothing measured is not kept
};

/// Before anything is played. Errors: config, with the place in the plan, for a limit whose key none of the procedures that the plan lists for
/// `sensors` measures.
Result<void> check_limit_keys(const StudyPlan& plan, const std::vector<std::string>& sensors);

/// Limits whose key the sensor's procedures measure; a key that no sensor measures is not kept. A session that failed
/// counts as outside, a recording that does not measure the key is left out.
std::vector<LimitResult> check_limits(const std::vector<SensorStudy>& studies, const StudyPlan& plan);

/// Mean and sample standard deviation of the finite values; sd NaN below two.
struct MeanSd {
  double mean = 0, sd = 0;
  std::size_t n = 0;
};
MeanSd mean_and_sd(const std::vector<double>& values);

/// Fills spreads and laws from the sheets.
void summarise(SensorStudy& study, const StudyPlan& plan);

}  // namespace forcegate::characterize
