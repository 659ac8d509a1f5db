/* Compensation of the decay under cyclic loading, algorithm "lebosse-eq7/1":
     F = G ((1 + q) / (e^(-b t) + q) (U - U_min) + U_min) + F0          (Lebosse et al. 2011, eq. 7)
   with b and q = c/a of eq. (5), f from the start window, A taken once at the start, t from the onset of the
   cycling. docs/algorithm.md defines every step. No heap, no libm, a fixed bound on the work of a sample. */
#ifndef FORCEGATE_FIRMWARE_COMPENSATOR_H
#define FORCEGATE_FIRMWARE_COMPENSATOR_H

#include <stdint.h>

#include "calibration.h"
#include "excitation.h"
#include "floor_tracker.h"
#include "parameters.h"
#include "spectrum.h"

enum {
  FW_FLAG_EXCITED = 1,
  FW_FLAG_LEARNING = 2,
  FW_FLAG_HELD = 4,
  FW_FLAG_INPUT_RAIL = 8,
  FW_FLAG_OUTPUT_CLAMPED = 16
};

typedef enum { FW_REST, FW_ARMED, FW_CYCLING, FW_HELD } FwPhase;

typedef struct {
  int32_t high;
  uint32_t high_at;
  int32_t low;
} FwQuarter;

typedef struct {
  FwCalibration calibration;
  float lsb_V, lsb_sum_V;
  int32_t code_max, hysteresis, quiet_band;

  uint32_t index; /* samples since reset */
  FwPhase phase;
  FwSmoother smoother;
  FwTurning turning;
  FwFloor floor;
  FwSpectrum spectrum;

  int32_t quiet_reference;
  uint32_t quiet_since;

  uint32_t onset;        /* index that stands for t = 0 */
  uint32_t window_start; /* first sample of the start window */
  int window_open;       /* f and A not yet frozen */
  int knows_excitation;  /* A, b, q of an earlier cycling are still valid */
  int peaks, troughs;
  int32_t armed_trough;
  uint32_t first_turn_at, learning_since;
  uint32_t last_turn_at, last_interval, longest_interval;
  FwQuarter quarter[4];

  uint32_t held_since, exposure_at_hold;

  int32_t peak_sum;  /* what A is made of */
  uint32_t peak_age; /* samples from onset to that peak */
  int32_t trough_sum;
  int slow_content;
  float b_per_s, q;

  int fast;
  float factor;  /* (1 + q) / (e^(-b t) + q) as applied */
  float floor_V; /* U_min */
#ifdef FW_COMPENSATION
  FgComp effects; /* what the sensor has besides the law of eq. (7) */
#endif
} FwCompensator;

/* The calibration must be valid. Forgets everything. */
void fw_compensator_reset(FwCompensator* c, const FwCalibration* calibration);

/* One raw code -> force in newtons; *flags gets FW_FLAG_*. */
float fw_compensator_step(FwCompensator* c, uint16_t code, uint8_t* flags);

#endif
