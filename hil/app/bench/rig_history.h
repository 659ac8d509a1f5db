#pragma once
// What a rig's self-checks gave over time, and the control chart that says when the rig (not a firmware) has changed.

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "hil/base/result.h"
#include "hil/interface/run_result.h"

namespace forcegate {

/// One self-check. The history is a text file, one JSON object a line, only ever appended to.
struct RigVisit {
  std::string date;  ///< ISO 8601
  std::string rig;   ///< "emulated/1 emulated-flexiforce": name, version, id
  std::string firmware_sha256;
  std::string decision;                  ///< "ACCEPT" ...
  std::map<std::string, double> values;  ///< "rig_reference_zero" -> 0.004
};

/// Values of all rig checks and of the known-good build's errors, the worst over the records of the run.
RigVisit visit_of(const RunResult& result);

/// None when there is no file. Errors (parse) name the line.
Result<std::vector<RigVisit>> read_history(const std::filesystem::path& path);
Result<void> append_visit(const std::filesystem::path& path, const RigVisit& visit);

/// Chart of one quantity: centre and spread from the first n <= kBaseline visits (moving range / 1.128, which has about
/// 0.62 (n - 1) degrees of freedom), then
///   individuals: |x - centre| <= t s sqrt(1 + 1 / n)                                              (Shewhart)
///   EWMA: z_i = 0.2 x_i + 0.8 z_(i-1), |z_i - centre| <= t s sqrt(0.2 / 1.8 + 1 / n)              (Roberts 1959)
/// 1 / n is the error of the centre, t Student's quantile for the degrees of freedom of s: with three standard deviations
/// every third visit to a healthy rig would alarm. Its level is kFalseAlarm over all charts of a visit (Bonferroni).
/// The spread is never taken below `resolution`: a quantity that did not vary at all is no reason for an alarm at its
/// first last digit.
struct ControlChart {
  static constexpr std::size_t kBaseline = 20, kNeeded = 8;
  static constexpr double kFalseAlarm = 0.01;  ///< of a whole visit
  std::string quantity;
  std::vector<double> x, ewma;
  double centre = 0.0, s = 0.0;
  bool enough = false;     ///< at least kNeeded visits before the last
  bool in_control = true;  ///< of the last visit
  std::string text;        ///< why not
};
/// `charts`: how many quantities a visit is judged by.
ControlChart control_chart(const std::string& quantity, const std::vector<double>& x, double resolution, std::size_t charts = 1);

/// What the last visit is judged by, and itself at the end: the visits of the same rig with the same known-good build whose decision was
/// ACCEPT. A visit to a rig that was not fit says nothing of how a fit one varies, and another build's errors are no drift of the rig.
std::vector<const RigVisit*> charted_visits(const std::vector<RigVisit>& history);

/// One chart a quantity of the last visit, over the charted visits.
std::vector<ControlChart> control_charts(const std::vector<RigVisit>& history);

/// Share of a one-sided tolerance that the rig's own repeatability takes: %GRR = 100 * 3 s / limit for an error that cannot
/// be below 0 (AIAG MSA: below 10 good, above 30 the gauge cannot judge that limit).
double gauge_share_pct(double s, double limit);
inline constexpr double kGaugeRefused_pct = 30.0;

}  // namespace forcegate
