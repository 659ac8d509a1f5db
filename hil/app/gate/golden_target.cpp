#include <fmt/format.h>

#include <cmath>

#include "hil/app/gate/golden.h"
#include "hil/gate/case_result.h"
#include "hil/gate/runner.h"
#include "hil/gate/statistics.h"
#include "hil/trace/extrema.h"

namespace forcegate {
namespace {

using characterize::SensorRecord;
using characterize::WeightMaterial;

constexpr double kMreFloor_N = 0.1;

GoldenContent content_of(const CaseRecord& record) {
  GoldenContent content;
  for (const CasePair& p : record.pairs) content.extrema.push_back({p.maximum, p.t_s, p.ati_N, p.dut_N});
  for (const RecordWindow& w : record.waveform)
    content.windows.push_back({w.t0_s, w.step_s, w.ati_N, w.dut_N});
  return content;
}

// Whole, with the extrema of its own profile, and the ATI where the set-point wants it: what a golden differs from is
// another profile then, not a rig that has changed.
bool as_planned(const CaseRecord& r, double tolerance_N) {
  constexpr std::uint64_t kEnds = 2;  // extrema at begin and end that may fall out
  if (r.samples == 0 || r.samples != r.expected_samples) return false;
  std::uint64_t found = 0;
  for (const CasePair& p : r.pairs) {
    if (p.t_s < r.facts.excitation_start_s) continue;
    ++found;
    if (!(std::fabs(p.ati_N - p.setpoint_N) <= tolerance_N)) return false;
  }
  return r.expected_extrema > 0 && found + kEnds >= r.expected_extrema && found <= r.expected_extrema + kEnds;
}

double mre_maxima_pct(const CaseRecord& record, const PlanCase& planned) {
  std::vector<double> actual, expected;
  for (const CasePair& p : record.pairs)
    if (p.maximum && p.t_s >= judged_from_s(planned, record)) {
      actual.push_back(p.dut_N);
      expected.push_back(p.ati_N);
    }
  return 100.0 * mean_relative_error(actual, expected, kMreFloor_N).mean;
}

GoldenContent content_of(const WeightMaterial& m, const SensorRecord& record) {
  GoldenContent content;
  std::size_t loading = m.plan.loadings;
  for (std::size_t i = 0; i < record.answers.force_N.size(); ++i) {
    if (record.frames.loading[i] >= m.plan.loadings) break;
    if (content.windows.empty() || record.frames.loading[i] != loading) {
      loading = record.frames.loading[i];
      content.windows.push_back(
          {m.plan.frame_end_s(i), static_cast<double>(m.plan.frame_samples()) / m.plan.rate_Hz, {}, {}});
    }
    content.windows.back().ati_N.push_back(static_cast<float>(record.frames.oracle_N[i]));
    content.windows.back().dut_N.push_back(static_cast<float>(record.answers.force_N[i]));
  }
  return content;
}

}  // namespace

std::vector<GoldenTarget> golden_targets(const RunMaterial& m) {
  std::vector<GoldenTarget> targets;
  for (std::size_t c = 0; c < m.plan.cases.size(); ++c) {
    const PlanCase& planned = m.plan.cases[c];
    if (!(planned.checks & kCheckGolden)) continue;
    for (std::size_t k = 0; k < m.records.size(); ++k) {
      const PlayedRecord& one = m.records[k];
      if (one.case_index != c || one.superseded || one.job.session != 0) continue;
      const CaseRecord& r = one.record;
      GoldenTarget t;
      t.place = k;
      t.record_id = r.id, t.case_name = planned.name, t.specimen = one.job.specimen, t.seed = one.job.seed;
      t.rig = r.rig.name + "/" + r.rig.version;
      t.algorithm = r.firmware.algorithm_id;
      t.with_truth = planned.loop == LoopMode::open;
      t.failed = r.failure.has_value();
      t.to_bless = one.specimen_index == specimens_of(m.plan, planned).size() / 2;
      t.calibration = one.job.calibration.id;
      t.content = content_of(r);
      t.truth_tube = {.absolute = 0.08, .time_s = 0.01, .lag_limit_s = 0.01};
      t.firmware_tube = {.absolute = 0.05, .relative = 0.01, .time_s = 0.01, .lag_limit_s = 0.02};
      t.stimulus = stimulus_in_words(planned.stimulus);
      t.as_planned = !t.failed && as_planned(r, 0.5 * t.truth_tube.absolute);  // so the golden is off it by as much at least
      t.error_name = "mre_maxima_pct";
      t.error = t.failed ? std::nan("") : mre_maxima_pct(r, planned);
      targets.push_back(std::move(t));
    }
  }
  return targets;
}

std::vector<GoldenTarget> golden_targets(const WeightMaterial& m) {
  std::vector<GoldenTarget> targets;
  if (m.plan.goldens.empty()) return targets;
  for (std::size_t i = 0; i < m.records.size(); ++i) {
    const SensorRecord& one = m.records[i];
    const CaseResult& c = m.head.cases[i];
    GoldenTarget t;
    t.place = i;
    t.record_id = t.case_name = c.id, t.specimen = c.specimen, t.seed = c.seed;
    t.rig = m.head.rig.name + "/" + m.head.rig.version;
    t.algorithm = m.head.firmware.algorithm_id;
    t.truth = "Network in double precision";
    t.failed = one.failure.has_value();
    t.to_bless = true;
    t.calibration = c.calibration.id;
    t.content = content_of(m, one);
    // One force a frame and 5 N from frame to frame: a tolerance in time would be one of newtons.
    t.truth_tube = {.absolute = 0.02,
                    .lag_limit_s = t.content.windows.empty() ? 0.0 : t.content.windows.front().step_s};
    t.firmware_tube = {.absolute = 0.05, .lag_limit_s = t.truth_tube.lag_limit_s};
    t.error_name = "mse_N2";
    t.error = t.failed ? std::nan("")
                       : moments(squared_error_by_loading_N2(m.plan, one.frames, one.answers.force_N)).mean;
    targets.push_back(std::move(t));
  }
  return targets;
}

}  // namespace forcegate
