/* C interface of the native port (shared object). All integers little-endian as the host has them, structures
   without padding. A device under test of your own may implement these four functions in any language.

   One record: open (fresh state, nonce echoed, CAL echoed), process as often as needed with first_index
   counted on without a hole, close. Return values: 0 good, else FORCEGATE_NATIVE_*. */
#ifndef FORCEGATE_NATIVE_H
#define FORCEGATE_NATIVE_H

#include <stdint.h>

#define FORCEGATE_NATIVE_ABI 1u
#define FORCEGATE_NATIVE_BAD_CALIBRATION 1
#define FORCEGATE_NATIVE_BAD_INDEX 2
#define FORCEGATE_NATIVE_NOT_OPEN 3

typedef struct {
  float gain_N_per_V, offset_N, v_range_V, b_scale, q_scale;
  uint32_t adc_bits;
  char id[16];                /* padded with zero bytes */
} ForcegateNativeCalibration; /* 40 bytes */

typedef struct {
  uint32_t nonce;
  uint16_t protocol_major, protocol_minor;
  uint32_t rate_Hz;
  ForcegateNativeCalibration calibration;
  char board[24];        /* zero padded */
  char build_id[40];     /* hex digits */
  char algorithm_id[32]; /* zero padded */
} ForcegateNativeInfo;   /* 148 bytes */

#define FORCEGATE_NATIVE_API __attribute__((visibility("default")))

FORCEGATE_NATIVE_API uint32_t forcegate_native_abi(void);
FORCEGATE_NATIVE_API int32_t forcegate_native_open(uint32_t nonce,
                                                   const ForcegateNativeCalibration* calibration,
                                                   ForcegateNativeInfo* info);
FORCEGATE_NATIVE_API int32_t forcegate_native_process(uint32_t first_index, uint32_t n, const uint16_t* adc,
                                                      float* force_N, uint8_t* flags);
FORCEGATE_NATIVE_API void forcegate_native_close(void);

#endif
