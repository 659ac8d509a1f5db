/* Lowest significant line of the start window: bins 1 to 102 of a 512-point Fourier transform, accumulated
   sample by sample in exact integers. There is no burst of work when the window closes, no rounding, and so
   no decision that could differ between processors. */
#ifndef FORCEGATE_FIRMWARE_SPECTRUM_H
#define FORCEGATE_FIRMWARE_SPECTRUM_H

#include <stdint.h>

#include "parameters.h"

typedef struct {
  int64_t re[FW_SPECTRUM_BINS + 1];
  int64_t im[FW_SPECTRUM_BINS + 1];
  uint64_t power[FW_SPECTRUM_BINS + 1];
  uint64_t power_max;
  int32_t block_sum;
  int32_t latched;        /* last full block, being spread over the bins */
  uint16_t latched_index; /* 0 ... 511; FW_SPECTRUM_POINTS = none */
  uint16_t in_block;
  uint16_t blocks;
  uint16_t next_bin;
  uint16_t stage;      /* 0 accumulate, 1 power, 2 search, 3 done */
  uint16_t lowest_bin; /* valid in stage 3 */
} FwSpectrum;

void fw_spectrum_reset(FwSpectrum* spectrum);

/* One raw code. Stage 3 is reached at most 19456 + 34 + 101 + 101 calls after reset. */
void fw_spectrum_push(FwSpectrum* spectrum, uint16_t code);

#endif
