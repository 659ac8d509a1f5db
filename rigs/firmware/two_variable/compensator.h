/* Force from conductance and capacitance, algorithm "paredes-2-2-1/1" (Paredes-Madrid et al. 2010, sections III and VI):
     V_o  mean of the samples under the direct voltage                        (eq. 8)
     C_s  from the quadrature part of the samples under the sine              (eq. 6)
     F    network of two inputs, two hidden neurons, one output
   A force per frame; it stands until the next frame is complete. No heap, no libm, a fixed bound on the work of a sample.
   Codes: 2^(bits-1) is 0 V, the whole range is v_range_V. The calibration's id chooses the network: FW_PACK_ID "/" digit;
   gain_N_per_V and offset_N correct its output: F = 2 gain F_network + offset, so that the nominal 0.5 and 0 leave it. */
#ifndef FORCEGATE_FIRMWARE_COMPENSATOR_H
#define FORCEGATE_FIRMWARE_COMPENSATOR_H

#include <stdint.h>

#include "calibration.h"
#include "parameters.h"

enum {
  FW_FLAG_LEARNING = 2, /* no frame is complete yet, or the last one held a saturated sample: the force is not of it */
  FW_FLAG_INPUT_RAIL = 8,
  FW_FLAG_OUTPUT_CLAMPED = 16
};

typedef struct {
  float w[9]; /* w_10 w_11 w_12 w_20 w_21 w_22 v_0 v_1 v_2 */
  float mean_V, scale_V, mean_pF, scale_pF, mean_N, scale_N;
} FwNetwork;

typedef struct {
  FwCalibration calibration;
  const FwNetwork* network;
  uint32_t index;    /* samples since reset */
  uint32_t position; /* in the frame */
  int32_t direct;    /* sums of codes about the middle */
  int32_t sine[FW_SINE_PERIOD]; /* one for each place in the period */
  int rail;
  float force_N;
  uint8_t flags;
} FwCompensator;

/* Forgets everything. */
void fw_compensator_reset(FwCompensator* c, const FwCalibration* calibration);

/* One raw code -> force in newtons; *flags gets FW_FLAG_*. */
float fw_compensator_step(FwCompensator* c, uint16_t code, uint8_t* flags);

/* Number of the sensor that an id names, 0 to 7, or -1. */
int fw_sensor_of(const char* id);

#endif
