#pragma once
// What a gate run of a firmware that reads conductance and capacitance is judged from, and the judgement: a pure function
// of what was measured. A stored run is judged again in the same way.

#include <optional>
#include <vector>

#include "hil/characterize/capacitance/weight_gate.h"
#include "hil/gate/run_judge.h"

namespace forcegate::characterize {

/// One session of the image, for one sensor; record i belongs to WeightMaterial::head.cases[i].
struct SensorRecord {
  std::size_t sensor = 0;  ///< in the pack, from 0
  SensorFrames frames;     ///< without the codes
  FrameAnswers answers;    ///< none after a failure
  std::optional<Error> failure;
  std::vector<double> accepted_N;   ///< of the accepted build on the same frames; empty: it has no answer
  std::vector<JudgedCheck> checks;  ///< judged
};

/// All that a result follows from.
struct WeightMaterial {
  WeightGatePlan plan;
  std::size_t sensors = 0;  ///< of the pack; the checks of the pack need a record of each
  bool cancelled = false;
  std::vector<SensorRecord> records;
  bool with_accepted = false;  ///< there is an accepted build to compare with
  RunResult head;              ///< what is not judged: names, hashes, notes; cases without checks and curves
};

/// Judges every record anew (SensorRecord::checks) and returns the checks of the whole run; the decision rule has run over
/// all of them together. The bench comes first: where the network in double precision misses a limit on the same codes,
/// no firmware could hold it, and the values of that sensor, or of the pack, are rig_error. `others`: by place of the
/// record (golden traces).
std::vector<JudgedCheck> judge_material(WeightMaterial& material, const ChecksByRecord& others = {});

std::vector<JudgedCheck*> all_checks(std::vector<JudgedCheck>& of_run, std::vector<SensorRecord>& records);

/// The result with its decision and the curves of every sensor.
RunResult to_run_result(const WeightMaterial& material, const std::vector<JudgedCheck>& of_run);

/// Loss of eq. (11)'s error reduction against an accepted build on the same frames, percentage points, mean over the pack:
///   loss = mean_s 100 (MSE_s - MSE_s,accepted) / MSE_s,conductance,   u = sqrt(sum_s sd_s^2 / L) / S
/// sd_s: standard deviation of sensor s's loss over its L loadings. The sensors of the pack are fixed. NaN when one of them
/// has no partner. The rule is still to be applied.
JudgedCheck compare_with_accepted(const WeightMaterial& material);

}  // namespace forcegate::characterize
