#include "excitation.h"

void fw_smoother_reset(FwSmoother* s, uint16_t first_code) {
  for (int i = 0; i < FW_SMOOTH_SAMPLES; ++i) s->ring[i] = first_code;
  s->at = 0;
  s->sum = FW_SMOOTH_SAMPLES * (int32_t)first_code;
}

int32_t fw_smoother_push(FwSmoother* s, uint16_t code) {
  s->sum += (int32_t)code - (int32_t)s->ring[s->at];
  s->ring[s->at] = code;
  s->at = (s->at + 1u) % FW_SMOOTH_SAMPLES;
  return s->sum;
}

void fw_turning_reset(FwTurning* t, int32_t sum, uint32_t index, int rising) {
  t->extreme = sum;
  t->extreme_at = index;
  t->rising = rising;
}

FwTurn fw_turning_push(FwTurning* t, int32_t sum, uint32_t index, int32_t hysteresis, int32_t* value,
                       uint32_t* at) {
  const int32_t beyond = t->rising ? sum - t->extreme : t->extreme - sum;
  if (beyond > 0) {
    t->extreme = sum;
    t->extreme_at = index;
    return FW_NO_TURN;
  }
  if (-beyond <= hysteresis) return FW_NO_TURN;
  const FwTurn turn = t->rising ? FW_PEAK : FW_TROUGH;
  *value = t->extreme;
  *at = t->extreme_at;
  fw_turning_reset(t, sum, index, !t->rising);
  return turn;
}
