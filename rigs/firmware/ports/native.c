#include "ports/native.h"

#include <string.h>

#include "compensator.h"
#include "identity.h"

/* Read by the harness from the file, to know which build must answer. */
__attribute__((used)) static const char kBuild[] = "forcegate-build:" FW_BUILD_ID;

static FwCompensator compensator;
static int is_open;

uint32_t forcegate_native_abi(void) { return FORCEGATE_NATIVE_ABI; }

int32_t forcegate_native_open(uint32_t nonce, const ForcegateNativeCalibration* in,
                              ForcegateNativeInfo* info) {
  FwCalibration calibration = {.gain_N_per_V = in->gain_N_per_V,
                               .offset_N = in->offset_N,
                               .v_range_V = in->v_range_V,
                               .b_scale = in->b_scale,
                               .q_scale = in->q_scale,
                               .adc_bits = in->adc_bits <= 16u ? (uint8_t)in->adc_bits : 0};
  memcpy(calibration.id, in->id, sizeof calibration.id);
  memset(info, 0, sizeof *info);
  info->nonce = nonce;
  info->protocol_major = FW_PROTOCOL_MAJOR;
  info->protocol_minor = FW_PROTOCOL_MINOR;
  info->rate_Hz = FW_RATE_HZ;
  memcpy(info->board, "native", 6);
  memcpy(info->build_id, FW_BUILD_ID, sizeof info->build_id);
  memcpy(info->algorithm_id, FW_ALGORITHM_ID, sizeof FW_ALGORITHM_ID - 1);
  if (!fw_calibration_is_valid(&calibration)) return FORCEGATE_NATIVE_BAD_CALIBRATION;
  fw_compensator_reset(&compensator, &calibration);
  info->calibration = *in;
  is_open = 1;
  return 0;
}

int32_t forcegate_native_process(uint32_t first_index, uint32_t n, const uint16_t* adc, float* force_N,
                                 uint8_t* flags) {
  if (!is_open) return FORCEGATE_NATIVE_NOT_OPEN;
  if (first_index != compensator.index) return FORCEGATE_NATIVE_BAD_INDEX;
  for (uint32_t i = 0; i < n; ++i) force_N[i] = fw_compensator_step(&compensator, adc[i], &flags[i]);
  return 0;
}

void forcegate_native_close(void) { is_open = 0; }
