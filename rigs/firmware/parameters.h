/* Constants of algorithm "lebosse-eq7/1". The first block is the identified model and may be regenerated from
   a new identification; the second block shapes the start-up logic and is part of the algorithm's definition
   (docs/algorithm.md): a change there needs a new algorithm id. */
#ifndef FORCEGATE_FIRMWARE_PARAMETERS_H
#define FORCEGATE_FIRMWARE_PARAMETERS_H

#ifdef FW_COMPENSATION /* compensation.h: a header made by `forcegate export` */
#include "compensation.h"
#define FW_ALGORITHM_ID "lebosse-eq7/1+" FG_COMP_ID
#else
#define FW_ALGORITHM_ID "lebosse-eq7/1"
#endif

/* Lebosse et al. 2011, eq. (5): b = slope f + constant (1/s, f in Hz), c/a = 1 / (1 + curvature A^2) (A in
 * N). */
#define FW_B_SLOPE_PER_S_PER_HZ 0.0019f
#define FW_B_CONSTANT_PER_S 0.0056f
#define FW_RATIO_CURVATURE_PER_N2 1.377f

#define FW_RATE_HZ 1000
#define FW_SMOOTH_SAMPLES 8       /* moving sum used by every decision */
#define FW_HYSTERESIS_DIVISOR 128 /* turning points: full scale / 128 (78 mV at 10 V) */
#define FW_QUIET_DIVISOR 256      /* movement: full scale / 256 (39 mV at 10 V) */
#define FW_QUIET_MIN_SAMPLES 5000 /* no movement for this long is a static load */
#define FW_QUIET_MAX_SAMPLES 20000
#define FW_HALF_PERIOD_MAX_SAMPLES 30000 /* slower than this is a ramp, not a cycle */
#define FW_RECOVERY_RATIO 6              /* 20 min of cycling are forgotten in 2 h */

#define FW_SPECTRUM_POINTS 512
#define FW_SPECTRUM_DECIMATION 38 /* 512 x 38 = 19456 samples: the start window of 19.5 s */
#define FW_SPECTRUM_BINS 102      /* up to 5.24 Hz */
#define FW_WINDOW_SAMPLES 19456
#define FW_WINDOW_CLOSE_SAMPLES 19712 /* window and the spread evaluation of its spectrum */
#define FW_LINE_POWER_DIVISOR 25      /* a line counts from 1/5 of the strongest amplitude */
#define FW_SLOW_BIN_MAX 2             /* lowest line at 0.10 Hz or below: the window holds about one period */
#define FW_AMPLITUDE_SETTLE_SAMPLES 120000

#define FW_RAMP_SAMPLES 4000 /* a longer way to the first cycle is a loading ramp */

#define FW_FLOOR_BUCKETS 12 /* U_min = lowest value of the last 12 x 10.24 s */
#define FW_FLOOR_BUCKET_SAMPLES 10240

#define FW_TICK_SAMPLES 8              /* the factor of eq. (7) is renewed every 8 ms */
#define FW_FACTOR_STEP 0.0009765625f   /* at most 0.122 a second while cycling */
#define FW_FACTOR_STEP_FAST 0.0078125f /* 0.98 a second into and out of a static hold */
#define FW_AMPLITUDE_MIN_N 0.02f
#define FW_AMPLITUDE_MAX_N 5.0f
#define FW_FREQUENCY_MAX_HZ 5.0f
#define FW_FORCE_CLAMP_N 10.0f

#endif
