#pragma once
// `forcegate gate` with a plan of kind "capacitance-gate": a firmware that reads conductance and capacitance.

#include <string>
#include <vector>

#include "hil/app/gate/gate.h"
#include "hil/characterize/capacitance/weight_material.h"

namespace forcegate {

/// Whether a plan (file, or name in ci/plans) is of that kind. Errors: no such plan.
Result<bool> is_weight_plan(const std::string& plan);

/// Takes firmware, plan, lane, accepted, goldens, waivers, threads, hang_cpu_s, only_cases (names of sensors) and output of
/// the request. One session of the image for each sensor, in a process of its own; folder, result and reports are those of
/// gate(). Errors: of the request and the bench, usage for options that mean nothing here; what the image does wrong is in
/// the decision.
Result<RunResult> weight_gate(const GateRequest& request, const GateProgress& progress = {},
                              const std::atomic<bool>* cancelled = nullptr);

/// Plays the sessions of a stored run again, by its own recipe. Returns the digest of every record, or why there is none. Errors: of the
/// bench.
Result<std::vector<Result<std::string>>> play_weights_again(const characterize::WeightMaterial& stored,
                                                            const std::filesystem::path& image, unsigned threads,
                                                            const GateProgress& progress = {},
                                                            const std::atomic<bool>* cancelled = nullptr);

}  // namespace forcegate
