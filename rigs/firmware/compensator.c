#include "compensator.h"

#include <string.h>

#include "elementary.h"

static const float kStep_s = 1.0f / (float)FW_RATE_HZ;

static float minimum(float a, float b) { return a < b ? a : b; }
static float maximum(float a, float b) { return a > b ? a : b; }

static float factor_at(float b_per_s, float q, uint32_t age) {
  const float decay = fw_exp_nonpositive(-(b_per_s * ((float)age * kStep_s)));
  return (1.0f + q) / (decay + q);
}

static float rate(const FwCompensator* c, float f_Hz) {
  return c->calibration.b_scale *
         (FW_B_SLOPE_PER_S_PER_HZ * minimum(f_Hz, FW_FREQUENCY_MAX_HZ) + FW_B_CONSTANT_PER_S);
}

static float ratio(const FwCompensator* c, float amplitude_N) {
  const float a = minimum(maximum(amplitude_N, FW_AMPLITUDE_MIN_N), FW_AMPLITUDE_MAX_N);
  return c->calibration.q_scale / (1.0f + FW_RATIO_CURVATURE_PER_N2 * (a * a));
}

/* A at the onset from the highest and lowest raw values: the peak is some seconds old and has decayed a
   little by then, so A = G/2 K(A) (U_peak - U_min), a contraction with a factor below 0.1 within the start
   window. */
static void update_ratio(FwCompensator* c) {
  const float half_swing_N =
      0.5f * c->calibration.gain_N_per_V * ((float)(c->peak_sum - c->trough_sum) * c->lsb_sum_V);
  float q = ratio(c, half_swing_N);
  for (int i = 0; i < 4; ++i) q = ratio(c, half_swing_N * factor_at(c->b_per_s, q, c->peak_age));
  c->q = q;
}

static void highest(FwCompensator* c, int first_quarter) {
  int32_t high = c->quarter[first_quarter].high;
  uint32_t at = c->quarter[first_quarter].high_at;
  for (int i = first_quarter + 1; i < 4; ++i)
    if (c->quarter[i].high > high) {
      high = c->quarter[i].high;
      at = c->quarter[i].high_at;
    }
  c->peak_sum = high;
  c->peak_age = at > c->onset ? at - c->onset : 0;
}

/* Running estimate while the window is open: f from the longest half-cycle so far. */
static void learn(FwCompensator* c) {
  const float f_Hz = c->longest_interval > 0 ? (0.5f * (float)FW_RATE_HZ) / (float)c->longest_interval : 0.0f;
  c->b_per_s = rate(c, f_Hz);
  highest(c, 0);
  c->trough_sum = c->floor.lowest;
  update_ratio(c);
}

static void close_window(FwCompensator* c) {
  const float bin_Hz = (float)FW_RATE_HZ / (float)FW_WINDOW_SAMPLES;
  c->b_per_s = rate(c, (float)c->spectrum.lowest_bin * bin_Hz);
  c->slow_content = c->spectrum.lowest_bin <= FW_SLOW_BIN_MAX;
  if (c->slow_content) {
    highest(c, 0);
  } else { /* the first quarter may hold the transient of the start */
    highest(c, 1);
    int32_t low = c->quarter[1].low;
    for (int i = 2; i < 4; ++i)
      if (c->quarter[i].low < low) low = c->quarter[i].low;
    if (low != INT32_MAX) fw_floor_reset(&c->floor, low);
  }
  c->trough_sum = c->floor.lowest;
  update_ratio(c);
  c->window_open = 0;
  c->knows_excitation = 1;
}

static void open_window(FwCompensator* c) {
  c->window_start = c->index;
  c->window_open = 1;
  fw_spectrum_reset(&c->spectrum);
  for (int i = 0; i < 4; ++i) {
    c->quarter[i].high = INT32_MIN;
    c->quarter[i].high_at = c->index;
    c->quarter[i].low = INT32_MAX;
  }
}

static void arm(FwCompensator* c, int32_t sum, uint32_t onset, int rising) {
  c->phase = FW_ARMED;
  c->peaks = c->troughs = 0;
  c->last_turn_at = onset;
  c->longest_interval = 0;
  fw_turning_reset(&c->turning, sum, c->index, rising);
  if (c->knows_excitation) return;
  c->onset = onset;
  open_window(c);
}

static void observe_window(FwCompensator* c, uint16_t code, int32_t sum) {
  const uint32_t age = c->index - c->window_start;
  if (age < FW_WINDOW_SAMPLES) {
    FwQuarter* quarter = &c->quarter[age / (FW_WINDOW_SAMPLES / 4)];
    if (sum > quarter->high) {
      quarter->high = sum;
      quarter->high_at = c->index;
    }
    if (c->phase == FW_CYCLING && sum < quarter->low) quarter->low = sum;
  }
  fw_spectrum_push(&c->spectrum, code);
}

static void confirm(FwCompensator* c) {
  c->phase = FW_CYCLING;
  fw_floor_reset(&c->floor, c->armed_trough);
  c->fast = c->knows_excitation;
  if (c->knows_excitation) {
    const uint32_t forgotten = (c->index - c->held_since) / FW_RECOVERY_RATIO;
    const uint32_t exposure = c->exposure_at_hold > forgotten ? c->exposure_at_hold - forgotten : 0;
    c->onset = c->index - exposure;
    return;
  }
  /* The way to the first turning point may have been a loading ramp: then it took far longer than the
     half-cycle after it (a sweep from 0 Hz takes 2.4 times as long) and the cycling is one half-cycle older
     than that point. A window that looked at much of a ramp begins anew. */
  const uint32_t way = c->first_turn_at - c->onset;
  if (way < FW_WINDOW_SAMPLES ? 3u * way <= 8u * c->last_interval : way <= c->last_interval) return;
  const uint32_t latest = c->first_turn_at - c->last_interval;
  const uint32_t late = latest - c->onset;
  c->onset = latest;
  if (late > FW_RAMP_SAMPLES) open_window(c);
}

static void turned(FwCompensator* c, FwTurn turn, int32_t value, uint32_t at, int32_t sum) {
  const uint32_t interval = at > c->last_turn_at ? at - c->last_turn_at : 0;
  if (c->phase == FW_ARMED && interval > FW_HALF_PERIOD_MAX_SAMPLES) {
    arm(c, sum, at, turn == FW_TROUGH); /* a slow ramp came before: the cycling can only begin here */
  } else {
    c->last_interval = interval;
    if (interval > c->longest_interval) c->longest_interval = interval;
  }
  c->last_turn_at = at;
  if (c->phase == FW_ARMED && c->peaks == 0 && c->troughs == 0) {
    c->first_turn_at = at;
    c->learning_since = c->index;
  }
  if (turn == FW_PEAK) {
    ++c->peaks;
  } else {
    if (c->troughs == 0 || value < c->armed_trough) c->armed_trough = value;
    ++c->troughs;
  }
  if (c->phase == FW_ARMED && c->peaks > 0 && c->troughs > 0) confirm(c);
}

static uint32_t quiet_limit(const FwCompensator* c) {
  if (c->phase != FW_CYCLING) return FW_QUIET_MIN_SAMPLES;
  const uint32_t period = 2u * c->last_interval;
  if (period < FW_QUIET_MIN_SAMPLES) return FW_QUIET_MIN_SAMPLES;
  return period > FW_QUIET_MAX_SAMPLES ? FW_QUIET_MAX_SAMPLES : period;
}

static void fell_quiet(FwCompensator* c) {
  if (c->phase == FW_CYCLING) {
    if (c->window_open) {
      c->knows_excitation = 0;
      c->phase = FW_REST;
    } else {
      c->held_since = c->index;
      c->exposure_at_hold = c->index - c->onset;
      c->phase = FW_HELD;
    }
    c->fast = 1;
  } else if (c->phase == FW_ARMED) {
    c->phase = c->knows_excitation ? FW_HELD : FW_REST;
  }
}

static void track(FwCompensator* c, uint16_t code, int32_t sum) {
  const int32_t moved = sum - c->quiet_reference;
  const int moves = moved > c->quiet_band || -moved > c->quiet_band;
  if (moves) {
    c->quiet_reference = sum;
    c->quiet_since = c->index;
    if (c->phase == FW_REST || c->phase == FW_HELD) arm(c, sum, c->index, moved > 0);
  } else if (c->phase != FW_REST && c->phase != FW_HELD && c->index - c->quiet_since >= quiet_limit(c)) {
    fell_quiet(c);
  }

  if (c->phase == FW_HELD && (c->index - c->held_since) / FW_RECOVERY_RATIO >= c->exposure_at_hold) {
    c->knows_excitation = 0;
    c->phase = FW_REST;
  }
  if (c->phase != FW_ARMED && c->phase != FW_CYCLING) return;
  int32_t value = 0;
  uint32_t at = 0;
  const FwTurn turn = fw_turning_push(&c->turning, sum, c->index, c->hysteresis, &value, &at);
  if (turn != FW_NO_TURN) turned(c, turn, value, at, sum);
  if (c->window_open) observe_window(c, code, sum);
  if (c->phase == FW_CYCLING) {
    fw_floor_push(&c->floor, sum);
    if (c->window_open && c->index - c->window_start >= FW_WINDOW_CLOSE_SAMPLES) close_window(c);
  }
}

static void tick(FwCompensator* c) {
  float target = 1.0f;
  if (c->phase == FW_CYCLING) {
    const uint32_t age = c->index - c->onset;
    if (c->window_open) {
      learn(c);
    } else if (c->slow_content && age < FW_AMPLITUDE_SETTLE_SAMPLES && c->floor.lowest < c->trough_sum) {
      c->trough_sum = c->floor.lowest; /* the minima do not decay: a deeper one is still the truth */
      update_ratio(c);
    }
    target = factor_at(c->b_per_s, c->q, age);
    c->floor_V = (float)c->floor.lowest * c->lsb_sum_V;
  }
  const float step = c->fast ? FW_FACTOR_STEP_FAST : FW_FACTOR_STEP;
  const float gap = target - c->factor;
  if (gap > step) {
    c->factor += step;
  } else if (gap < -step) {
    c->factor -= step;
  } else {
    c->factor = target;
    c->fast = 0;
  }
}

void fw_compensator_reset(FwCompensator* c, const FwCalibration* calibration) {
  memset(c, 0, sizeof *c);
  c->calibration = *calibration;
#ifdef FW_COMPENSATION
  fg_comp_reset(&c->effects);
  fg_comp_calibrate(&c->calibration.gain_N_per_V, &c->calibration.offset_N, &c->calibration.b_scale,
                    &c->calibration.q_scale);
#endif
  c->code_max = (int32_t)((1u << calibration->adc_bits) - 1u);
  c->lsb_V = calibration->v_range_V / (float)c->code_max;
  c->lsb_sum_V = c->lsb_V * (1.0f / (float)FW_SMOOTH_SAMPLES);
  c->hysteresis = FW_SMOOTH_SAMPLES * c->code_max / FW_HYSTERESIS_DIVISOR;
  c->quiet_band = FW_SMOOTH_SAMPLES * c->code_max / FW_QUIET_DIVISOR;
  c->phase = FW_REST;
  c->factor = 1.0f;
}

float fw_compensator_step(FwCompensator* c, uint16_t code, uint8_t* flags) {
  if (c->index == 0) {
    fw_smoother_reset(&c->smoother, code);
    c->quiet_reference = c->smoother.sum;
  }
  track(c, code, fw_smoother_push(&c->smoother, code));
  if (c->index % FW_TICK_SAMPLES == FW_TICK_SAMPLES - 1) tick(c);

  const float voltage_V = (float)code * c->lsb_V;
  const float above_V = voltage_V - c->floor_V;
  const float restored_V = above_V > 0.0f && c->factor > 1.0f ? c->factor * above_V + c->floor_V : voltage_V;
  float force_N = c->calibration.gain_N_per_V * restored_V + c->calibration.offset_N;
#ifdef FW_COMPENSATION /* the inverse of the exported model, with the same factor and U_min */
  force_N = fg_comp_step(&c->effects, c->calibration.gain_N_per_V * voltage_V + c->calibration.offset_N,
                         above_V > 0.0f && c->factor > 1.0f ? 1.0f / c->factor : 1.0f,
                         c->calibration.gain_N_per_V * c->floor_V + c->calibration.offset_N, 0.0f);
#endif

  uint8_t f = 0;
  if (c->phase == FW_CYCLING) f |= FW_FLAG_EXCITED;
  if (c->phase == FW_HELD) f |= FW_FLAG_HELD;
  if (c->window_open && (c->phase == FW_CYCLING || (c->phase == FW_ARMED && c->peaks + c->troughs > 0)) &&
      c->index - c->learning_since < FW_WINDOW_CLOSE_SAMPLES)
    f |= FW_FLAG_LEARNING;
  if (code == 0 || (int32_t)code >= c->code_max) f |= FW_FLAG_INPUT_RAIL;
  if (force_N > FW_FORCE_CLAMP_N) {
    force_N = FW_FORCE_CLAMP_N;
    f |= FW_FLAG_OUTPUT_CLAMPED;
  } else if (force_N < -FW_FORCE_CLAMP_N) {
    force_N = -FW_FORCE_CLAMP_N;
    f |= FW_FLAG_OUTPUT_CLAMPED;
  }
  *flags = f;
  ++c->index;
  return force_N;
}
