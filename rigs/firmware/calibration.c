#include "calibration.h"

static int inside(float x, float low, float high) { return x >= low && x <= high; }

int fw_calibration_is_valid(const FwCalibration* c) {
  return inside(c->gain_N_per_V, 0.001f, 100.0f) && inside(c->offset_N, -50.0f, 50.0f) &&
         inside(c->v_range_V, 0.1f, 100.0f) && inside(c->b_scale, 0.01f, 100.0f) &&
         inside(c->q_scale, 0.01f, 100.0f) && c->adc_bits >= 8 && c->adc_bits <= 16;
}
