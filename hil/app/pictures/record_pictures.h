#pragma once
// The data of hil/report/record_pictures.h, from what a diagnosis leaves behind.

#include <cstddef>

#include "hil/diagnose/workspace.h"
#include "hil/model/model.h"
#include "hil/report/record_pictures.h"
#include "hil/trace/campaign.h"

namespace forcegate {

/// Records that are drawn, the worst first.
inline constexpr std::size_t kMostRecordPictures = 3;

/// Residual = output - (zero + gain * model), the model's decay as the diagnosis fitted it; gain and zero are the record's own where one
/// record is looked at. The effects of the model file are in it, at the file's strengths; what a diagnosis finds is in `after`, which stands
/// beside it in spectrum and turning points; nullptr: nothing was found.
RecordPictures record_pictures(const diagnose::Workspace& workspace, const Model& model, const Model* after = nullptr);

/// Of recordings without an input (drift_pictures.cpp). `form`: the law of time to draw; empty: the one that predicts left-out parts best.
RecordPictures drift_pictures(const Campaign& campaign, const std::string& form);

}  // namespace forcegate
