#pragma once
// What the first answer has found may stand in the way of the rest: a delay behind the model's lag, whatever acts behind a curve that bends much.
// The campaign is looked at once more with it in its place, and where that leaves plainly less it is the answer.

#include <functional>

#include "hil/diagnose/engine.h"

namespace forcegate::diagnose {

/// Form of a curve that none of the library's describes: what acts behind it is judged with the whole of it in the model.
inline constexpr const char* kWholeCurve = "whole_curve";

using DiagnoseRows = std::function<Result<Diagnosed>(CampaignRows, const EngineOptions&)>;

/// The answer of `diagnose`, or that of a second look.
Result<Diagnosed> look_again(CampaignRows rows, const EngineOptions& options, const DiagnoseRows& diagnose);

}  // namespace forcegate::diagnose
