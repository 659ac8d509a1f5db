/* What the harness tells the firmware before any sample counts. */
#ifndef FORCEGATE_FIRMWARE_CALIBRATION_H
#define FORCEGATE_FIRMWARE_CALIBRATION_H

#include <stdint.h>

#define FW_CALIBRATION_ID_SIZE 16

typedef struct {
  float gain_N_per_V; /* eq. (1): F = G U + F0 */
  float offset_N;
  float v_range_V; /* code n means n / (2^adc_bits - 1) * v_range_V */
  float b_scale;   /* multiplies b of eq. (5) */
  float q_scale;   /* multiplies q = c/a of eq. (5) */
  uint8_t adc_bits;
  char id[FW_CALIBRATION_ID_SIZE]; /* padded with zero bytes, not terminated */
} FwCalibration;

/* 1 when every number is finite and inside its range (gain 0.001-100, |offset| <= 50, range 0.1-100 V, scales
   0.01-100, 8-16 bits). NaN is refused by the form of the comparisons. */
int fw_calibration_is_valid(const FwCalibration* calibration);

#endif
