/* Turning points and quiet spells of the smoothed signal, in integers: every decision here is the same on
   every processor. The signal S is the sum of the last eight raw codes. */
#ifndef FORCEGATE_FIRMWARE_EXCITATION_H
#define FORCEGATE_FIRMWARE_EXCITATION_H

#include <stdint.h>

#include "parameters.h"

typedef struct {
  uint16_t ring[FW_SMOOTH_SAMPLES];
  uint32_t at;
  int32_t sum; /* S */
} FwSmoother;

/* The first code fills the whole ring. */
void fw_smoother_reset(FwSmoother* smoother, uint16_t first_code);
int32_t fw_smoother_push(FwSmoother* smoother, uint16_t code);

typedef struct {
  int32_t extreme;
  uint32_t extreme_at;
  int rising;
} FwTurning;

typedef enum { FW_NO_TURN = 0, FW_PEAK = 1, FW_TROUGH = -1 } FwTurn;

void fw_turning_reset(FwTurning* turning, int32_t sum, uint32_t index, int rising);

/* A peak is confirmed when S has fallen by more than `hysteresis` from its highest value, a trough likewise.
 *value and *at then hold the turning point. */
FwTurn fw_turning_push(FwTurning* turning, int32_t sum, uint32_t index, int32_t hysteresis, int32_t* value,
                       uint32_t* at);

#endif
