#pragma once
// `forcegate characterize` with a plan of kind "capacitance": the study of Paredes-Madrid 2010.

#include <atomic>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "hil/app/characterize/characterize.h"
#include "hil/characterize/capacitance/weight_summary.h"

namespace forcegate {

struct MadeWeightStudy {
  characterize::WeightStudy study;
  characterize::WeightSummary summary;
  std::vector<std::filesystem::path> files;  ///< what was written, in order
};

/// Whether the request's plan is of kind "capacitance". Errors: no such plan.
Result<bool> is_weight_study(const CharacterizeRequest& request);

/// Takes plan, seed, output, paper, threads and rig options of the request; "emulated" means the emulated bench of weights.
/// Errors: usage (options that belong to the other study), config, of the bench, io, cancelled.
Result<MadeWeightStudy> weight_study_request(
    const CharacterizeRequest& request, const std::function<void(double, std::string_view)>& progress = {},
    const std::atomic<bool>* cancelled = nullptr);

}  // namespace forcegate
