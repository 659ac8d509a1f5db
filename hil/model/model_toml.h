#pragma once
// What the reader and the writer of model files share.

#include "hil/model/model_frame.h"

namespace forcegate::model_toml {

// Keys of [law].
struct FrameKey {
  const char* name;
  double ModelFrame::*value;
  bool above_0 = false;
};
inline constexpr FrameKey kFrame[] = {{"span_N", &ModelFrame::span_N, true}, {"lowest_N", &ModelFrame::lowest_N},
                                      {"temperature_C", &ModelFrame::temperature_C}, {"humidity_pct", &ModelFrame::humidity_pct},
                                      {"drive_V", &ModelFrame::drive_V, true},       {"travel_N", &ModelFrame::travel_N, true}};

}  // namespace forcegate::model_toml
