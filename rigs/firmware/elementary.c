#include "elementary.h"

#include <stdint.h>
#include <string.h>

float fw_exp_nonpositive(float x) {
  if (!(x < 0.0f)) return 1.0f;
  if (x < -80.0f) x = -80.0f;
  const int32_t k = (int32_t)(x * 1.44269504f - 0.5f);
  const float kf = (float)k;
  const float r = (x - kf * 0.693359375f) + kf * 2.12194440e-4f;
  float p = 1.0f / 720.0f;
  p = p * r + 1.0f / 120.0f;
  p = p * r + 1.0f / 24.0f;
  p = p * r + 1.0f / 6.0f;
  p = p * r + 0.5f;
  const float mantissa = 1.0f + (r + r * r * p);
  const uint32_t bits = (uint32_t)(k + 127) << 23;
  float scale;
  memcpy(&scale, &bits, sizeof scale);
  return mantissa * scale;
}
