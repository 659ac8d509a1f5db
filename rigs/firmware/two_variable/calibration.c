#include "calibration.h"

#include "compensator.h"

static int inside(float value, float low, float high) { return value >= low && value <= high; }

int fw_calibration_is_valid(const FwCalibration* c) {
  return inside(c->gain_N_per_V, 0.001f, 100.0f) && inside(c->offset_N, -50.0f, 50.0f) && inside(c->v_range_V, 0.1f, 100.0f) &&
         inside(c->b_scale, 0.01f, 100.0f) && inside(c->q_scale, 0.01f, 100.0f) && c->adc_bits >= 8 && c->adc_bits <= 16 &&
         fw_sensor_of(c->id) >= 0;
}
